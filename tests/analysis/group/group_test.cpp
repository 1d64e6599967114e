// Means, normality, signed ranks and rating items of a group, against R.
#include "analysis/group/group.h"

#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include <rapidcheck.h>

#include "analysis/group/questionnaire.h"
#include "analysis/group/rank_tests.h"
#include "analysis/group/shapiro_wilk.h"
#include "analysis/numerics/ranks.h"
#include "analysis/numerics/special_values.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Group means and intervals against R 4.2.2.

struct Case {
  std::vector<double> values;
  double mean, sd, half_width;
};

// Values -> mean, sd, half width of the 95 % t interval (R 4.2.2: mean, sd, qt).
const std::vector<Case> kReference = {
    {{253.711, 310.211, 284.511, 330.411, 256.511, 315.211, 274.511, 253.411, 431.711, 283.711, 240.011, 234.711,
      260.011, 298.911, 268.711, 269.011, 264.811, 272.911},
     283.499888888889,
     45.0099059539889,
     22.3828996471104},
    {{388.989, 322.989, 469.989, 275.489, 274.289, 352.889, 379.489, 414.189, 387.389, 278.889, 365.389, 311.289,
      409.589, 382.889, 283.589, 349.089, 314.989, 356.589},
     351.000111111111,
     54.9943086776087,
     27.3480263111733},
    {{212.1, 175.6, 288.6, 259, 204.1, 193.1, 168.2, 230.8, 211.7, 166.9, 179.8, 209.9, 215.9, 262.2, 181.6, 208.3,
      216.8, 168.4},
     208.5,
     34.5942701818056,
     17.203325833116},
    {{7, 6, 8, 5, 7, 6, 8, 7, 6, 5, 9, 7}, 6.75, 1.21543108701099, 0.772248069726115},
    {{4, 3, 5, 4, 2, 3, 4, 5, 6, 3, 2, 4}, 3.75, 1.21543108701099, 0.772248069726115},
    {{8, 7, 8, 9, 7, 6, 9, 8, 7, 8, 7, 7}, 7.58333333333333, 0.90033663737852, 0.57204660778351},
};

TEST_CASE("mean, standard deviation and t interval agree with R", "[analysis]") {
  for (const Case& one : kReference) {
    const MeanEstimate found = mean_with_ci(one.values);
    CHECK(found.n == static_cast<int>(one.values.size()));
    CHECK(found.mean == Approx(one.mean).epsilon(1e-12));
    CHECK(found.sd == Approx(one.sd).epsilon(1e-12));
    CHECK(found.mean - found.ci_low == Approx(one.half_width).epsilon(1e-10));
    CHECK(found.ci_high - found.mean == Approx(one.half_width).epsilon(1e-10));
  }
}

TEST_CASE("too few values give what they can and no more", "[analysis]") {
  const MeanEstimate none = mean_with_ci({});
  CHECK(none.n == 0);
  CHECK(std::isnan(none.mean));
  const std::vector<double> single = {3.5};
  const MeanEstimate one = mean_with_ci(single);
  CHECK(one.n == 1);
  CHECK(one.mean == 3.5);
  CHECK(std::isnan(one.sd));
  CHECK(std::isnan(one.ci_low));
  CHECK(std::isnan(one.ci_high));
}

// Shapiro-Wilk against R, the exact p of three values, and invariances.

void check_shapiro(const std::vector<double>& values, const nlohmann::json& reference) {
  CAPTURE(reference.dump());
  const ShapiroWilk found = shapiro_wilk(values);
  CHECK(found.status == StatisticStatus::ok);
  CHECK(found.n == static_cast<int>(values.size()));
  CHECK(std::abs(found.w - reference.at("W").get<double>()) <= 1e-12);
  CHECK(std::abs(found.p - reference.at("p").get<double>()) <= 1e-10);
}

TEST_CASE("Shapiro-Wilk agrees with R", "[analysis]") {
  for (const auto& one : group_reference().at("shapiro_extra")) check_shapiro(numbers_of(one["x"]), one);
  for (const auto& dataset : group_reference().at("datasets")) {
    const WithinTable table = table_of(dataset["data"]);
    for (std::size_t j = 0; j < table.k; ++j) check_shapiro(table.column(j), dataset["shapiro"][j]);
  }
}

TEST_CASE("Shapiro-Wilk of three values is exact, however small p", "[analysis]") {
  for (const auto& one : group_reference().at("shapiro_three")) {
    CAPTURE(one.dump());
    const ShapiroWilk found = shapiro_wilk(numbers_of(one["x"]));
    CHECK(relative(found.w, one["w"]) <= 1e-14);
    CHECK(relative(found.p, one["p"]) <= 1e-13);
  }
  const double equal_pair[] = {1, 1, 2}, even[] = {-1, 0, 1};
  CHECK(shapiro_wilk(equal_pair).w == Approx(0.75).epsilon(1e-15));
  CHECK(shapiro_wilk(equal_pair).p == 0);
  CHECK(shapiro_wilk(even).w == Approx(1).epsilon(1e-15));
  CHECK(shapiro_wilk(even).p == Approx(1).epsilon(1e-15));
}

TEST_CASE("Shapiro-Wilk says where it is undefined", "[analysis]") {
  const auto status = [](std::size_t n, bool constant) {
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(constant ? 0.1 : static_cast<double>(i % 17));
    const ShapiroWilk found = shapiro_wilk(values);
    CHECK((found.status == StatisticStatus::ok) == !std::isnan(found.w));
    CHECK((found.status == StatisticStatus::ok) == !std::isnan(found.p));
    return found.status;
  };
  CHECK(status(0, false) == StatisticStatus::too_few);
  CHECK(status(2, false) == StatisticStatus::too_few);
  CHECK(status(3, true) == StatisticStatus::no_variance);
  CHECK(status(5000, false) == StatisticStatus::ok);
  CHECK(status(5001, false) == StatisticStatus::too_many);
}

TEST_CASE("Shapiro-Wilk keeps digits far from zero and in the tail", "[analysis]") {
  // The same shape at 1e6 with a spread of 1e-6: only the rounding of the input is left.
  const std::vector<double> shape = {0, 1, 2, 3, 5, 8, 9, 14};
  std::vector<double> far;
  for (const double value : shape) far.push_back(1e6 + value * 0x1p-20);
  CHECK(shapiro_wilk(far).w == Approx(shapiro_wilk(shape).w).epsilon(1e-13));
  std::vector<double> outlier(2000, 0.0);
  for (std::size_t i = 0; i < outlier.size(); ++i) outlier[i] = 1e-6 * static_cast<double>(i % 7);
  outlier.back() = 1;
  const ShapiroWilk found = shapiro_wilk(outlier);
  CHECK(found.p > 0);
  CHECK(found.p < 1e-60);
}

TEST_CASE("Shapiro-Wilk does not see shift, scale, sign or order", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const WithinTable table = random_table(1, 4, 40);
    const ShapiroWilk found = shapiro_wilk(table.values);
    RC_PRE(found.status == StatisticStatus::ok);
    RC_ASSERT(found.w > 0);
    RC_ASSERT(found.w <= 1);
    RC_ASSERT(found.p >= 0);
    RC_ASSERT(found.p <= 1);
    std::vector<double> changed;
    for (const std::size_t i : random_order(table.values.size())) changed.push_back(100 - 0.3 * table.values[i]);
    const ShapiroWilk again = shapiro_wilk(changed);
    RC_ASSERT(std::abs(again.w - found.w) < 1e-12);
    RC_ASSERT(std::abs(again.p - found.p) < 1e-9);
  }));
}

// The signed-rank test against R and exactRankTests, direct enumeration, and its edges.

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

// Rating items: medians with distribution-free intervals, and families of paired tests.

constexpr double kMissing = kNaN;

TEST_CASE("the interval of a median: places and coverage", "[analysis]") {
  for (const auto& one : group_reference().at("binomial_median")) {
    CAPTURE(one.dump());
    std::vector<double> values(one["n"].get<std::size_t>());
    std::iota(values.rbegin(), values.rend(), 1);
    const MedianInterval found = median_interval(values);
    const double r = one["r"], n = static_cast<double>(values.size());
    CHECK(found.n == one["n"].get<int>());
    CHECK(found.ci_low == r);
    CHECK(found.ci_high == n + 1 - r);
    CHECK(found.median == (n + 1) / 2);
    CHECK(std::abs(found.coverage - one["coverage"].get<double>()) <= 1e-13);
    CHECK(found.status == (found.coverage >= 0.95 ? StatisticStatus::ok : StatisticStatus::too_few));
  }
}

TEST_CASE("the interval of a median of few", "[analysis]") {
  CHECK(median_interval({}).status == StatisticStatus::too_few);
  CHECK(std::isnan(median_interval({}).median));
  CHECK(std::isnan(median_interval({}).coverage));
  const std::vector<double> one = {4}, five = {5, 1, 2, 2, 3};
  CHECK(median_interval(one).ci_low == 4);
  CHECK(median_interval(one).coverage == 0);
  CHECK(median_interval(five).coverage == 0.9375);
  CHECK(median_interval(five).status == StatisticStatus::too_few);
  CHECK(median_interval(five, 0.9).status == StatisticStatus::ok);
  CHECK(median_interval(five, 0.5).ci_low == 2);
}

TEST_CASE("the interval of a median contains it and shrinks with the confidence asked", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const auto ratings = *rc::gen::nonEmpty(rc::gen::container<std::vector<int>>(rc::gen::inRange(1, 10)));
    const std::vector<double> values(ratings.begin(), ratings.end());
    const MedianInterval wide = median_interval(values, 0.99), narrow = median_interval(values, 0.6);
    RC_ASSERT(wide.ci_low <= narrow.ci_low);
    RC_ASSERT(narrow.ci_low <= narrow.median);
    RC_ASSERT(narrow.median <= narrow.ci_high);
    RC_ASSERT(narrow.ci_high <= wide.ci_high);
    RC_ASSERT(wide.coverage >= narrow.coverage);
  }));
}

TEST_CASE("paired items: exact p with ties, corrected over all pairs of all items", "[analysis]") {
  const auto& dataset = group_reference().at("datasets")[1];  // Likert ratings with ties and zeros
  const WithinTable ratings = table_of(dataset["data"]);
  WithinTable same{4, 3, std::vector<double>(12, 6.0)};
  const std::vector<PairedItem> items = {{"QB1", ratings}, {"QB2", same}};
  const PairedQuestionnaire found = paired_questionnaire(items);
  REQUIRE(found.items.size() == 2);
  CHECK(found.family == 3);  // an item without a difference is no test
  double smallest = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const ItemPair& pair = found.items[0].pairs[i];
    const auto& reference = dataset["wilcoxon"][i];
    CHECK(pair.exact);
    CHECK(std::abs(pair.p - reference["perm_exact_p_zeros_dropped"].get<double>()) <= 1e-15);
    CHECK(std::abs(pair.test.rank_biserial - reference["rank_biserial_matched"].get<double>()) <= 1e-14);
    smallest = std::min(smallest, pair.p);
  }
  CHECK(found.items[0].pairs[2].p == smallest);
  CHECK(found.items[0].pairs[2].p_holm == 3 * smallest);
  CHECK(found.items[0].pairs[2].p_bh == Approx(std::min(3 * smallest, 1.5 * found.items[0].pairs[0].p)));
  CHECK(relative(found.items[0].friedman.chi2, dataset["friedman"]["chi2"]) <= 1e-12);
  CHECK(found.items[0].conditions[0].median == 7);
  CHECK(found.items[0].pairs[0].median_difference == 3);
  for (const ItemPair& pair : found.items[1].pairs) {
    CHECK(pair.test.status == StatisticStatus::no_variance);
    CHECK(std::isnan(pair.p));
    CHECK(std::isnan(pair.p_holm));
    CHECK(pair.median_difference == 0);
  }
}

TEST_CASE("paired items: missing answers leave only their own pairs", "[analysis]") {
  const std::vector<PairedItem> items = {{"QB1", {4, 3, {7, 4, kMissing, 6, kMissing, 7, 8, 5, 8, 5, 4, 9}}},
                                         {"QB2", {3, 2, {7, 4, 6, 2, 8, kMissing}}}};
  const PairedQuestionnaire found = paired_questionnaire(items);
  const PairedItemResult& first = found.items[0];
  CHECK(first.conditions[0].n == 4);
  CHECK(first.conditions[1].n == 3);
  CHECK(first.conditions[2].n == 3);
  CHECK(first.pairs[0].test.n == 3);
  CHECK(first.pairs[2].test.n == 2);
  CHECK(first.friedman.n == 2);
  CHECK(found.items[1].friedman.status == StatisticStatus::not_applicable);
  CHECK(std::isnan(found.items[1].friedman.p));
  CHECK(found.items[1].pairs.size() == 1);
  CHECK(found.items[1].pairs[0].test.n == 2);
  CHECK(found.family == 4);
  CHECK(paired_questionnaire({}).items.empty());
  const std::vector<PairedItem> nobody = {{"QB3", {2, 2, {kMissing, 1, 2, kMissing}}}};
  CHECK(paired_questionnaire(nobody).items[0].pairs[0].test.status == StatisticStatus::too_few);
  CHECK(std::isnan(paired_questionnaire(nobody).items[0].pairs[0].median_difference));
}

TEST_CASE("a median of few ratings, with its true coverage", "[analysis]") {
  const MedianInterval found = median_interval(std::vector<double>{8, 7, 9, 8, 6, 9, 8});
  CHECK(found.n == 7);
  CHECK(found.median == 8);
  CHECK(found.ci_low == 6);
  CHECK(found.ci_high == 9);
  CHECK(found.coverage == 1 - 2.0 / 128);
  CHECK(found.status == StatisticStatus::ok);
  CHECK(median_interval({}).n == 0);
  CHECK(median_interval({}).status == StatisticStatus::too_few);
}

}  // namespace
}  // namespace jnd
