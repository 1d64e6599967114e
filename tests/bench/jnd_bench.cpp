// What a maximum-likelihood JND with its profile interval costs, beside a plain reference of the same run: Nelder and
// Mead's simplex on the same likelihood written with normal_cdf, and bisection on a profile whose criteria the simplex
// finds.
//
//   jnd_bench [--benchmark_filter=...]     plain/X against jnd/X is the ratio; the counter of plain/X is how far the
//   two
//                                          slopes and bounds lie apart, relative
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "analysis/numerics/normal.h"
#include "analysis/thresholds/jnd.h"

namespace {

using namespace jnd;

using Point = std::vector<double>;
using Function = std::function<double(const Point&)>;

// Nelder and Mead 1965 (Comput J 7:308), with the usual coefficients, until the simplex is flat. Minimises.
Point nelder_mead(const Function& function, const Point& start, const Point& steps) {
  struct Vertex {
    Point at;
    double value;
  };
  std::vector<Vertex> simplex = {{start, function(start)}};
  for (std::size_t i = 0; i < start.size(); ++i) {
    Point at = start;
    at[i] += steps[i];
    simplex.push_back({at, function(at)});
  }
  const std::size_t n = start.size();
  for (int iteration = 0; iteration < 5000; ++iteration) {
    std::sort(simplex.begin(), simplex.end(), [](const Vertex& a, const Vertex& b) { return a.value < b.value; });
    if (simplex.back().value - simplex.front().value < 1e-13 * (1 + std::abs(simplex.front().value))) break;
    Point centre(n, 0.0);
    for (std::size_t v = 0; v < n; ++v)
      for (std::size_t i = 0; i < n; ++i) centre[i] += simplex[v].at[i] / static_cast<double>(n);
    const auto along = [&](double t) {
      Vertex vertex{centre, 0};
      for (std::size_t i = 0; i < n; ++i) vertex.at[i] += t * (simplex.back().at[i] - centre[i]);
      vertex.value = function(vertex.at);
      return vertex;
    };
    const Vertex reflected = along(-1);
    if (reflected.value < simplex.front().value) {
      const Vertex expanded = along(-2);
      simplex.back() = expanded.value < reflected.value ? expanded : reflected;
    } else if (reflected.value < simplex[n - 1].value) {
      simplex.back() = reflected;
    } else {
      const Vertex contracted = along(reflected.value < simplex.back().value ? -0.5 : 0.5);
      if (contracted.value < std::min(reflected.value, simplex.back().value)) {
        simplex.back() = contracted;
        continue;
      }
      for (std::size_t v = 1; v <= n; ++v) {
        for (std::size_t i = 0; i < n; ++i)
          simplex[v].at[i] = simplex[0].at[i] + 0.5 * (simplex[v].at[i] - simplex[0].at[i]);
        simplex[v].value = function(simplex[v].at);
      }
    }
  }
  return simplex.front().at;
}

bool is_differencing(JndMethod method) {
  return method == JndMethod::ml_differencing_common || method == JndMethod::ml_differencing_series;
}

double term(double k, double n, double p) {
  const double safe = std::clamp(p, 1e-300, 1 - 1e-16);
  return k * std::log(safe) + (n - k) * std::log1p(-safe);
}

double minus_log_likelihood(const std::vector<SeriesCounts>& series, JndMethod method, double m, const double* criteria,
                            std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double l = criteria[count == 1 ? 0 : i], root_two = 1.4142135623730951;
    const Counts& counts = series[i].counts;
    const auto different = [&](double d) {
      if (!is_differencing(method)) return normal_cdf(l + d);
      return normal_cdf((d - std::abs(l)) / root_two) + normal_cdf((-d - std::abs(l)) / root_two);
    };
    sum -= term(counts.hits, counts.n_diff, different(m * series[i].difference)) +
           term(counts.false_alarms, counts.n_same, different(0));
  }
  return sum;
}

struct Plain {
  double slope, low, high;
};

Plain plain_fit(const std::vector<SeriesCounts>& series, JndMethod method) {
  const bool common = method == JndMethod::ml_yes_no_common || method == JndMethod::ml_differencing_common;
  const std::size_t criteria = common ? 1 : series.size();
  const double start = is_differencing(method) ? 1.5 : -0.5;
  Point at(criteria + 1, start), steps(criteria + 1, 0.5);
  at[0] = is_differencing(method) ? 0.008 : 0.004;
  steps[0] = 0.002;
  const Function joint = [&](const Point& point) {
    return minus_log_likelihood(series, method, point[0], &point[1], criteria);
  };
  const Point best = nelder_mead(joint, at, steps);
  const double target = joint(best) + 1.9207294103470621;
  const Point best_criteria(best.begin() + 1, best.end());
  const auto excess = [&](double m) {
    const Function inner = [&](const Point& point) {
      return minus_log_likelihood(series, method, m, point.data(), criteria);
    };
    return inner(nelder_mead(inner, best_criteria, Point(criteria, 0.2))) - target;
  };
  const auto bound = [&](double direction) {
    double inside = best[0], outside = best[0] + direction * 0.002;
    while (excess(outside) < 0) outside += direction * 0.002;
    while (std::abs(outside - inside) > 1e-9) {
      const double middle = 0.5 * (inside + outside);
      (excess(middle) < 0 ? inside : outside) = middle;
    }
    return 0.5 * (inside + outside);
  };
  return {best[0], bound(-1), bound(+1)};
}

// A participant of the published design with 36 trials a series, all of whose maxima and bounds are finite.
const std::vector<SeriesCounts> kSeries = {{400, {18, 16, 18, 5}}, {300, {18, 14, 18, 4}}, {200, {18, 10, 18, 6}}};

void ours(benchmark::State& state, JndMethod method) {
  for (auto _ : state) benchmark::DoNotOptimize(estimate_jnd(kSeries, 900, method, Correction::loglinear));
}

void plain(benchmark::State& state, JndMethod method) {
  Plain found{};
  for (auto _ : state) {
    found = plain_fit(kSeries, method);
    benchmark::DoNotOptimize(found);
  }
  const JndEstimate estimate = estimate_jnd(kSeries, 900, method, Correction::loglinear);
  state.counters["relative_difference"] =
      std::max({std::abs(found.slope / estimate.slope - 1), std::abs(found.low / estimate.slope_ci_low - 1),
                std::abs(found.high / estimate.slope_ci_high - 1)});
}

}  // namespace

int main(int argc, char** argv) {
  for (const JndMethod method : {JndMethod::ml_yes_no_common, JndMethod::ml_yes_no_series,
                                 JndMethod::ml_differencing_common, JndMethod::ml_differencing_series}) {
    const std::string name(to_string(method));
    benchmark::RegisterBenchmark(("plain/" + name).c_str(), plain, method)->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark(("jnd/" + name).c_str(), ours, method)->Unit(benchmark::kMicrosecond);
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
