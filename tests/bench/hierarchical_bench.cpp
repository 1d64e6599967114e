// What the hierarchical model of a study of the published size costs: a fit with the test of one JND, one maximum alone,
// one as rough as those of drawn studies, all intervals and pairs, and the test of one JND by drawn studies.
//
//   hierarchical_bench [--benchmark_filter=...]    `baseline` is the likelihood at one place, summed over a fixed grid
//                                                  of persons' deviations: `ratio` tells each in evaluations of it
//   Rscript tests/bench/hierarchical_glmer.R       lme4's glmer on a study of the same size, without tv, which it lacks
#include <chrono>
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "analysis/hierarchical/hierarchical_bootstrap.h"
#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/freed_memory.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/hierarchical/hierarchical_fixtures.h"

namespace {

using namespace jnd;
using namespace jnd::testing;

// ln L with 15 places a direction for u, v and w, as a loop over people and places says it.
double plain_likelihood(const std::vector<HierarchicalCell>& cells) {
  constexpr int kPlaces = 15;
  constexpr double kWidth = 0.8;
  const HierarchicalPlace place = published_truth();
  const auto deviation = [](int i) { return (i - kPlaces / 2) * kWidth; };
  double sum = 0;
  for (int p = 0; p < 18; ++p) {
    double person = 0;
    for (int i = 0; i < kPlaces; ++i)
      for (int j = 0; j < kPlaces; ++j) {
        double product = normal_density(deviation(i)) * normal_density(deviation(j)) * kWidth * kWidth;
        for (int c = 0; c < 3; ++c) {
          double within = 0;
          for (int v = 0; v < kPlaces; ++v) {
            double log_value = log_normal_density(deviation(v));
            const double ln_s =
                             place.mu[static_cast<std::size_t>(c)] + place.tu * deviation(i) + place.tv * deviation(v),
                         k = 0.75 + place.tw * deviation(j);
            for (int level = 0; level < 4; ++level) {
              const HierarchicalCell& cell = cells[static_cast<std::size_t>((p * 3 + c) * 4 + level)];
              const LogRates rates = log_rates(ResponseModel::yes_no, cell.level, ln_s, k, 0);
              log_value += cell.positive * rates.positive + cell.negative * rates.negative;
            }
            within += std::exp(log_value) * kWidth;
          }
          product *= within;
        }
        person += product;
      }
    sum += std::log(person);
  }
  return sum;
}

double baseline_seconds() {
  static const double seconds = [] {
    const std::vector<HierarchicalCell> cells = published_study(18, 0);
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 5; ++i) benchmark::DoNotOptimize(plain_likelihood(cells));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / 5;
  }();
  return seconds;
}

template <typename Work>
void run(benchmark::State& state, Work&& work) {
  const double baseline = baseline_seconds();
  std::uint64_t number = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (auto _ : state) work(published_study(18, number++ % 50));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  state.counters["ratio"] = seconds / static_cast<double>(state.iterations()) / baseline;
}

void fit(benchmark::State& state) {
  run(state, [](const std::vector<HierarchicalCell>& cells) {
    benchmark::DoNotOptimize(HierarchicalAnalysis(cells, {}).fit().p);
  });
}
BENCHMARK(fit)->Unit(benchmark::kMillisecond);

void one_maximum(benchmark::State& state) {
  run(state, [](const std::vector<HierarchicalCell>& cells) {
    HierarchicalLikelihood likelihood(cells, ResponseModel::yes_no, {});
    benchmark::DoNotOptimize(maximise(likelihood, HierarchicalForm::separate(3), published_truth()).log_likelihood);
  });
}
BENCHMARK(one_maximum)->Unit(benchmark::kMillisecond);

void fit_of_a_drawn_study(benchmark::State& state) {
  run(state, [](const std::vector<HierarchicalCell>& cells) {
    const HierarchicalPlace truth = published_truth();
    HierarchicalAnalysis analysis(cells, {}, SearchEffort::drawn, &truth);
    benchmark::DoNotOptimize(analysis.equal_lr());
  });
}
BENCHMARK(fit_of_a_drawn_study)->Unit(benchmark::kMillisecond);

void intervals_and_pairs(benchmark::State& state) {
  run(state, [](const std::vector<HierarchicalCell>& cells) {
    HierarchicalAnalysis analysis(cells, {});
    analysis.add_intervals();
    benchmark::DoNotOptimize(analysis.differences().size());
  });
}
BENCHMARK(intervals_and_pairs)->Unit(benchmark::kMillisecond);

// 1000 drawn studies on two threads.
void test_by_drawn_studies(benchmark::State& state) {
  run(state, [](const std::vector<HierarchicalCell>& cells) {
    const HierarchicalFit fit = HierarchicalAnalysis(cells, {}).fit();
    benchmark::DoNotOptimize(equality_bootstrap(cells, {}, fit, 1000, 1, 2).p);
  });
}
BENCHMARK(test_by_drawn_studies)->Unit(benchmark::kSecond)->Iterations(2);

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();  // as jnd does
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
