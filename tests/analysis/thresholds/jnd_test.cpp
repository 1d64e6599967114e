// The least-squares JND against an independent numpy model, its statuses and its cautions.
#include "analysis/thresholds/jnd.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "tests/catch.h"

namespace jnd {
namespace {

constexpr double kReference_n_per_m = 900;  // the papers' base of the Weber fraction

struct Case {
  std::array<SeriesCounts, 3> series;
  double slope, jnd, weber;
};

// Difference, counts -> slope, JND, Weber fraction; log-linear d', least squares through the origin (independent numpy
// model, 15 digits).
const std::vector<Case> kReference = {
    {{{{400, {6, 6, 6, 1}}, {300, {6, 5, 6, 1}}, {200, {6, 4, 6, 2}}}},
     0.00525577471564762,
     190.266907183593,
     0.211407674648436},
    {{{{400, {6, 4, 6, 2}}, {300, {6, 3, 6, 3}}, {200, {6, 2, 6, 4}}}},
     0.000504974285242165,
     1980.29885723872,
     2.20033206359858},
    {{{{400, {6, 6, 6, 0}}, {300, {6, 6, 6, 0}}, {200, {6, 6, 6, 0}}}},
     0.00909455457528945,
     109.955907320307,
     0.122173230355897},
    {{{{400, {7, 6, 5, 1}}, {300, {7, 5, 5, 2}}, {200, {7, 5, 5, 2}}}},
     0.00335950664264579,
     297.662754199065,
     0.330736393554516},
    {{{{400, {7, 7, 5, 0}}, {300, {4, 3, 8, 1}}, {200, {5, 3, 7, 1}}}},
     0.00632381890647433,
     158.132295498879,
     0.175702550554311},
    {{{{400, {8, 4, 4, 1}}, {300, {3, 1, 9, 5}}, {200, {4, 4, 8, 2}}}},
     0.00155403953281468,
     643.484273652162,
     0.71498252628018},
};

JndEstimate estimate(const std::vector<SeriesCounts>& series, Correction correction = Correction::loglinear) {
  return least_squares_jnd(series, kReference_n_per_m, correction);
}

bool has(const JndEstimate& estimate, Caution caution) {
  return std::find(estimate.cautions.begin(), estimate.cautions.end(), caution) != estimate.cautions.end();
}

TEST_CASE("least-squares slope, JND and Weber fraction agree with an independent model", "[analysis]") {
  for (const Case& one : kReference) {
    const JndEstimate found = least_squares_jnd(one.series, kReference_n_per_m, Correction::loglinear);
    CHECK(found.status == JndStatus::ok);
    CHECK(found.series_used == 3);
    CHECK(found.slope == Approx(one.slope).epsilon(1e-10));
    CHECK(found.jnd == Approx(one.jnd).epsilon(1e-10));
    CHECK(found.weber == Approx(one.weber).epsilon(1e-10));
    CHECK(has(found, Caution::few_trials));
  }
}

TEST_CASE("no difference noticed: no sensitivity, not a negative JND", "[analysis]") {
  const JndEstimate worse = estimate({{400, {6, 1, 6, 5}}, {200, {6, 2, 6, 4}}});
  CHECK(worse.status == JndStatus::no_sensitivity);
  CHECK(worse.slope < 0);
  CHECK(std::isnan(worse.jnd));
  CHECK(std::isnan(worse.weber));
  // d' of +x and -x at the same difference leave a rounding zero at most.
  CHECK(estimate({{300, {6, 5, 6, 2}}, {300, {6, 2, 6, 5}}}).status == JndStatus::no_sensitivity);
  // Without a correction, an infinitely bad series.
  CHECK(estimate({{400, {6, 0, 6, 6}}, {200, {6, 4, 6, 2}}}, Correction::none).status == JndStatus::no_sensitivity);
}

TEST_CASE("an infinite d' without correction is the ceiling: JND 0", "[analysis]") {
  const JndEstimate found = estimate({{400, {6, 6, 6, 1}}, {200, {6, 4, 6, 2}}}, Correction::none);
  CHECK(found.status == JndStatus::ceiling);
  CHECK(found.slope == kInf);
  CHECK(found.jnd == 0);
  CHECK(found.weber == 0);
  CHECK_FALSE(has(found, Caution::extrapolated));
  CHECK_FALSE(has(found, Caution::floor));
}

TEST_CASE("no information where every series is missing or of one answer", "[analysis]") {
  for (const auto& series : {std::vector<SeriesCounts>{}, std::vector<SeriesCounts>{{400, {12, 7, 0, 0}}},
                             std::vector<SeriesCounts>{{400, {6, 0, 6, 0}}, {200, {6, 6, 6, 6}}}}) {
    const JndEstimate found = estimate(series);
    CHECK(found.status == JndStatus::no_information);
    CHECK(std::isnan(found.slope));
    CHECK(std::isnan(found.jnd));
    CHECK(std::isnan(found.weber));
  }
  // Opposite infinities leave no slope to speak of.
  CHECK(estimate({{400, {6, 6, 6, 0}}, {200, {6, 0, 6, 6}}}, Correction::none).status == JndStatus::no_information);
}

TEST_CASE("a series of one answer stays in with its corrected d'; an empty class leaves its series out", "[analysis]") {
  const SeriesCounts good{400, {6, 5, 6, 1}};
  const double alone = estimate({good}).slope;
  const JndEstimate diluted = estimate({good, {300, {6, 0, 6, 0}}});
  CHECK(diluted.series_used == 2);
  CHECK(diluted.slope == Approx(alone * 400 * 400 / (400.0 * 400 + 300.0 * 300)).epsilon(1e-12));
  const JndEstimate without = estimate({good, {300, {12, 7, 0, 0}}});
  CHECK(without.series_used == 1);
  CHECK(without.slope == alone);
  CHECK(has(without, Caution::series_missing));
  CHECK_FALSE(has(diluted, Caution::series_missing));
}

TEST_CASE("cautions say what they are for, and only then", "[analysis]") {
  // 6 + 6 trials, all right: d' cannot exceed 2.93, so that the JND cannot fall below 110 N/m.
  const JndEstimate floor = estimate({{400, {6, 6, 6, 0}}, {300, {6, 6, 6, 0}}, {200, {6, 6, 6, 0}}});
  CHECK(has(floor, Caution::floor));
  CHECK(has(floor, Caution::extrapolated));
  CHECK(floor.jnd == Approx(109.955907320307).epsilon(1e-10));
  CHECK_FALSE(has(estimate({{400, {6, 6, 6, 0}}, {200, {6, 5, 6, 0}}}), Caution::floor));

  const JndEstimate plain = estimate({{400, {100, 80, 100, 30}}, {200, {100, 60, 100, 30}}});
  CHECK(plain.jnd > 200);
  CHECK(plain.jnd < 400);
  CHECK(plain.cautions.empty());
  CHECK(has(estimate({{400, {100, 80, 9, 3}}, {200, {100, 60, 100, 30}}}), Caution::few_trials));
  CHECK_FALSE(has(estimate({{400, {10, 8, 10, 3}}}), Caution::few_trials));
}

}  // namespace
}  // namespace jnd
