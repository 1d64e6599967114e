// Ratings: rated detection, sureness and the ordered probit.
#include "analysis/ratings/rating_roc.h"

#include <algorithm>
#include <random>

#include <rapidcheck.h>

#include "analysis/numerics/normal.h"
#include "analysis/ratings/ordinal_probit.h"
#include "analysis/ratings/sureness.h"
#include "tests/analysis/ratings/ratings_fixtures.h"

namespace jnd {
namespace {

// The ordered probit itself: derivatives against differences, cells far out in the tails, and what recedes.

TEST_CASE("derivatives of the ordered probit are those of its value", "[analysis][ratings]") {
  const OrdinalProbit model({{5, 0, 3, 2}, {1, 4, 2, 6}, {0, 0, 7, 3}}, {{0, 0.5}, {1, -1}, {2, 0}},
                            {false, true, true});
  const std::vector<double> place = {-0.7, 0.2, 1.1, 0.4, -0.3, 0.25};
  NewtonDerivatives at, above, below;
  model.derivatives(place, at);
  CHECK(at.value == Approx(model.value(place)));
  for (std::size_t p = 0; p < place.size(); ++p) {
    const double h = 1e-5;
    std::vector<double> up = place, down = place;
    up[p] += h;
    down[p] -= h;
    model.derivatives(up, above);
    model.derivatives(down, below);
    CHECK(at.gradient[p] == Approx((above.value - below.value) / (2 * h)).epsilon(1e-7).margin(1e-7));
    for (std::size_t q = 0; q < place.size(); ++q)
      CHECK(at.curvature[p * place.size() + q] ==
            Approx(-(above.gradient[q] - below.gradient[q]) / (2 * h)).epsilon(1e-6).margin(1e-6));
  }
}

TEST_CASE("cells far out in a tail have a finite logarithm with the right slope", "[analysis][ratings]") {
  const OrdinalProbit model({{0, 1, 0}, {0, 0, 1}}, {{1}, {-1}});
  NewtonDerivatives at;
  for (const double eta : {31.0, 60.0, 400.0, 1e4}) {
    CAPTURE(eta);
    model.derivatives({0, 1, eta, 0}, at);
    const double cell = log_normal_cdf(1 - eta).log_cdf +
                        std::log1p(-std::exp(log_normal_cdf(-eta).log_cdf - log_normal_cdf(1 - eta).log_cdf));
    CHECK(at.value == Approx(cell + log_normal_cdf(-1 - eta).log_cdf).epsilon(1e-12));
    CHECK(std::isfinite(at.gradient[2]));
    // d ln Phi(x) / dx tends to -x: of the first row at 1 - eta, of the second at -1 - eta.
    CHECK(at.gradient[2] == Approx(-(eta - 1) - (eta + 1)).epsilon(3 / eta));
    CHECK(at.curvature[2 * 4 + 2] == Approx(2).epsilon(0.05));
  }
  // mpmath 1.3, 40 digits.
  CHECK(log_normal_cdf(-31).log_cdf == Approx(-484.85396362717928858).epsilon(1e-14));
  CHECK(log_normal_cdf(-60).log_cdf == Approx(-1805.0135606805671387).epsilon(1e-14));
  CHECK(log_normal_cdf(-400).log_cdf == Approx(-80006.910409330215001).epsilon(1e-14));
  // A narrow cell in the tail: its mass is density times width.
  const OrdinalProbit narrow({{0, 1, 0}}, {{0}});
  const double middle = 40 + 0.5e-7;
  CHECK(narrow.value({40, 40 + 1e-7, 0, 0}) == Approx(log_normal_density(middle) + std::log(1e-7)).epsilon(1e-9));
}

TEST_CASE("criteria out of order are impossible", "[analysis][ratings]") {
  const OrdinalProbit model({{1, 1, 1}}, {{0}});
  CHECK(model.value({1, 0, 0, 0}) == -kInf);
  CHECK(model.value({1, 1, 0, 0}) == -kInf);
  CHECK(std::isfinite(model.value({0, 1, 0, 0})));
}

// Whether the likelihood at the best criteria still rises, or stays, far along the direction.
bool rises_far_out(const CategoryCounts& counts, double per_row) {
  const OrdinalProbit model(counts, {{0}, {1}, {per_row}});
  const auto at = [&](double effect) {
    NewtonBox box = model.box();
    box.lower[model.criteria()] = box.upper[model.criteria()] = effect;
    std::vector<double> start = model.start();
    double value = 0;
    for (double e = 0; e <= effect; e += 0.5) {  // small steps: a warm start each
      box.lower[model.criteria()] = box.upper[model.criteria()] = e;
      const OrdinalFit fit = fit_ordinal(model, box, start);
      start = fit.place;
      value = fit.log_likelihood;
    }
    return value;
  };
  return at(14) >= at(10) - 1e-9;
}

TEST_CASE("what recedes is what keeps rising", "[analysis][ratings]") {
  std::mt19937 random(7);
  int receding = 0;
  for (int i = 0; i < 300; ++i) {
    CategoryCounts counts(3, std::vector<double>(4, 0));
    for (std::size_t row = 0; row < 3; ++row)
      for (int k = 0; k < 3; ++k) {
        const std::size_t centre = row + random() % 2;
        counts[row][std::min<std::size_t>(3, random() % 4 == 0 ? random() % 4 : centre)] += 1;
      }
    counts = used_categories(counts).counts;
    if (counts.front().size() < 2) continue;
    const bool found = recedes(counts, {0, 1, 2});
    receding += found;
    CHECK(found == rises_far_out(counts, 2));
  }
  CHECK(receding > 10);
}

TEST_CASE("unused categories go, and the saturated likelihood stays", "[analysis][ratings]") {
  const CategoryCounts counts = {{3, 0, 0, 1}, {2, 0, 5, 0}};
  const UsedCategories used = used_categories(counts);
  CHECK(used.used == std::vector<int>{0, 2, 3});
  CHECK(used.counts == CategoryCounts{{3, 0, 1}, {2, 5, 0}});
  CHECK(saturated_log_likelihood(used.counts) == saturated_log_likelihood(counts));
  CHECK(saturated_log_likelihood({{0, 0}}) == 0);
}

// Rated detection: R's numbers, searches by patterns, statuses and edges.

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

// Sureness: R's numbers, searches by patterns, statuses and edges.

std::vector<SurenessLevel> sureness_levels(const std::vector<double>& deltas,
                                           const std::vector<std::vector<int>>& counts) {
  std::vector<SurenessLevel> levels;
  for (std::size_t i = 0; i < deltas.size(); ++i) levels.push_back({deltas[i], counts[i]});
  return levels;
}

TEST_CASE("sureness agrees with R", "[analysis][ratings]") {
  for (const nlohmann::json& one : reference_numbers("ratings").at("sureness")) {
    CAPTURE(one.at("name").get<std::string>());
    const nlohmann::json &input = one.at("input"), &expected = one.at("expected");
    const Sureness found = sureness(sureness_levels(input.at("dK"), input.at("counts")));
    CHECK(to_string(found.status) == expected.at("status").get<std::string>());
    CHECK(found.categories_used == expected.at("categories_used").get<std::vector<int>>());
    CHECK(near_reference(found.log_likelihood_saturated, expected.at("loglik_saturated"), 1e-9));
    CHECK(near_reference(found.log_likelihood, expected.at("loglik"), 1e-9));
    CHECK(near_reference(found.deviance, expected.at("deviance"), 1e-8));
    CHECK(near_reference(found.lr_zero_slope, expected.at("lr_zero_slope"), 1e-8));
    CHECK(near_reference(found.ln_sigma_se, expected.value("ln_sigma_se", nlohmann::json()), 1e-6));
    const double sigma = reference_number(expected.at("sigma"));
    CHECK((found.sigma == sigma || found.sigma == Approx(sigma).epsilon(1e-7)));
    REQUIRE(found.criteria.size() == expected.at("criteria").size());
    for (std::size_t j = 0; j < found.criteria.size(); ++j)
      CHECK(near_reference(found.criteria[j], expected.at("criteria").at(j), 1e-6));
    CHECK(found.sigma_low == Approx(reference_number(expected.at("sigma_ci").at(0))).epsilon(1e-6));
    const double high = reference_number(expected.at("sigma_ci").at(1));
    CHECK((found.sigma_high == high || found.sigma_high == Approx(high).epsilon(1e-6)));
  }
}

TEST_CASE("no search finds a likelier sureness, and the interval ends where the profile says", "[analysis][ratings]") {
  REQUIRE(rc::check("random tables", [] {
    const std::vector<double> deltas = {0, 1, 2.5};
    std::vector<std::vector<int>> counts;
    std::vector<std::vector<double>> plain;
    for (std::size_t i = 0; i < deltas.size(); ++i) {
      counts.push_back(*rc::gen::container<std::vector<int>>(4, rc::gen::inRange(0, 7)));
      plain.emplace_back(counts.back().begin(), counts.back().end());
    }
    for (std::size_t j = 0; j < 4; ++j) {  // every category used, every level presented
      ++counts[j % 3][j];
      ++plain[j % 3][j];
    }
    const Sureness found = sureness(sureness_levels(deltas, counts));
    RC_PRE(found.status == SurenessStatus::ok || found.status == SurenessStatus::flat);
    const std::vector<double> scale(3, 1);
    const auto at_slope = [&](double slope, const std::vector<double>& criteria) {
      return testing::plain_log_likelihood(plain, criteria, {0, slope, 2.5 * slope}, scale);
    };
    const std::vector<double> start = {-1, 0, 1};
    // The likelihood is concave: where the slope is positive at its highest, it is so without a bound too.
    const double steepest = found.status == SurenessStatus::ok ? 1 : 0;
    const double best = testing::highest_by_patterns(
        [&](const std::vector<double>& place) {
          return at_slope(steepest * place[3], {place[0], place[1], place[2]});
        },
        {-1, 0, 1, 0.5});
    RC_ASSERT(best <= found.log_likelihood + 1e-7);
    RC_ASSERT(best >= found.log_likelihood - 1e-4);
    RC_ASSERT(found.sigma_low < found.sigma && found.sigma <= found.sigma_high);
    for (const double end : {found.sigma_low, found.sigma_high}) {
      if (std::isinf(end)) continue;
      const double highest = testing::highest_by_patterns(
          [&](const std::vector<double>& criteria) { return at_slope(1 / end, criteria); }, start);
      RC_ASSERT(std::abs(2 * (found.log_likelihood - highest) - 3.841458820694124) < 1e-3);
    }
  }));
}

TEST_CASE("sureness does not depend on the unit, nor on how rows are cut up", "[analysis][ratings]") {
  const std::vector<std::vector<int>> counts = {{14, 6, 3, 1}, {9, 6, 5, 4}, {4, 5, 7, 8}};
  const Sureness one = sureness(sureness_levels({0, 1, 3}, counts));
  const Sureness small = sureness(sureness_levels({0, 1e-9, 3e-9}, counts));
  CHECK(small.sigma == Approx(1e-9 * one.sigma).epsilon(1e-9));
  CHECK(small.sigma_high == Approx(1e-9 * one.sigma_high).epsilon(1e-9));
  CHECK(small.log_likelihood == Approx(one.log_likelihood).epsilon(1e-12));
  const Sureness cut = sureness({{3, {4, 5, 0, 8}}, {0, {14, 6, 3, 1}}, {1, {9, 6, 5, 4}}, {3, {0, 0, 7, 0}}});
  CHECK(cut.sigma == Approx(one.sigma).epsilon(1e-10));
  CHECK(cut.log_likelihood_saturated == Approx(one.log_likelihood_saturated).epsilon(1e-14));
  // A shift of all levels moves the criteria alone.
  const Sureness far = sureness(sureness_levels({1e5 - 1, 1e5, 1e5 + 2}, counts));
  CHECK(far.sigma == Approx(one.sigma).epsilon(1e-9));
  CHECK(far.sigma_low == Approx(one.sigma_low).epsilon(1e-9));
  CHECK(far.log_likelihood == Approx(one.log_likelihood).epsilon(1e-12));
  CHECK(far.criteria[0] == Approx(one.criteria[0] + (1e5 - 1) / one.sigma).epsilon(1e-10));
}

TEST_CASE("statuses of sureness", "[analysis][ratings]") {
  const Sureness separated = sureness(sureness_levels({0, 250}, {{10, 5, 0, 0}, {0, 0, 4, 8}}));
  CHECK(separated.status == SurenessStatus::separated);
  CHECK(separated.sigma == 0);
  CHECK(separated.sigma_low == 0);
  CHECK(std::isfinite(separated.sigma_high));
  CHECK(separated.criteria.empty());
  CHECK(separated.log_likelihood == separated.log_likelihood_saturated);
  CHECK(separated.lr_zero_slope > 0);
  // Its interval ends where the profile has fallen far enough, as everywhere.
  const double highest = testing::highest_by_patterns(
      [&](const std::vector<double>& criteria) {
        return testing::plain_log_likelihood({{10, 5, 0, 0}, {0, 0, 4, 8}}, criteria, {0, 250 / separated.sigma_high},
                                             {1, 1});
      },
      {0, 1, 2});
  CHECK(2 * (separated.log_likelihood - highest) == Approx(3.841458820694124).epsilon(1e-4));

  // A category that both sides of a criterion share does not bound the slope, two levels on the same criterion do.
  CHECK(sureness(sureness_levels({0, 1, 2}, {{5, 5, 0}, {0, 5, 0}, {0, 5, 5}})).status == SurenessStatus::separated);
  CHECK(sureness(sureness_levels({0, 1, 2}, {{5, 5, 0, 0}, {0, 0, 5, 3}, {0, 0, 3, 5}})).status == SurenessStatus::ok);

  const Sureness flat = sureness(sureness_levels({0, 1}, {{4, 4, 4, 4}, {2, 2, 2, 2}}));
  CHECK(flat.status == SurenessStatus::flat);
  CHECK(flat.sigma == kInf);
  CHECK(flat.sigma_high == kInf);
  CHECK(flat.lr_zero_slope == 0);
  CHECK(sureness(sureness_levels({0, 1}, {{0, 0, 4, 4}, {2, 2, 0, 0}})).status == SurenessStatus::flat);

  CHECK(sureness(sureness_levels({0, 1}, {{0, 4, 0, 0}, {0, 9, 0, 0}})).status == SurenessStatus::no_information);
  CHECK(sureness(sureness_levels({100}, {{3, 4, 1, 0}})).status == SurenessStatus::not_identified);
  CHECK(sureness(sureness_levels({0, 1}, {{3, 4, 1, 0}, {0, 0, 0, 0}})).status == SurenessStatus::not_identified);
  CHECK(sureness({}).status == SurenessStatus::missing);
  const Sureness missing = sureness(sureness_levels({0, 1}, {{0, 0}, {0, 0}}));
  CHECK(missing.status == SurenessStatus::missing);
  for (const double number : {missing.log_likelihood, missing.sigma, missing.sigma_low, missing.deviance})
    CHECK(std::isnan(number));

  const Sureness unused = sureness(sureness_levels({0, 1}, {{6, 0, 3, 1}, {2, 0, 4, 5}}));
  CHECK(unused.categories_used == std::vector<int>{1, 3, 4});
  CHECK(unused.criteria.size() == 2);
}

TEST_CASE("sureness of hundreds of millions of answers, and of an answer 40 sigma out", "[analysis][ratings]") {
  const Sureness many = sureness(sureness_levels({0, 1}, {{400'000'000, 100'000'000, 50'000'000, 20'000'000},
                                                          {300'000'000, 150'000'000, 90'000'000, 60'000'000}}));
  CHECK(many.status == SurenessStatus::ok);
  CHECK(many.sigma_high / many.sigma_low < 1.001);
  CHECK(many.sigma_low < many.sigma);
  CHECK(many.sigma_high > many.sigma);
  const Sureness steep = sureness(sureness_levels({0, 1, 1000}, {{9, 1, 0, 0}, {1, 9, 0, 0}, {1, 0, 0, 9}}));
  CHECK(steep.status == SurenessStatus::ok);
  CHECK(std::isfinite(steep.log_likelihood));
  CHECK(steep.sigma_low < steep.sigma);
}

}  // namespace
}  // namespace jnd
