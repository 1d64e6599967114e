// The least-squares JND and its bootstrap.
#include "analysis/thresholds/jnd.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/numerics/special_values.h"
#include "analysis/selftest/reference_numbers.h"
#include "analysis/thresholds/jnd_bootstrap.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// The least-squares JND against an independent numpy model, its statuses and its cautions.

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

// The bootstrap interval of a least-squares JND against the exact distribution of its slope.

double binomial(int k, int n, double p) {
  double value = std::pow(p, k) * std::pow(1 - p, n - k);
  for (int i = 1; i <= k; ++i) value *= static_cast<double>(n - k + i) / i;
  return value;
}

// Every outcome of two series, with its slope and its probability under the log-linear rates.
struct Outcome {
  double slope, probability;
};
std::vector<Outcome> all_outcomes(const std::vector<SeriesCounts>& series) {
  std::vector<Outcome> outcomes = {{0, 1}};
  std::vector<std::vector<SeriesCounts>> counts = {{}};
  for (const SeriesCounts& one : series) {
    std::vector<Outcome> more;
    std::vector<std::vector<SeriesCounts>> more_counts;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      for (int hits = 0; hits <= one.counts.n_diff; ++hits) {
        for (int alarms = 0; alarms <= one.counts.n_same; ++alarms) {
          const double p =
              binomial(hits, one.counts.n_diff, (one.counts.hits + 0.5) / (one.counts.n_diff + 1.0)) *
              binomial(alarms, one.counts.n_same, (one.counts.false_alarms + 0.5) / (one.counts.n_same + 1.0));
          more.push_back({0, outcomes[i].probability * p});
          more_counts.push_back(counts[i]);
          more_counts.back().push_back({one.difference, {one.counts.n_diff, hits, one.counts.n_same, alarms}});
        }
      }
    }
    outcomes = more;
    counts = more_counts;
  }
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    outcomes[i].slope = least_squares_jnd(counts[i], 900, Correction::loglinear).slope;
  return outcomes;
}

// P(slope <= bound), or P(slope >= bound), of the outcomes with a slope.
double share(const std::vector<Outcome>& outcomes, double bound, bool below) {
  double inside = 0, all = 0;
  for (const Outcome& one : outcomes) {
    if (std::isnan(one.slope)) continue;
    all += one.probability;
    if (below ? one.slope <= bound + 1e-12 : one.slope >= bound - 1e-12) inside += one.probability;
  }
  return inside / all;
}

const std::vector<SeriesCounts> kSeries = {{400, {6, 5, 6, 1}}, {200, {6, 4, 6, 2}}};

TEST_CASE("bootstrap bounds lie where the exact distribution has its 2.5 % tails", "[analysis][jnd]") {
  const std::vector<Outcome> exact = all_outcomes(kSeries);
  const JndBootstrap found = least_squares_bootstrap(kSeries, Correction::loglinear, 20'000, 7);
  // A discrete distribution: the tail that includes the bound holds 2.5 % at least, the one beyond it less, within the
  // sampling error of 20,000 replicates (0.11 % is one standard deviation).
  CHECK(share(exact, found.slope_ci_low, true) > 0.025 - 0.005);
  CHECK(1 - share(exact, found.slope_ci_low, false) < 0.025 + 0.005);
  CHECK(share(exact, found.slope_ci_high, false) > 0.025 - 0.005);
  CHECK(1 - share(exact, found.slope_ci_high, true) < 0.025 + 0.005);
  double not_positive = 0;
  for (const Outcome& one : exact)
    if (one.slope <= 1e-9) not_positive += one.probability;
  CHECK(found.no_sensitivity / 20'000.0 == Approx(not_positive).margin(0.006));
  CHECK(found.ok + found.no_sensitivity + found.ceiling + found.no_information == found.replicates);
}

TEST_CASE("replicates without sensitivity count as infinite JNDs, and none is dropped for it", "[analysis][jnd]") {
  const std::vector<SeriesCounts> poor = {{400, {6, 3, 6, 2}}, {200, {6, 2, 6, 3}}};
  const JndBootstrap found = least_squares_bootstrap(poor, Correction::loglinear, 2000, 1);
  CHECK(found.no_sensitivity > 200);
  CHECK(found.slope_ci_low < 0);
  CHECK(found.ci_high == kInf);
  CHECK(found.ci_low == Approx(1 / found.slope_ci_high));
}

TEST_CASE("without correction a replicate may be at the ceiling or without a slope, and is counted",
          "[analysis][jnd]") {
  const std::vector<SeriesCounts> good = {{400, {6, 6, 6, 0}}, {200, {6, 5, 6, 0}}};
  const JndBootstrap found = least_squares_bootstrap(good, Correction::none, 2000, 1);
  CHECK(found.ceiling > 0);
  CHECK(found.ceiling + found.ok + found.no_sensitivity + found.no_information == 2000);
  CHECK(found.slope_ci_high == kInf);
  CHECK(found.ci_low == 0);
}

TEST_CASE("the same seed gives the same interval, another one another, on every machine", "[analysis][jnd]") {
  const JndBootstrap a = least_squares_bootstrap(kSeries, Correction::loglinear, 500, 3);
  const JndBootstrap b = least_squares_bootstrap(kSeries, Correction::loglinear, 500, 3);
  const JndBootstrap other = least_squares_bootstrap(kSeries, Correction::loglinear, 500, 4);
  CHECK(a.slope_ci_low == b.slope_ci_low);
  CHECK(a.no_sensitivity == b.no_sensitivity);
  CHECK((a.slope_ci_low != other.slope_ci_low || a.slope_ci_high != other.slope_ci_high ||
         a.no_sensitivity != other.no_sensitivity));
}

TEST_CASE("nothing to draw from gives no interval", "[analysis][jnd]") {
  const std::vector<SeriesCounts> missing = {{400, {6, 5, 0, 0}}};
  const JndBootstrap found = least_squares_bootstrap(missing, Correction::loglinear, 100, 1);
  CHECK(found.no_information == 100);
  CHECK(std::isnan(found.ci_low));
  CHECK(std::isnan(found.ci_high));
}

// Every method of a threshold against independent numbers (jnd_reference.json: numpy model with two optimisers, glm of
// R 4.2.2), and single series against sensR 1.5-3.

using json = nlohmann::json;

const json& cases() {
  return reference_numbers("jnd").at("cases");
}

// Equal, both undefined, or within a relative tolerance.
bool agrees(double ours, double reference, double tolerance) {
  if (std::isnan(reference)) return std::isnan(ours);
  return ours == reference || std::abs(ours - reference) <= tolerance * std::abs(reference);
}

std::vector<SeriesCounts> series_of(const json& one) {
  std::vector<SeriesCounts> series;
  for (const json& row : one.at("series")) series.push_back({row[0], {row[1], row[2], row[3], row[4]}});
  return series;
}

JndEstimate estimate(const json& one, std::string_view method) {
  return estimate_jnd(series_of(one), one.at("reference"), *jnd_method_from(method), Correction::loglinear);
}

TEST_CASE("closed forms of the JND agree with an independent model to 1e-10", "[analysis][jnd]") {
  for (const json& one : cases()) {
    CAPTURE(one.at("id"));
    for (const char* method : {"least_squares", "weighted", "inverse_mean_slope", "mean_of_ratios"}) {
      CAPTURE(method);
      const JndEstimate found = estimate(one, method);
      const json& expected = one.at(method);
      // The reference prints a mean over a pole; the product refuses it.
      const double jnd = expected.value("defined", true) ? reference_number(expected.at("jnd")) : std::nan("");
      CHECK(to_string(found.method) == method);
      CHECK(agrees(found.jnd, jnd, 1e-10));
      CHECK(found.status == (std::isnan(jnd) ? JndStatus::no_sensitivity : JndStatus::ok));
      if (expected.contains("slope")) CHECK(agrees(found.slope, reference_number(expected.at("slope")), 1e-10));
      if (expected.contains("weber")) CHECK(agrees(found.weber, reference_number(expected.at("weber")), 1e-10));
      CHECK(std::isnan(found.ci_low));
      CHECK(std::isnan(found.ci_high));
      CHECK(std::isnan(found.log_likelihood));
    }
    std::size_t place = 0;
    for (const SeriesCounts& series : series_of(one))
      CHECK(
          agrees(std::sqrt(loglinear_variance(series.counts)), reference_number(one.at("se_dprime")[place++]), 1e-10));
  }
}

TEST_CASE("joint maximum likelihood agrees with an independent model, slope 1e-6, bounds 1e-5", "[analysis][jnd]") {
  for (const json& one : cases()) {
    CAPTURE(one.at("id"));
    for (const char* method :
         {"ml_yes_no_common", "ml_yes_no_series", "ml_differencing_common", "ml_differencing_series"}) {
      CAPTURE(method);
      const JndEstimate found = estimate(one, method);
      const json& expected = one.at(method);
      CHECK(to_string(found.status) == expected.at("status").get<std::string>());
      CHECK(agrees(found.slope, reference_number(expected.at("slope")), 1e-6));
      CHECK(agrees(found.jnd, reference_number(expected.at("jnd")), 1e-6));
      CHECK(agrees(found.slope_ci_low, reference_number(expected.at("slope_ci_low")), 1e-5));
      CHECK(agrees(found.slope_ci_high, reference_number(expected.at("slope_ci_high")), 1e-5));
      CHECK(agrees(found.ci_low, reference_number(expected.at("ci_low")), 1e-5));
      CHECK(agrees(found.ci_high, reference_number(expected.at("ci_high")), 1e-5));
      CHECK(std::abs(found.log_likelihood - reference_number(expected.at("log_likelihood"))) < 1e-10);
      // At the ceiling glm iterates towards infinity until it gives up; elsewhere it is another implementation.
      if (expected.contains("glm_slope") && found.status == JndStatus::ok)
        CHECK(agrees(found.slope, reference_number(expected.at("glm_slope")), 1e-6));
    }
  }
}

TEST_CASE("one series of difference 1 is the differencing d' of sensR, with its profile bounds", "[analysis][jnd]") {
  // sensR 1.5-3, samediff and its profile: counts, d', bounds.
  struct Single {
    Counts counts;
    double dprime, low, high;
  };
  const std::vector<Single> singles = {
      {{6, 5, 6, 1}, 3.32345442597307, 1.1596240043235, 5.74056421492212},
      {{6, 6, 6, 2}, kInf, 1.88757008011582, kInf},
      {{6, 3, 6, 3}, 0, 0, 2.68316652494473},
      {{6, 2, 6, 4}, 0, 0, 1.88306249335704},
      {{18, 15, 18, 4}, 3.09253182304492, 1.89905433470809, 4.37200056029212},
      {{200, 150, 200, 30}, 2.98883001526532, 2.62815352150113, 3.35905128692991},
      {{36, 36, 36, 5}, kInf, 4.27584980861053, kInf},
      {{6, 5, 6, 0}, kInf, 2.27112678695645, kInf},
  };
  for (const Single& one : singles) {
    CAPTURE(one.counts.hits, one.counts.n_diff, one.counts.false_alarms);
    for (const JndMethod method : {JndMethod::ml_differencing_series, JndMethod::ml_differencing_common}) {
      const std::vector<SeriesCounts> series = {{1, one.counts}};
      const JndEstimate found = estimate_jnd(series, 900, method, Correction::none);
      CHECK(agrees(found.slope, one.dprime, 1e-8));
      CHECK(agrees(found.slope_ci_low, one.low, 1e-6));
      CHECK(agrees(found.slope_ci_high, one.high, 1e-6));
    }
  }
}

}  // namespace
}  // namespace jnd
