// Sureness: R's numbers, searches by patterns, statuses and edges.
#include "analysis/ratings/sureness.h"

#include <rapidcheck.h>

#include "tests/analysis/ratings/ratings_fixtures.h"

namespace jnd {
namespace {

using testing::near_reference;

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
