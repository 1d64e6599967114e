// The signed-rank test against R and exactRankTests, direct enumeration, and its edges.
#include <cmath>
#include <cstdint>

#include <rapidcheck.h>

#include "analysis/group/rank_tests.h"
#include "analysis/numerics/ranks.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

void check(const std::vector<double>& x, const std::vector<double>& y, const nlohmann::json& reference) {
  CAPTURE(reference.dump());
  const SignedRank found = signed_rank(x, y);
  CHECK(found.status == StatisticStatus::ok);
  CHECK(found.n == reference.at("n").get<int>());
  CHECK(found.zeros == reference.at("n_zero").get<int>());
  CHECK(found.ties == reference.at("ties").get<bool>());
  CHECK(found.v == reference.at("V").get<double>());
  CHECK(found.exact == (reference.at("R_default_method") == "Wilcoxon signed rank exact test"));
  CHECK(std::abs(found.p - reference.at("R_default_p").get<double>()) <= 1e-12);
  CHECK(std::abs(found.p_normal - reference.at("normal_corrected_p").get<double>()) <= 1e-12);
  CHECK(std::abs(found.p_exact_permutation - reference.at("perm_exact_p_zeros_dropped").get<double>()) <= 1e-14);
  CHECK(std::abs(found.p_exact_permutation - reference.at("exactRankTests_p").get<double>()) <= 1e-14);
  CHECK(std::abs(found.rank_biserial - reference.at("rank_biserial_matched").get<double>()) <= 1e-14);

  std::vector<double> differences;
  for (std::size_t i = 0; i < x.size(); ++i) differences.push_back(x[i] - y[i]);
  const PrattSignedRank pratt = pratt_signed_rank(differences);
  CHECK(std::abs(pratt.z - reference.at("pratt_z").get<double>()) <= 1e-12);
  CHECK(std::abs(pratt.p - reference.at("pratt_asymptotic_p").get<double>()) <= 1e-12);
  CHECK(std::abs(pratt.p_exact_permutation - reference.at("pratt_exact_p").get<double>()) <= 1e-14);
}

TEST_CASE("signed ranks agree with R, coin and exactRankTests", "[analysis]") {
  for (const auto& one : group_reference().at("wilcoxon_extra")) check(numbers_of(one["x"]), numbers_of(one["y"]), one);
  for (const auto& dataset : group_reference().at("datasets")) {
    const WithinTable table = table_of(dataset["data"]);
    std::size_t pair = 0;
    for (std::size_t a = 0; a < table.k; ++a)
      for (std::size_t b = a + 1; b < table.k; ++b)
        check(table.column(a), table.column(b), dataset["wilcoxon"][pair++]);
  }
}

TEST_CASE("signed ranks of fractions that were written with 15 digits are those of the fractions", "[analysis]") {
  for (const auto& one : group_reference().at("wilcoxon_15_digits")) {
    CAPTURE(one.at("multiples_of").get<std::string>());
    const SignedRank found = signed_rank(numbers_of(one["x"]), numbers_of(one["y"]));
    CHECK(found.v == one.at("V").get<double>());
    CHECK(std::abs(found.p - one.at("p").get<double>()) <= 1e-12);
  }
}

// Every one of the 2^n sign changes.
double enumerated_p(const std::vector<double>& differences) {
  std::vector<double> magnitudes;
  double v = 0;
  for (const double difference : differences)
    if (difference != 0) magnitudes.push_back(std::abs(difference));
  const std::vector<double> ranks = midranks(magnitudes).ranks;
  std::size_t used = 0;
  for (const double difference : differences) {
    if (difference > 0) v += ranks[used];
    if (difference != 0) ++used;
  }
  std::uint32_t below = 0, above = 0;
  const std::uint32_t all = 1U << ranks.size();
  for (std::uint32_t signs = 0; signs < all; ++signs) {
    double sum = 0;
    for (std::size_t i = 0; i < ranks.size(); ++i)
      if ((signs >> i) & 1U) sum += ranks[i];
    if (sum <= v) ++below;
    if (sum >= v) ++above;
  }
  return std::min(1.0, 2.0 * std::min(below, above) / all);
}

TEST_CASE("the exact permutation p is a count of sign changes", "[analysis]") {
  REQUIRE(rc::check("with ties and zeros", [] {
    const int n = *rc::gen::inRange(1, 11);
    std::vector<double> differences;
    for (int i = 0; i < n; ++i) differences.push_back(*rc::gen::inRange(-4, 5));
    const SignedRank found = signed_rank(differences);
    RC_PRE(found.status == StatisticStatus::ok);
    RC_ASSERT(found.p_exact_permutation == enumerated_p(differences));
    RC_ASSERT(found.exact == (!found.ties && found.zeros == 0));
    RC_ASSERT(found.p >= 0);
    RC_ASSERT(found.p <= 1);
  }));
}

TEST_CASE("the distribution of V", "[analysis]") {
  // p of 1, -2, 3 and the like: twice the smaller tail of V, whose distribution is 1 1 1 2 1 1 1 in eighths.
  const auto p_of = [](int n, int negative_rank) {
    std::vector<double> differences;
    for (int rank = 1; rank <= n; ++rank) differences.push_back(rank == negative_rank ? -rank : rank);
    return signed_rank(differences).p_exact_permutation;
  };
  CHECK(p_of(3, 0) == 0.25);
  CHECK(p_of(3, 1) == 0.5);
  CHECK(p_of(3, 2) == 0.75);
  CHECK(p_of(3, 3) == 1);
  for (const int n : {10, 49, kLargestExactSignedRank}) {
    CHECK(p_of(n, 0) == std::ldexp(1.0, 1 - n));
    CHECK(p_of(n, 1) == std::ldexp(1.0, 2 - n));
    CHECK(p_of(n, 3) == std::ldexp(5.0, 1 - n));  // V misses 0, 1, 2 or 3, the last in two ways
    std::vector<double> balanced;                 // V as close to its middle as it can be: both tails hold half or more
    int sum = 0;
    for (int rank = n; rank >= 1; --rank) {
      balanced.push_back(sum > 0 ? -rank : rank);
      sum += sum > 0 ? -rank : rank;
    }
    CHECK(std::abs(sum) <= 1);
    CHECK(signed_rank(balanced).p_exact_permutation == Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("where the exact p ends and the normal one begins", "[analysis]") {
  std::vector<double> differences;
  for (int i = 1; i < 50; ++i) differences.push_back(i);
  SignedRank found = signed_rank(differences);
  CHECK(found.exact);
  CHECK(found.p == std::ldexp(1.0, -48));
  CHECK(found.rank_biserial == 1);
  differences.push_back(50);
  found = signed_rank(differences);
  CHECK_FALSE(found.exact);
  CHECK(found.p == found.p_normal);
  CHECK(found.p_exact_permutation == std::ldexp(1.0, -49));
  for (int i = 51; i <= kLargestExactSignedRank; ++i) differences.push_back(i);
  CHECK(signed_rank(differences).p_exact_permutation == std::ldexp(1.0, 1 - kLargestExactSignedRank));
  differences.push_back(1000);
  CHECK(std::isnan(signed_rank(differences).p_exact_permutation));
  CHECK(signed_rank(differences).p > 0);
}

TEST_CASE("signed ranks without a difference", "[analysis]") {
  const std::vector<double> none, zeros(7, 0.0), one = {-2.0};
  CHECK(signed_rank(none).status == StatisticStatus::too_few);
  CHECK(signed_rank(zeros).status == StatisticStatus::no_variance);
  CHECK(signed_rank(zeros).zeros == 7);
  CHECK(signed_rank(zeros).v == 0);
  CHECK(std::isnan(signed_rank(zeros).p));
  CHECK(std::isnan(signed_rank(zeros).p_exact_permutation));
  CHECK(pratt_signed_rank(zeros).status == StatisticStatus::no_variance);
  CHECK(pratt_signed_rank(none).status == StatisticStatus::too_few);
  CHECK(signed_rank(one).p == 1);
  CHECK(signed_rank(one).rank_biserial == -1);
}

TEST_CASE("signed ranks: swapping the conditions mirrors V, monotone units change nothing", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const auto differences = *rc::gen::container<std::vector<int>>(rc::gen::inRange(-20, 21));
    std::vector<double> forward, backward, cubed;
    for (const int d : differences) {
      forward.push_back(d);
      backward.push_back(-d);
      cubed.push_back(0.5 * d * d * d);
    }
    const SignedRank a = signed_rank(forward), b = signed_rank(backward), c = signed_rank(cubed);
    RC_PRE(a.status == StatisticStatus::ok);
    RC_ASSERT(a.p == b.p);
    RC_ASSERT(a.p_exact_permutation == b.p_exact_permutation || std::isnan(a.p_exact_permutation));
    RC_ASSERT(a.rank_biserial == -b.rank_biserial);
    RC_ASSERT(a.v == c.v);
    RC_ASSERT(a.p == c.p);
  }));
}

}  // namespace
}  // namespace jnd
