// Rated detection: R's numbers, searches by patterns, statuses and edges.
#include "analysis/ratings/rating_roc.h"

#include <algorithm>

#include <rapidcheck.h>

#include "tests/analysis/ratings/ratings_fixtures.h"

namespace jnd {
namespace {

using testing::near_reference;

void compare_equal(const EqualVarianceRoc& found, const nlohmann::json& expected) {
  CHECK(near_reference(found.log_likelihood, expected.at("loglik"), 1e-9));
  CHECK(near_reference(found.dprime.value, expected.at("dprime"), 1e-7));
  CHECK(near_reference(found.dprime.se, expected.at("dprime_se"), 1e-7));
  CHECK(near_reference(found.area.value, expected.at("A_z"), 1e-7));
  CHECK(near_reference(found.area.se, expected.at("A_z_se"), 1e-7));
  CHECK(near_reference(found.deviance, expected.at("deviance"), 1e-8));
  REQUIRE(found.criteria.size() == expected.at("criteria").size());
  for (std::size_t j = 0; j < found.criteria.size(); ++j) {
    CHECK(near_reference(found.criteria[j].value, expected.at("criteria").at(j), 1e-7));
    CHECK(near_reference(found.criteria[j].se, expected.at("criteria_se").at(j), 1e-7));
  }
}

void compare_unequal(const UnequalVarianceRoc& found, const nlohmann::json& expected) {
  CHECK(near_reference(found.log_likelihood, expected.at("loglik"), 1e-9));
  for (std::size_t j = 0; j < found.criteria.size(); ++j)
    CHECK(near_reference(found.criteria[j].value, expected.at("criteria").at(j), 1e-6));
  CHECK(near_reference(found.mu.value, expected.at("mu"), 1e-6));
  CHECK(near_reference(found.mu.se, expected.at("mu_se"), 1e-6));
  CHECK(near_reference(found.ln_sigma.value, expected.at("ln_sigma"), 1e-6));
  CHECK(near_reference(found.ln_sigma.se, expected.at("ln_sigma_se"), 1e-6));
  CHECK(near_reference(found.sigma.value, expected.at("sigma"), 1e-6));
  CHECK(near_reference(found.zroc_slope.value, expected.at("zroc_slope"), 1e-6));
  CHECK(near_reference(found.zroc_slope.se, expected.at("zroc_slope_se"), 1e-6));
  CHECK(near_reference(found.d_a.value, expected.at("d_a"), 1e-6));
  CHECK(near_reference(found.d_a.se, expected.at("d_a_se"), 1e-6));
  CHECK(near_reference(found.area.value, expected.at("A_z"), 1e-6));
  CHECK(near_reference(found.area.se, expected.at("A_z_se"), 1e-6));
  CHECK(near_reference(found.deviance, expected.at("deviance"), 1e-8));
  CHECK(near_reference(found.lr_equal_variance, expected.at("lr_equal_variance"), 1e-8));
}

TEST_CASE("rated detection agrees with R", "[analysis][ratings]") {
  for (const nlohmann::json& one : reference_numbers("ratings").at("rating")) {
    CAPTURE(one.at("name").get<std::string>());
    const nlohmann::json &input = one.at("input"), &expected = one.at("expected");
    const RatingRoc found = rating_roc(input.at("noise"), input.at("signal"));
    CHECK(found.categories_used == expected.at("categories_used").get<std::vector<int>>());
    CHECK(found.equal.status == RatingStatus::ok);
    CHECK(found.unequal.status == RatingStatus::ok);
    compare_equal(found.equal, expected.at("equal_variance"));
    compare_unequal(found.unequal, expected.at("unequal_variance"));
    CHECK(near_reference(found.area_trapezoid.value, expected.at("auc_trapezoid"), 1e-13));
    CHECK(near_reference(found.area_trapezoid.se, expected.at("auc_delong_se"), 1e-13));
  }
}

TEST_CASE("no search finds a likelier ROC", "[analysis][ratings]") {
  REQUIRE(rc::check("random ratings", [] {
    std::vector<int> noise = *rc::gen::container<std::vector<int>>(4, rc::gen::inRange(0, 9));
    std::vector<int> signal = *rc::gen::container<std::vector<int>>(4, rc::gen::inRange(0, 9));
    for (std::size_t j = 0; j < 4; ++j) ++(j % 2 == 0 ? noise : signal)[j];  // every category used
    const RatingRoc found = rating_roc(noise, signal);
    const std::vector<std::vector<double>> counts = {{noise.begin(), noise.end()}, {signal.begin(), signal.end()}};
    const auto value = [&](const std::vector<double>& place, double sigma) {
      return testing::plain_log_likelihood(counts, {place[0], place[1], place[2]}, {0, place[3]}, {1, sigma});
    };
    if (found.equal.status == RatingStatus::ok) {
      const double best = testing::highest_by_patterns(
          [&](const std::vector<double>& place) { return value(place, 1); }, {-1, 0, 1, 0});
      RC_ASSERT(std::abs(best - found.equal.log_likelihood) < 1e-5);
    }
    if (found.unequal.status == RatingStatus::not_applicable) return;
    for (const double ln_sigma : {-1.5, 0.0, 1.5}) {
      const double best = testing::highest_by_patterns(
          [&](const std::vector<double>& place) { return value(place, std::exp(place[4])); }, {-1, 0, 1, 0, ln_sigma});
      RC_ASSERT(best <= found.unequal.log_likelihood + 1e-6);
    }
    RC_ASSERT(found.unequal.log_likelihood >= found.equal.log_likelihood - 1e-9);
  }));
}

TEST_CASE("three ratings leave unequal variances nothing to miss: both points of the ROC are met",
          "[analysis][ratings]") {
  const RatingRoc found = rating_roc({22, 15, 9}, {5, 8, 30});
  CHECK(found.unequal.status == RatingStatus::ok);
  CHECK(found.unequal.deviance < 1e-9);
  CHECK(found.unequal.criteria.size() == 2);
  CHECK(found.unequal.lr_equal_variance == Approx(found.equal.deviance).epsilon(1e-9));
}

TEST_CASE("classes exchanged and ratings reversed give the mirror image", "[analysis][ratings]") {
  const std::vector<int> noise = {60, 40, 25, 15, 7, 3}, signal = {20, 14, 12, 16, 28, 60};
  const RatingRoc one = rating_roc(noise, signal), exchanged = rating_roc(signal, noise);
  CHECK(exchanged.equal.dprime.value == Approx(-one.equal.dprime.value).epsilon(1e-9));
  CHECK(exchanged.equal.dprime.se == Approx(one.equal.dprime.se).epsilon(1e-9));
  CHECK(exchanged.unequal.ln_sigma.value == Approx(-one.unequal.ln_sigma.value).epsilon(1e-7));
  CHECK(exchanged.unequal.d_a.value == Approx(-one.unequal.d_a.value).epsilon(1e-7));
  CHECK(exchanged.unequal.d_a.se == Approx(one.unequal.d_a.se).epsilon(1e-7));
  CHECK(exchanged.area_trapezoid.value == Approx(1 - one.area_trapezoid.value).epsilon(1e-12));
  CHECK(exchanged.area_trapezoid.se == Approx(one.area_trapezoid.se).epsilon(1e-12));
}

TEST_CASE("DeLong's error of the trapezoids is that of the placement values one by one", "[analysis][ratings]") {
  const std::vector<int> noise = {4, 2, 0, 1}, signal = {1, 2, 3, 3};
  std::vector<double> n, s;
  for (std::size_t j = 0; j < 4; ++j) {
    n.insert(n.end(), static_cast<std::size_t>(noise[j]), static_cast<double>(j));
    s.insert(s.end(), static_cast<std::size_t>(signal[j]), static_cast<double>(j));
  }
  const auto beats = [](double a, double b) { return a > b ? 1.0 : a == b ? 0.5 : 0.0; };
  const auto variance_of_mean = [](const std::vector<double>& values) {
    double mean = 0, squares = 0;
    for (const double v : values) mean += v / static_cast<double>(values.size());
    for (const double v : values) squares += (v - mean) * (v - mean);
    return squares / static_cast<double>(values.size() - 1) / static_cast<double>(values.size());
  };
  std::vector<double> of_signal, of_noise;
  double area = 0;
  for (const double a : s) {
    double sum = 0;
    for (const double b : n) sum += beats(a, b);
    of_signal.push_back(sum / static_cast<double>(n.size()));
    area += of_signal.back() / static_cast<double>(s.size());
  }
  for (const double b : n) {
    double sum = 0;
    for (const double a : s) sum += beats(a, b);
    of_noise.push_back(sum / static_cast<double>(s.size()));
  }
  const RatingRoc found = rating_roc(noise, signal);
  CHECK(found.area_trapezoid.value == Approx(area).epsilon(1e-13));
  CHECK(found.area_trapezoid.se ==
        Approx(std::sqrt(variance_of_mean(of_signal) + variance_of_mean(of_noise))).epsilon(1e-13));
}

TEST_CASE("statuses of rated detection", "[analysis][ratings]") {
  const RatingRoc separated = rating_roc({9, 1, 0, 0}, {0, 0, 1, 9});
  CHECK(separated.equal.status == RatingStatus::separated);
  CHECK(separated.equal.dprime.value == kInf);
  CHECK(separated.equal.area.value == 1);
  CHECK(separated.equal.criteria.empty());
  CHECK(std::isnan(separated.equal.dprime.se));
  CHECK(separated.unequal.status == RatingStatus::not_applicable);
  CHECK(rating_roc({0, 1, 9}, {9, 1, 0}).equal.dprime.value == -kInf);
  CHECK(std::isnan(rating_roc({0, 5, 1}, {0, 0, 6}).equal.area.value));  // they share a category

  // A signal that never has the middle ratings: of infinite variance, as far as these can say.
  const RatingRoc unbounded = rating_roc({10, 10, 10, 10}, {10, 0, 0, 10});
  CHECK(unbounded.equal.status == RatingStatus::ok);
  CHECK(unbounded.unequal.status == RatingStatus::unbounded);
  CHECK(std::isnan(unbounded.unequal.mu.value));
  CHECK(unbounded.unequal.deviance < 1e-4);
  CHECK(rating_roc({10, 10, 10, 10}, {0, 20, 0, 0}).unequal.status == RatingStatus::unbounded);
  CHECK(rating_roc({10, 5, 0}, {5, 8, 7}).unequal.status == RatingStatus::unbounded);

  const RatingRoc two = rating_roc({22, 0, 15}, {5, 0, 8});
  CHECK(two.categories_used == std::vector<int>{1, 3});
  CHECK(two.equal.status == RatingStatus::ok);
  CHECK(two.equal.deviance < 1e-10);
  CHECK(two.unequal.status == RatingStatus::not_applicable);
  CHECK(std::isnan(two.unequal.log_likelihood));

  const RatingRoc one = rating_roc({0, 9}, {0, 4});
  CHECK(one.equal.status == RatingStatus::no_information);
  CHECK(one.area_trapezoid.value == 0.5);
  CHECK(std::isnan(one.equal.dprime.value));
  const RatingRoc missing = rating_roc({0, 0, 0}, {1, 2, 3});
  CHECK(missing.equal.status == RatingStatus::missing);
  CHECK(missing.unequal.status == RatingStatus::missing);
  CHECK(std::isnan(missing.area_trapezoid.value));
  CHECK(std::isnan(rating_roc({1, 0}, {1, 3}).area_trapezoid.se));
  CHECK(rating_roc({}, {}).equal.status == RatingStatus::missing);
}

TEST_CASE("hundreds of millions of ratings", "[analysis][ratings]") {
  const RatingRoc found =
      rating_roc({400'000'000, 300'000'000, 100'000'000, 5}, {1, 100'000'000, 300'000'000, 400'000'001});
  CHECK(found.equal.status == RatingStatus::ok);
  CHECK(found.unequal.status == RatingStatus::ok);
  CHECK(found.unequal.log_likelihood >= found.equal.log_likelihood);
  CHECK(std::isfinite(found.unequal.d_a.se));
}

}  // namespace
}  // namespace jnd
