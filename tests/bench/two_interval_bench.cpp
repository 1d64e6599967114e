// What a fit of two-interval choices costs, beside iteratively reweighted least squares as R's glm() does it, a plain
// loop over vectors in the same run; and what its intervals cost.
//
//   two_interval_bench [--benchmark_filter=...]    `fits_per_second`; in `ratio`, `slower` is IRLS/fit, and
//                                                  `likelihood_lost` what IRLS misses of the maximum
#include <chrono>
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "analysis/choice/two_interval.h"
#include "analysis/numerics/normal.h"

namespace {

using namespace jnd;

const std::vector<ChoiceRow> kRows = {{600, 20, 1, 0},   {700, 20, 2, 0},   {800, 20, 6, 0},
                                      {850, 20, 7, 0},   {900, 20, 11, 0},  {950, 20, 14, 0},
                                      {1000, 20, 15, 0}, {1100, 20, 18, 0}, {1200, 20, 20, 0}};

// 0: probit, no lapse; 1: logit; 2: probit with lapse 0.02; 3: with a free lapse. IRLS has no lapses: 0 and 1 only.
TwoIntervalOptions options_of(std::int64_t index) {
  TwoIntervalOptions options;
  if (index == 1) options.link = ChoiceLink::logit;
  if (index == 2) options.lapse = 0.02;
  if (index == 3) options.lapse.reset();
  return options;
}

double likelihood(ChoiceLink link, double a, double c) {
  double sum = 0;
  for (const ChoiceRow& row : kRows) {
    const double eta = a + c * row.level;
    const double p = link == ChoiceLink::probit ? normal_cdf(eta) : 1 / (1 + std::exp(-eta));
    const double k = static_cast<double>(row.chosen), n = static_cast<double>(row.n);
    if (k > 0) sum += k * std::log(p);
    if (k < n) sum += (n - k) * std::log(1 - p);
  }
  return sum;
}

// McCullagh and Nelder 1989, section 2.5, with the start and the rule to stop of glm(): mu = (k + 0.5)/(n + 1), and a
// deviance that changes by less than 1e-8 of itself.
double irls(ChoiceLink link) {
  const std::size_t rows = kRows.size();
  std::vector<double> eta(rows), mu(rows), weight(rows), working(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    mu[i] = (static_cast<double>(kRows[i].chosen) + 0.5) / (static_cast<double>(kRows[i].n) + 1);
    eta[i] = link == ChoiceLink::probit ? normal_quantile(mu[i]) : std::log(mu[i] / (1 - mu[i]));
  }
  double last = 0, value = 0;
  for (int step = 0; step < 25; ++step) {
    double w = 0, wx = 0, wxx = 0, wz = 0, wxz = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      const double n = static_cast<double>(kRows[i].n), rate = static_cast<double>(kRows[i].chosen) / n;
      const double slope = link == ChoiceLink::probit ? normal_density(eta[i]) : mu[i] * (1 - mu[i]);
      working[i] = eta[i] + (rate - mu[i]) / slope;
      weight[i] = n * slope * slope / (mu[i] * (1 - mu[i]));
      w += weight[i];
      wx += weight[i] * kRows[i].level;
      wxx += weight[i] * kRows[i].level * kRows[i].level;
      wz += weight[i] * working[i];
      wxz += weight[i] * kRows[i].level * working[i];
    }
    const double c = (w * wxz - wx * wz) / (w * wxx - wx * wx), a = (wz - c * wx) / w;
    for (std::size_t i = 0; i < rows; ++i) {
      eta[i] = a + c * kRows[i].level;
      mu[i] = link == ChoiceLink::probit ? normal_cdf(eta[i]) : 1 / (1 + std::exp(-eta[i]));
    }
    value = likelihood(link, a, c);
    if (step > 0 && std::abs(value - last) < 1e-8 * (std::abs(value) + 0.1)) break;
    last = value;
  }
  return value;
}

void fit(benchmark::State& state) {
  const TwoIntervalOptions options = options_of(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(fit_two_interval(kRows, options));
  state.counters["fits_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

// Both in turn, so that a busy machine slows both alike.
void ratio(benchmark::State& state) {
  const TwoIntervalOptions options = options_of(state.range(0));
  using Clock = std::chrono::steady_clock;
  Clock::duration ours{}, theirs{};
  double found = 0;
  for (auto _ : state) {
    const auto start = Clock::now();
    benchmark::DoNotOptimize(fit_two_interval(kRows, options));
    const auto middle = Clock::now();
    benchmark::DoNotOptimize(found = irls(options.link));
    theirs += Clock::now() - middle;
    ours += middle - start;
  }
  state.counters["slower"] = std::chrono::duration<double>(theirs) / std::chrono::duration<double>(ours);
  state.counters["likelihood_lost"] = *fit_two_interval(kRows, options).log_likelihood - found;
}

void intervals(benchmark::State& state) {
  const TwoIntervalOptions options = options_of(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(two_interval_intervals(kRows, options));
}

BENCHMARK(fit)->DenseRange(0, 3)->Unit(benchmark::kMicrosecond);
BENCHMARK(ratio)->DenseRange(0, 1)->Unit(benchmark::kMicrosecond);
BENCHMARK(intervals)->DenseRange(0, 3)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
