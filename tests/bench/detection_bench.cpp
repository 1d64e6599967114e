// What a fit of d' costs, beside a plain version of the same with Boost's general solvers in the same run: the hit rate
// inverted by TOMS 748; profiles maximised by Brent's minimiser inside a bisection of the bound.
//
//   detection_bench [--benchmark_filter=...]    items_per_second of X/ours over X/plain is the ratio
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/roots.hpp>

#include "analysis/detection/differencing.h"
#include "analysis/detection/differencing_model.h"
#include "analysis/detection/dprime_intervals.h"
#include "analysis/detection/independent_observation.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/profile_interval.h"

namespace {

using namespace jnd;

// Every table of 18 + 18 trials with both rates inside 0..1 and H > F: 136 of them.
const std::vector<Counts>& tables() {
  static const std::vector<Counts> all = [] {
    std::vector<Counts> some;
    for (int hits = 1; hits < 18; ++hits)
      for (int alarms = 1; alarms < hits; ++alarms) some.push_back({18, hits, 18, alarms});
    return some;
  }();
  return all;
}

double bisect(auto&& function, double low, double high) {
  std::uintmax_t iterations = 200;
  const auto [left, right] =
      boost::math::tools::toms748_solve(function, low, high, boost::math::tools::eps_tolerance<double>(45), iterations);
  return 0.5 * (left + right);
}

double plain_differencing(const Counts& counts, double& tau) {
  const double hit = static_cast<double>(counts.hits) / counts.n_diff;
  const double alarm = static_cast<double>(counts.false_alarms) / counts.n_same;
  tau = -std::sqrt(2.0) * normal_quantile(0.5 * alarm);
  return bisect([&](double dprime) { return differencing_hit_rate(dprime, tau) - hit; }, 0, 20);
}

// The largest log-likelihood over the second parameter, by Brent's method.
double largest(auto&& log_likelihood, double low, double high) {
  std::uintmax_t iterations = 200;
  return -boost::math::tools::brent_find_minima([&](double x) { return -log_likelihood(x); }, low, high, 40, iterations)
              .second;
}

double yes_no_log_likelihood(const Counts& counts, double dprime, double l) {
  return counts.hits * std::log(normal_cdf(l + dprime)) +
         (counts.n_diff - counts.hits) * std::log(normal_cdf(-l - dprime)) +
         counts.false_alarms * std::log(normal_cdf(l)) +
         (counts.n_same - counts.false_alarms) * std::log(normal_cdf(-l));
}

void each(benchmark::State& state, auto&& work) {
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(work(tables()[i]));
    if (++i == tables().size()) i = 0;
  }
  state.SetItemsProcessed(state.iterations());
}

void fit_ours(benchmark::State& state) {
  each(state, [](const Counts& counts) { return differencing_fit(counts); });
}
void fit_plain(benchmark::State& state) {
  each(state, [](const Counts& counts) {
    double tau = 0;
    return plain_differencing(counts, tau);
  });
}

void yes_no_ours(benchmark::State& state) {
  each(state, [](const Counts& counts) { return yes_no_profile(counts); });
}
double plain_yes_no_bound(const Counts& counts, double inside, double outside) {
  const double best = largest([&](double l) { return yes_no_log_likelihood(counts, inside, l); }, -6, 6);
  return bisect(
      [&](double dprime) {
        return best - kProfileDrop - largest([&](double l) { return yes_no_log_likelihood(counts, dprime, l); }, -6, 6);
      },
      inside, outside);
}
double ends_together(double low, double high) {
  return low + high;
}
double plain_yes_no(const Counts& counts) {
  const double dprime = yes_no(counts, Correction::none).dprime;
  const auto mirrored = Counts{counts.n_same, counts.false_alarms, counts.n_diff, counts.hits};
  return ends_together(plain_yes_no_bound(counts, dprime, dprime + 5),
                       -plain_yes_no_bound(mirrored, -dprime, 5 - dprime));
}
void yes_no_plain(benchmark::State& state) {
  each(state, plain_yes_no);
}

void differencing_ours(benchmark::State& state) {
  each(state, [](const Counts& counts) { return differencing(counts); });
}
double plain_differencing_profile(const Counts& counts) {
  double tau = 0;
  const double dprime = plain_differencing(counts, tau);
  const double best = differencing_log_likelihood(counts, dprime, tau);
  const auto excess = [&](double at) {
    return best - kProfileDrop -
           largest([&](double t) { return differencing_log_likelihood(counts, at, t); }, 1e-4, 12);
  };
  const double low = excess(0) > 0 ? bisect(excess, 0, dprime) : 0;
  return ends_together(low, bisect(excess, dprime, dprime + 10));
}
void differencing_plain(benchmark::State& state) {
  each(state, plain_differencing_profile);
}

// The two versions bound the same: the largest difference of the sum of both ends.
void agreement(benchmark::State& state) {
  double yes_no_difference = 0, differencing_difference = 0;
  for (auto _ : state)
    for (const Counts& counts : tables()) {
      const DprimeProfile profile = yes_no_profile(counts);
      const Differencing fit = differencing(counts);
      yes_no_difference =
          std::fmax(yes_no_difference, std::abs(profile.ci_low + profile.ci_high - plain_yes_no(counts)));
      differencing_difference =
          std::fmax(differencing_difference, std::abs(fit.ci_low + fit.ci_high - plain_differencing_profile(counts)));
    }
  state.counters["yes_no"] = yes_no_difference;
  state.counters["differencing"] = differencing_difference;
}

void exact_observer(benchmark::State& state) {
  each(state, [](const Counts& counts) { return independent_observation(counts, Correction::loglinear); });
}
void bootstrap(benchmark::State& state) {
  each(state, [](const Counts& counts) { return dprime_bootstrap(counts); });
}

}  // namespace

BENCHMARK(fit_ours)->Name("differencing_fit/ours");
BENCHMARK(fit_plain)->Name("differencing_fit/plain");
BENCHMARK(yes_no_ours)->Name("yes_no_profile/ours");
BENCHMARK(yes_no_plain)->Name("yes_no_profile/plain");
BENCHMARK(differencing_ours)->Name("differencing_profile/ours");
BENCHMARK(differencing_plain)->Name("differencing_profile/plain");
BENCHMARK(agreement)->Name("profiles/agreement")->Iterations(1);
BENCHMARK(exact_observer)->Name("independent_observation");
BENCHMARK(bootstrap)->Name("dprime_bootstrap");

BENCHMARK_MAIN();
