// Which cue explains the answers: simulated observers who use one cue only, and fits against brute force.
#include "analysis/behaviour/cue_strategy.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "tests/catch.h"

namespace jnd {
namespace {

double uniform(std::mt19937_64& generator) {
  return (static_cast<double>(generator() >> 11U) + 0.5) * 0x1p-53;
}

// Presses that vary: force, work and dwell follow the stiffness, each with a spread of its own.
std::vector<CueTrial> observer_of(Cue used, int trials, std::mt19937_64& generator) {
  std::vector<CueTrial> all;
  for (int i = 0; i < trials; ++i) {
    CueTrial trial;
    const double stiffness = 400 * uniform(generator);
    trial.difference = {stiffness, std::abs(0.005 * stiffness + normal_quantile(uniform(generator))),
                        1e-3 * std::abs(0.02 * stiffness + 5 * normal_quantile(uniform(generator))),
                        std::abs(normal_quantile(uniform(generator)))};
    const double largest[] = {400, 3, 13e-3, 2};
    const auto place = static_cast<std::size_t>(used);
    const double felt = trial.difference[place].value_or(0) / largest[place];
    trial.said_different = normal_cdf(6 * (felt - 0.4)) > uniform(generator);
    all.push_back(trial);
  }
  return all;
}

std::vector<CueTrial> some_trials(int n = 60) {
  std::mt19937_64 generator(4);
  return observer_of(Cue::stiffness, n, generator);
}

double plain_log_likelihood(const std::vector<CueTrial>& trials, Cue cue, double l, double b, double mean, double sd) {
  double sum = 0;
  for (const CueTrial& trial : trials) {
    const double z = (trial.difference[static_cast<std::size_t>(cue)].value_or(0) - mean) / sd;
    sum += std::log(0.5 * std::erfc((trial.said_different ? -1 : 1) * (l + b * z) / std::sqrt(2.0)));
  }
  return sum;
}

TEST_CASE("an observer who uses one cue alone is found out, and the other cues add nothing to stiffness", "[cues]") {
  std::mt19937_64 generator(2);
  for (const Cue used : kCues) {
    const CueStrategy found = cue_strategy(observer_of(used, 400, generator));
    CAPTURE(to_string(used));
    REQUIRE(found.status == CueStatus::ok);
    REQUIRE(found.best.has_value());
    CHECK(found.best.value_or(Cue::stiffness) == used);
    CHECK(found.common_trials == 400);
    for (const CueFit& fit : found.cues) {
      CHECK(fit.status == CueStatus::ok);
      CHECK(fit.n == 400);
      const CuePartialTest& partial = fit.beside_stiffness;
      if (fit.cue == Cue::stiffness) {
        CHECK(std::isnan(partial.p));
      } else if (fit.cue == used) {
        CHECK(partial.p < 1e-6);
      } else if (used == Cue::stiffness) {
        CHECK(partial.p > 1e-3);
      }
    }
  }
}

TEST_CASE("the fit is the maximum of the likelihood, and its numbers follow from it", "[cues]") {
  const std::vector<CueTrial> trials = some_trials();
  const CueStrategy found = cue_strategy(trials);
  for (const CueFit& fit : found.cues) {
    CAPTURE(to_string(fit.cue));
    REQUIRE(fit.status == CueStatus::ok);
    double mean = 0, square = 0, different = 0;
    const double n = 60;
    for (const CueTrial& trial : trials) {
      const double x = trial.difference[static_cast<std::size_t>(fit.cue)].value_or(0);
      mean += x / n;
      square += x * x / n;
      different += trial.said_different ? 1 : 0;
    }
    const double sd = std::sqrt(square - mean * mean);
    CHECK(fit.sd == Approx(sd).epsilon(1e-10));
    const auto at = [&](double l, double b) { return plain_log_likelihood(trials, fit.cue, l, b, mean, sd); };
    CHECK(fit.log_likelihood == Approx(at(fit.intercept, fit.slope)).epsilon(1e-10));
    for (double l = -2; l <= 2; l += 0.1)
      for (double b = -3; b <= 3; b += 0.1) CHECK(at(l, b) <= fit.log_likelihood + 1e-12);
    const double h = 1e-4;
    const auto d = [&](double dl, double db) {
      return (at(fit.intercept + dl, fit.slope + db) - at(fit.intercept - dl, fit.slope - db)) / (2 * h);
    };
    CHECK(std::abs(d(h, 0)) < 1e-5);
    CHECK(std::abs(d(0, h)) < 1e-5);
    // Observed information by second differences, inverted.
    const double k = 1e-3, top = at(fit.intercept, fit.slope);
    const double ll = (at(fit.intercept + k, fit.slope) - 2 * top + at(fit.intercept - k, fit.slope)) / (k * k);
    const double bb = (at(fit.intercept, fit.slope + k) - 2 * top + at(fit.intercept, fit.slope - k)) / (k * k);
    const double lb = (at(fit.intercept + k, fit.slope + k) - at(fit.intercept + k, fit.slope - k) -
                       at(fit.intercept - k, fit.slope + k) + at(fit.intercept - k, fit.slope - k)) /
                      (4 * k * k);
    CHECK(fit.slope_se == Approx(std::sqrt(-ll / (ll * bb - lb * lb))).epsilon(1e-4));
    const double constant = different * std::log(different / n) + (n - different) * std::log(1 - different / n);
    CHECK(fit.deviance_explained == Approx(1 - fit.log_likelihood / constant).epsilon(1e-10));
    CHECK(fit.aic == Approx(4 - 2 * fit.log_likelihood).epsilon(1e-12));
  }
}

TEST_CASE("the partial test compares maxima: both predictors against stiffness alone", "[cues]") {
  const std::vector<CueTrial> trials = some_trials();
  const CueStrategy found = cue_strategy(trials);
  const CueFit& dwell = found.cues[static_cast<std::size_t>(Cue::dwell)];
  // Coordinate ascent on the likelihood of l + b1 x1 + b2 x2, raw predictors scaled to about 1.
  double beta[3] = {0, 0, 0};
  const auto value = [&](const double* b) {
    double sum = 0;
    for (const CueTrial& trial : trials) {
      const double u = b[0] + b[1] * trial.difference[0].value_or(0) / 200 + b[2] * trial.difference[3].value_or(0);
      sum += std::log(0.5 * std::erfc((trial.said_different ? -u : u) / std::sqrt(2.0)));
    }
    return sum;
  };
  double best = value(beta);
  for (double step = 1; step > 1e-7; step /= 2)
    for (bool moved = true; moved;) {
      moved = false;
      for (double& one : beta)
        for (const double move : {step, -step}) {
          one += move;
          if (const double now = value(beta); now > best + 1e-13) {
            best = now;
            moved = true;
          } else {
            one -= move;
          }
        }
    }
  REQUIRE(dwell.beside_stiffness.status == CueStatus::ok);
  CHECK(dwell.beside_stiffness.chi_square == Approx(2 * (best - found.cues[0].log_likelihood)).margin(1e-6));
  CHECK(dwell.beside_stiffness.p == Approx(std::erfc(std::sqrt(dwell.beside_stiffness.chi_square / 2))).epsilon(1e-9));
}

TEST_CASE("neither units nor the order of trials matter", "[cues]") {
  std::vector<CueTrial> trials = some_trials(), other = trials;
  std::reverse(other.begin(), other.end());
  for (CueTrial& trial : other)
    for (auto& difference : trial.difference) difference = 1000 * difference.value_or(0);
  const CueStrategy a = cue_strategy(trials), b = cue_strategy(other);
  CHECK(a.best == b.best);
  for (std::size_t i = 0; i < kCues.size(); ++i) {
    CHECK(a.cues[i].slope == Approx(b.cues[i].slope).epsilon(1e-8));
    CHECK(a.cues[i].log_likelihood == Approx(b.cues[i].log_likelihood).epsilon(1e-10));
    CHECK(1000 * a.cues[i].sd == Approx(b.cues[i].sd).epsilon(1e-10));
  }
}

TEST_CASE("what cannot be fitted says why, and trials without a value are counted", "[cues]") {
  CHECK(cue_strategy({}).status == CueStatus::too_few_trials);
  CHECK(cue_strategy(some_trials(19)).cues[0].status == CueStatus::too_few_trials);
  CHECK(cue_strategy(some_trials(20)).cues[0].status != CueStatus::too_few_trials);

  std::vector<CueTrial> trials = some_trials();
  for (std::size_t i = 0; i < 45; ++i) trials[i].difference[2].reset();
  for (std::size_t i = 0; i < 7; ++i) trials[i].difference[1].reset();
  for (CueTrial& trial : trials) trial.difference[3] = 0.7;
  CueStrategy found = cue_strategy(trials);
  CHECK(found.cues[1].n == 53);
  CHECK(found.cues[1].missing == 7);
  CHECK(found.cues[2].status == CueStatus::too_few_trials);
  CHECK(found.cues[2].missing == 45);
  CHECK(found.cues[3].status == CueStatus::no_variation);
  CHECK(found.cues[3].beside_stiffness.status == CueStatus::no_variation);
  CHECK(found.common_trials == 53);  // work has no fit, and is no reason to leave trials out
  CHECK(std::isnan(found.cues[2].slope));

  // A cue that is stiffness in another unit adds nothing to it.
  for (CueTrial& trial : trials) trial.difference[3] = 0.01 * trial.difference[0].value_or(0) + 3;
  CHECK(cue_strategy(trials).cues[3].beside_stiffness.status == CueStatus::no_variation);

  std::vector<CueTrial> same = some_trials();
  for (CueTrial& trial : same) trial.said_different = false;
  CHECK(cue_strategy(same).cues[0].status == CueStatus::no_information);
  CHECK_FALSE(cue_strategy(same).best.has_value());
}

TEST_CASE("an error-free threshold on a cue is separated and still the best cue", "[cues]") {
  std::vector<CueTrial> trials = some_trials();
  for (CueTrial& trial : trials) trial.said_different = trial.difference[1].value_or(0) > 1.2;
  const CueStrategy found = cue_strategy(trials);
  CHECK(found.cues[1].status == CueStatus::separated);
  CHECK(found.cues[1].slope == kInf);
  CHECK(std::isnan(found.cues[1].intercept));
  CHECK(found.cues[1].log_likelihood == Approx(0).margin(1e-6));
  CHECK(found.best == Cue::peak_force);
  CHECK(found.cues[1].beside_stiffness.status == CueStatus::separated);
  for (CueTrial& trial : trials) trial.said_different = !trial.said_different;
  const CueStrategy reversed = cue_strategy(trials);
  CHECK(reversed.cues[1].slope == -kInf);
  CHECK(reversed.best != Cue::peak_force);  // who calls the smaller difference different does not use it so
}

}  // namespace
}  // namespace jnd
