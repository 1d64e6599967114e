// Identification: R's numbers, searches by patterns, separated stimuli and other edges.
#include "analysis/ratings/identification.h"

#include <cmath>
#include <random>

#include <rapidcheck.h>

#include "tests/analysis/ratings/ratings_fixtures.h"

namespace jnd {
namespace {

using testing::near_reference;
using Confusion = std::vector<std::vector<int>>;

// By its definition: N I less N - 1 times the mean information without one trial.
double jackknife_of(Confusion confusion) {
  const Identification whole = identification(confusion);
  const auto trials = static_cast<double>(whole.trials);
  double without = 0;
  for (std::vector<int>& row : confusion)
    for (int& n : row) {
      if (n == 0) continue;
      --n;
      const double bits = identification(confusion).information_bits;
      ++n;
      without += n * bits / trials;
    }
  return trials * whole.information_bits - (trials - 1) * without;
}

// The mean of what `read` finds in tables that are drawn from these rates.
template <typename Read>
double mean_of_drawn(const Confusion& rates, int trials_per_class, Read read) {
  constexpr int kTables = 400;
  std::mt19937 random(1);
  double mean = 0;
  for (int table = 0; table < kTables; ++table) {
    Confusion drawn(rates.size(), std::vector<int>(rates.size()));
    for (std::size_t i = 0; i < rates.size(); ++i) {
      std::discrete_distribution<std::size_t> response(rates[i].begin(), rates[i].end());
      for (int trial = 0; trial < trials_per_class; ++trial) ++drawn[i][response(random)];
    }
    mean += read(identification(drawn)) / kTables;
  }
  return mean;
}

TEST_CASE("the jackknife takes most of the bias off the information", "[analysis][ratings]") {
  for (const nlohmann::json& one : reference_numbers("ratings").at("identification")) {
    const Confusion rates = one.at("input").at("confusion");
    for (const int trials : {6, 12, 24}) {
      CAPTURE(one.at("name").get<std::string>(), trials);
      const double truth = identification(rates).information_bits;
      const double bias =
          mean_of_drawn(rates, trials, [](const auto& found) { return found.information_bits; }) - truth;
      const double left = mean_of_drawn(rates, trials, [](const auto& found) { return found.jackknife_bits; }) - truth;
      CHECK(std::abs(left) < 0.35 * bias);
    }
  }
  CHECK(identification({{1, 0}, {0, 0}}).jackknife_bits == 0);
}

TEST_CASE("identification agrees with R", "[analysis][ratings]") {
  for (const nlohmann::json& one : reference_numbers("ratings").at("identification")) {
    CAPTURE(one.at("name").get<std::string>());
    const nlohmann::json& expected = one.at("expected");
    const Identification found = identification(one.at("input").at("confusion"));
    CHECK(near_reference(found.information_bits, expected.at("information_bits"), 1e-13));
    CHECK(near_reference(found.stimulus_entropy_bits, expected.at("stimulus_entropy_bits"), 1e-13));
    CHECK(near_reference(found.response_entropy_bits, expected.at("response_entropy_bits"), 1e-13));
    CHECK(near_reference(found.miller_madow_bits, expected.at("miller_madow_bits"), 1e-13));
    CHECK(near_reference(found.table_corrected_bits, expected.at("table_corrected_bits"), 1e-13));
    CHECK(found.jackknife_bits == Approx(jackknife_of(one.at("input").at("confusion"))).epsilon(1e-12));
    CHECK(near_reference(found.relative, expected.at("relative"), 1e-13));
    CHECK(near_reference(found.equivalent_classes, expected.at("equivalent_classes"), 1e-12));
    CHECK(near_reference(found.proportion_correct, expected.at("proportion_correct"), 1e-15));
    const nlohmann::json& ml = expected.at("ml");
    CHECK(to_string(found.ml.status) == ml.at("status").get<std::string>());
    CHECK(near_reference(found.ml.log_likelihood, ml.at("loglik"), 1e-9));
    CHECK(found.ml.categories_used == ml.at("categories_used").get<std::vector<int>>());
    CHECK(near_reference(found.ml.total_dprime, ml.at("total_dprime"), 1e-7));
    for (std::size_t i = 0; i < ml.at("adjacent").size(); ++i) {
      CHECK(near_reference(found.adjacent_loglinear.at(i), expected.at("adjacent_loglinear").at(i), 1e-12));
      CHECK(near_reference(found.ml.adjacent.at(i).dprime, ml.at("adjacent").at(i).at("dprime"), 1e-7));
      CHECK(near_reference(found.ml.adjacent.at(i).se, ml.at("adjacent").at(i).at("se"), 1e-7));
      CHECK(near_reference(found.ml.criteria.at(i), ml.at("criteria").at(i), 1e-7));
      CHECK(near_reference(found.ml.mu.at(i + 1), ml.at("mu").at(i + 1), 1e-7));
    }
  }
}

TEST_CASE("no search finds a likelier scale, nor passes the limit of separated stimuli", "[analysis][ratings]") {
  REQUIRE(rc::check("random matrices", [] {
    Confusion confusion;
    std::vector<std::vector<double>> counts;
    for (std::size_t i = 0; i < 3; ++i) {
      confusion.push_back(*rc::gen::container<std::vector<int>>(3, rc::gen::inRange(0, 5)));
      ++confusion.back()[i];
      counts.emplace_back(confusion.back().begin(), confusion.back().end());
    }
    const Identification found = identification(confusion);
    const double best = testing::highest_by_patterns(
        [&](const std::vector<double>& place) {
          return testing::plain_log_likelihood(counts, {place[0], place[1]}, {0, place[2], place[3]}, {1, 1, 1});
        },
        {0, 1, 0.5, 1});
    RC_ASSERT(best <= found.ml.log_likelihood + 1e-7);
    RC_ASSERT(best >= found.ml.log_likelihood - 1e-3);
    const bool finite = std::isfinite(found.ml.adjacent[0].dprime) && std::isfinite(found.ml.adjacent[1].dprime);
    RC_ASSERT(finite == (found.ml.status == IdentificationStatus::ok));
    RC_ASSERT(finite == (std::isfinite(found.ml.adjacent[0].se) && std::isfinite(found.ml.adjacent[1].se)) || !finite);
  }));
}

TEST_CASE("two stimuli and two responses are yes-no", "[analysis][ratings]") {
  const Identification found = identification({{10, 3}, {4, 9}});
  CHECK(found.ml.adjacent[0].dprime == Approx(1.238718).epsilon(1e-6));
  CHECK(found.ml.log_likelihood ==
        Approx(10 * std::log(10 / 13.0) + 3 * std::log(3 / 13.0) + 4 * std::log(4 / 13.0) + 9 * std::log(9 / 13.0)));
}

TEST_CASE("perfect identification has all the information and no bound", "[analysis][ratings]") {
  const Identification found = identification({{10, 0, 0, 0}, {0, 10, 0, 0}, {0, 0, 10, 0}, {0, 0, 0, 10}});
  CHECK(found.information_bits == 2);
  CHECK(found.relative == 1);
  CHECK(found.equivalent_classes == 4);
  CHECK(found.miller_madow_bits > 2);  // it may raise the information
  CHECK(found.table_corrected_bits < 2);
  CHECK(found.ml.status == IdentificationStatus::separated);
  CHECK(found.ml.log_likelihood == 0);
  CHECK(found.ml.total_dprime == kInf);
  for (const AdjacentDprime& one : found.ml.adjacent) CHECK(one.dprime == kInf);
  for (const double one : found.adjacent_loglinear) CHECK(std::isfinite(one));
}

TEST_CASE("separated stimuli keep the d' within each group", "[analysis][ratings]") {
  const Identification found = identification({{10, 3, 0, 0}, {4, 10, 0, 0}, {0, 0, 10, 2}, {0, 0, 3, 10}});
  const Identification lower = identification({{10, 3}, {4, 10}}), upper = identification({{10, 2}, {3, 10}});
  CHECK(found.ml.status == IdentificationStatus::separated);
  CHECK(found.ml.criteria.empty());
  CHECK(found.ml.mu.empty());
  CHECK(found.ml.adjacent[0].dprime == Approx(lower.ml.adjacent[0].dprime).epsilon(1e-9));
  CHECK(found.ml.adjacent[0].se == Approx(lower.ml.adjacent[0].se).epsilon(1e-9));
  CHECK(found.ml.adjacent[1].dprime == kInf);
  CHECK(std::isnan(found.ml.adjacent[1].se));
  CHECK(found.ml.adjacent[2].dprime == Approx(upper.ml.adjacent[0].dprime).epsilon(1e-9));
  CHECK(found.ml.log_likelihood == Approx(lower.ml.log_likelihood + upper.ml.log_likelihood).epsilon(1e-12));
  // Confused the wrong way round.
  CHECK(identification({{0, 9}, {9, 0}}).ml.adjacent[0].dprime == -kInf);
  // One response that both groups share does not hold them together.
  CHECK(identification({{10, 3, 0}, {0, 9, 0}, {0, 3, 8}}).ml.status == IdentificationStatus::separated);
  CHECK(identification({{10, 3, 0}, {1, 9, 1}, {0, 3, 8}}).ml.status == IdentificationStatus::ok);
}

TEST_CASE("statuses of identification", "[analysis][ratings]") {
  const Identification unused = identification({{10, 0, 3}, {5, 0, 6}, {1, 0, 9}});
  CHECK(unused.ml.status == IdentificationStatus::ok);
  CHECK(unused.ml.categories_used == std::vector<int>{1, 3});
  CHECK(unused.ml.criteria.size() == 1);

  const Identification absent = identification({{10, 3, 2}, {0, 0, 0}, {1, 3, 8}});
  CHECK(absent.ml.status == IdentificationStatus::ok);
  CHECK(std::isnan(absent.adjacent_loglinear[0]));
  CHECK(std::isnan(absent.ml.adjacent[1].dprime));
  CHECK(std::isnan(absent.ml.mu[1]));
  CHECK(absent.ml.total_dprime == absent.ml.mu[2]);

  const Identification same = identification({{0, 5, 0}, {0, 4, 0}, {0, 7, 0}});
  CHECK(same.ml.status == IdentificationStatus::no_information);
  CHECK(same.information_bits == 0);
  CHECK(std::isnan(same.ml.total_dprime));
  const Identification single = identification({{3, 4}, {0, 0}});
  CHECK(single.ml.status == IdentificationStatus::single_class);
  CHECK(std::isnan(single.relative));
  const Identification missing = identification({{0, 0}, {0, 0}});
  CHECK(missing.ml.status == IdentificationStatus::missing);
  CHECK(std::isnan(missing.information_bits));
  CHECK(std::isnan(missing.proportion_correct));
  CHECK(identification({}).ml.status == IdentificationStatus::missing);
  CHECK(identification({{7}}).ml.status == IdentificationStatus::no_information);
}

TEST_CASE("twenty classes, and counts of hundreds of millions", "[analysis][ratings]") {
  Confusion wide(20, std::vector<int>(20, 0));
  for (std::size_t i = 0; i < 20; ++i)
    for (std::size_t j = 0; j < 20; ++j) wide[i][j] = i == j ? 20 : (i > j ? i - j : j - i) < 3 ? 6 : 0;
  const Identification found = identification(wide);
  CHECK(found.ml.status == IdentificationStatus::ok);
  CHECK(std::isfinite(found.ml.adjacent[9].se));
  const Identification many = identification(
      {{900'000'000, 90'000'000, 1}, {90'000'000, 800'000'000, 90'000'000}, {2, 70'000'000, 950'000'000}});
  CHECK(many.ml.status == IdentificationStatus::ok);
  CHECK(many.trials == 2'990'000'003);
  CHECK(many.ml.adjacent[0].se < 1e-3);
}

}  // namespace
}  // namespace jnd
