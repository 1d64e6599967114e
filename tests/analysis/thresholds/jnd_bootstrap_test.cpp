// The bootstrap interval of a least-squares JND against the exact distribution of its slope.
#include "analysis/thresholds/jnd_bootstrap.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "tests/catch.h"

namespace jnd {
namespace {

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

}  // namespace
}  // namespace jnd
