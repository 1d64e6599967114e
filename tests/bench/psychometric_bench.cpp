// What a fit of a psychometric function costs, beside Nelder and Mead's simplex on the same likelihood in the same run,
// and what its intervals cost.
//
//   psychometric_bench [--benchmark_filter=...]    simplex/N over fit/N is the ratio; `slower` counts it, and
//                                                  `likelihood_lost` what the simplex misses of the maximum
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric_interval.h"

namespace {

using namespace jnd;

const std::vector<PsychometricLevel> kComparison = {{600, 20, 1},   {700, 20, 2},   {800, 20, 6},
                                                    {850, 20, 7},   {900, 20, 11},  {950, 20, 14},
                                                    {1000, 20, 15}, {1100, 20, 18}, {1200, 20, 20}};
const std::vector<PsychometricLevel> kForcedChoice = {{15, 50, 27},  {30, 32, 15},  {60, 64, 40},  {90, 40, 28},
                                                      {120, 64, 52}, {180, 24, 21}, {260, 50, 47}, {400, 50, 47}};

// 0..3: the functions with guess and lapse 0; 4..7: with guess 0.5 and a free lapse; 8..11: with both rates free.
struct Task {
  const std::vector<PsychometricLevel>& levels;
  PsychometricModel model;
};
Task task(std::int64_t index) {
  PsychometricModel model;
  model.function = static_cast<PsychometricFunction>(index % 4);
  if (index < 4) return {kComparison, model};
  model.lapse.reset();
  if (index < 8)
    model.guess = 0.5;
  else
    model.guess.reset();
  return {kForcedChoice, model};
}

// The plain way: the likelihood of (location, log of the second parameter, lapse, guess), minus infinity out of bounds.
double likelihood(const Task& task, const std::array<double, 4>& at) {
  const double lapse = task.model.lapse.value_or(at[2]), guess = task.model.guess.value_or(at[3]);
  if (lapse < 0 || lapse > kLargestLapse || guess < 0 || guess > kLargestGuess) return -kInf;
  if (task.model.function == PsychometricFunction::weibull && at[0] <= 0) return -kInf;
  double sum = 0;
  for (const PsychometricLevel& level : task.levels) {
    const double p =
        guess + (1 - guess - lapse) * psychometric_cdf(task.model.function, at[0], std::exp(at[1]), level.x);
    if (level.k > 0) sum += level.k * std::log(p);
    if (level.k < level.n) sum += (level.n - level.k) * std::log(1 - p);
  }
  return std::isnan(sum) ? -kInf : sum;
}

// Nelder and Mead 1965 with their coefficients, until the simplex spans 1e-10 of log-likelihood.
double simplex(const Task& task) {
  using Place = std::array<double, 4>;
  struct Corner {
    Place at;
    double value;
  };
  const double range = task.levels.back().x - task.levels.front().x, middle = task.levels.front().x + range / 2;
  double steep = 4 / range;
  if (task.model.function == PsychometricFunction::gaussian) steep = range / 4;
  if (task.model.function == PsychometricFunction::weibull) steep = 3;
  std::vector<Corner> corners = {{{middle, std::log(steep), 0.03, 0.3}, 0}};
  std::vector<std::size_t> free = {0, 1};
  if (!task.model.lapse) free.push_back(2);
  if (!task.model.guess) free.push_back(3);
  const Place step = {range / 8, 0.5, 0.02, 0.05};
  for (const std::size_t i : free) {
    corners.push_back(corners.front());
    corners.back().at[i] += step[i];
  }
  for (Corner& corner : corners) corner.value = likelihood(task, corner.at);
  const auto along = [&](const Place& centre, const Place& worst, double factor) {
    Corner corner{centre, 0};
    for (std::size_t i = 0; i < 4; ++i) corner.at[i] += factor * (centre[i] - worst[i]);
    corner.value = likelihood(task, corner.at);
    return corner;
  };
  for (int round = 0; round < 2000; ++round) {
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.value > b.value; });
    Corner& worst = corners.back();
    if (corners.front().value - worst.value < 1e-10) break;
    Place centre{};
    for (std::size_t c = 0; c + 1 < corners.size(); ++c)
      for (std::size_t i = 0; i < 4; ++i) centre[i] += corners[c].at[i] / static_cast<double>(corners.size() - 1);
    const Corner reflected = along(centre, worst.at, 1);
    if (reflected.value > corners.front().value) {
      const Corner expanded = along(centre, worst.at, 2);
      worst = expanded.value > reflected.value ? expanded : reflected;
    } else if (reflected.value > corners[corners.size() - 2].value) {
      worst = reflected;
    } else {
      const Corner contracted = along(centre, worst.at, reflected.value > worst.value ? 0.5 : -0.5);
      if (contracted.value > std::max(worst.value, reflected.value)) {
        worst = contracted;
      } else {
        for (std::size_t c = 1; c < corners.size(); ++c) {
          for (std::size_t i = 0; i < 4; ++i)
            corners[c].at[i] = corners.front().at[i] + 0.5 * (corners[c].at[i] - corners.front().at[i]);
          corners[c].value = likelihood(task, corners[c].at);
        }
      }
    }
  }
  return corners.front().value;
}

void fit(benchmark::State& state) {
  const Task one = task(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(fit_psychometric(one.levels, one.model));
}

void simplex(benchmark::State& state) {
  const Task one = task(state.range(0));
  double found = 0;
  for (auto _ : state) benchmark::DoNotOptimize(found = simplex(one));
  state.counters["likelihood_lost"] = fit_psychometric(one.levels, one.model).log_likelihood - found;
}

// Both in turn, so that a busy machine slows both alike.
void ratio(benchmark::State& state) {
  const Task one = task(state.range(0));
  using Clock = std::chrono::steady_clock;
  Clock::duration ours{}, theirs{};
  for (auto _ : state) {
    const auto start = Clock::now();
    benchmark::DoNotOptimize(fit_psychometric(one.levels, one.model));
    const auto middle = Clock::now();
    benchmark::DoNotOptimize(simplex(one));
    theirs += Clock::now() - middle;
    ours += middle - start;
  }
  state.counters["slower"] = std::chrono::duration<double>(theirs) / std::chrono::duration<double>(ours);
}

void profile(benchmark::State& state) {
  const Task one = task(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(psychometric_profile(one.levels, one.model));
}

void bootstrap_1000(benchmark::State& state) {
  const Task one = task(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(psychometric_bootstrap(one.levels, one.model, 1000, 1));
}

BENCHMARK(fit)->DenseRange(0, 11)->Unit(benchmark::kMicrosecond);
BENCHMARK(simplex)->DenseRange(0, 11)->Unit(benchmark::kMicrosecond);
BENCHMARK(ratio)->DenseRange(0, 11)->Unit(benchmark::kMicrosecond);
BENCHMARK(profile)->Arg(0)->Arg(2)->Arg(6)->Unit(benchmark::kMillisecond);
BENCHMARK(bootstrap_1000)->Arg(0)->Arg(6)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
