// Monte-Carlo of the published study from its counts (162 cells an experiment, least-squares JNDs, group means of three
// conditions), beside a plain loop in the same run that draws every binomial number and asks for every quantile.
//
//   precision_bench [--benchmark_filter=...]     items_per_second is experiments
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "analysis/numerics/normal.h"
#include "analysis/precision/monte_carlo.h"
#include "analysis/precision/precision.h"

namespace {

using namespace jnd;

constexpr int kParticipants = 18, kTrials = 12;
const std::array<double, 3> kJnds = {283.5, 351.0, 208.5};
const std::array<double, 3> kDifferences = {400, 300, 200};

CountsDesign published_design() {
  CountsDesign design;
  design.differences = {kDifferences.begin(), kDifferences.end()};
  design.trials = kTrials;
  return design;
}

void tables(benchmark::State& state) {
  StudyModel model;
  model.design = published_design();
  model.jnds = {kJnds.begin(), kJnds.end()};
  model.participants = kParticipants;
  const StudySimulator simulator(model);
  std::array<MeanJnd, 3> means;
  std::uint64_t experiment = 0;
  double sum = 0;
  for (auto _ : state) {
    simulator.means(1, experiment++, means);
    for (const MeanJnd& mean : means) sum += mean.mean;
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(tables);

double plain_dprime(double difference, double jnd, std::mt19937_64& generator) {
  const int n_same = std::binomial_distribution<int>(kTrials, 0.5)(generator), n_diff = kTrials - n_same;
  if (n_same == 0 || n_diff == 0) return std::nan("");
  const double hit = normal_cdf(difference / jnd / 2);
  const int hits = std::binomial_distribution<int>(n_diff, hit)(generator);
  const int false_alarms = std::binomial_distribution<int>(n_same, 1 - hit)(generator);
  return normal_quantile((hits + 0.5) / (n_diff + 1)) - normal_quantile((false_alarms + 0.5) / (n_same + 1));
}

void plain_loop(benchmark::State& state) {
  std::mt19937_64 generator(1);
  double sum = 0;
  for (auto _ : state) {
    for (const double jnd : kJnds) {
      double mean = 0;
      int n = 0;
      for (int participant = 0; participant < kParticipants; ++participant) {
        double products = 0, squares = 0;
        for (const double difference : kDifferences) {
          const double dprime = plain_dprime(difference, jnd, generator);
          if (std::isnan(dprime)) continue;
          products += difference * dprime;
          squares += difference * difference;
        }
        if (!(products > 1e-9 * squares)) continue;
        mean += squares / products;
        ++n;
      }
      sum += mean / n;
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(plain_loop);

// The planner's whole block for the published design, as `jnd check` computes it.
void precision_of_published_design(benchmark::State& state) {
  PrecisionQuestion question;
  question.design = published_design();
  question.jnds = {kJnds.begin(), kJnds.end()};
  question.contrasts = {{0, 1}, {0, 2}, {1, 2}};
  question.participants = kParticipants;
  question.experiments = static_cast<int>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(precision(question));
}
BENCHMARK(precision_of_published_design)->Arg(2000)->Arg(20000)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
