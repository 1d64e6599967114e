// What a full comparison of 18 participants under three to six conditions costs, beside the studentised range alone as
// a textbook writes it: the double integral by nested adaptive Gauss-Kronrod quadrature, twice for each pair.
//
//   compare_bench      comparisons a second (aim: at least 10,000 of each), their ratio to the textbook's, and how far
//                      the two p values are apart; then the time of one comparison of 20, 100 and 300 conditions
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <vector>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <fmt/format.h>

#include "analysis/group/compare.h"
#include "analysis/numerics/normal.h"

namespace {

using namespace jnd;
using Quadrature = boost::math::quadrature::gauss_kronrod<double, 31>;

// 1 - Int f(s) k Int phi(z) (Phi(z + q s) - Phi(z))^(k-1) dz ds, straight from the definition.
double textbook_upper(double q, int k, double df) {
  const double half = df / 2;
  const double log_factor = half * std::log(half) - std::lgamma(half) + std::log(2.0);
  const auto inner = [&](double w) {
    const auto integrand = [&](double z) {
      return k * normal_density(z) * std::pow(normal_cdf(z + w) - normal_cdf(z), k - 1);
    };
    return Quadrature::integrate(integrand, -9.0, 9.0, 8, 1e-9);
  };
  const auto outer = [&](double s) {
    return s > 0 ? std::exp(log_factor + (df - 1) * std::log(s) - half * s * s) * inner(q * s) : 0.0;
  };
  return 1 - Quadrature::integrate(outer, 0.0, 1 + 9 / std::sqrt(half), 8, 1e-9);
}

// Noise around the condition means, other every time: Weyl sequences through the normal quantile.
WithinTable table_of(std::size_t n, std::size_t k, int index) {
  const double means[] = {283.5, 351, 208.5, 300, 260, 320};
  WithinTable table{n, k, {}};
  for (std::size_t i = 0; i < n * k; ++i) {
    const double turn = 0.6180339887498949 * static_cast<double>(i + 1) + 0.7548776662466927 * (index + 1);
    table.values.push_back(means[i % k % std::size(means)] +
                           45 * normal_quantile(0.001 + 0.998 * (turn - std::floor(turn))));
  }
  return table;
}

template <typename Work>
double seconds_of(Work work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

// The median rate of comparisons, of the same p values by the textbook, and the largest difference of a p.
double bench(std::size_t k, int per_round, int rounds) {
  std::vector<WithinTable> tables;
  for (int i = 0; i < per_round; ++i) tables.push_back(table_of(18, k, i));
  std::vector<double> ours, theirs;
  std::vector<Comparison> found(tables.size());
  double apart = 0;
  for (int round = 0; round < rounds; ++round) {
    ours.push_back(static_cast<double>(tables.size()) / seconds_of([&] {
                     for (std::size_t i = 0; i < tables.size(); ++i) found[i] = compare(tables[i]);
                   }));
    const Comparison& one = found[static_cast<std::size_t>(round) % found.size()];
    theirs.push_back(1 / seconds_of([&] {
                       for (const PairComparison& pair : one.pairs) {
                         const int groups = static_cast<int>(k);
                         const double gh = textbook_upper(pair.games_howell.q, groups, pair.games_howell.df);
                         const double tukey = textbook_upper(pair.tukey.q, groups, one.anova.effect.df2);
                         apart = std::max({apart, std::abs(gh - pair.games_howell.p), std::abs(tukey - pair.tukey.p)});
                       }
                     }));
  }
  fmt::print("18 x {}: full comparison      {:10.0f} a second\n", k, median(ours));
  fmt::print("        textbook range alone {:10.1f} a second    ratio {:.0f}\n", median(theirs),
             median(ours) / median(theirs));
  fmt::print("        largest difference of a p {:.1e}\n", apart);
  return apart;
}

}  // namespace

int main() {
  double apart = 0;
  for (const std::size_t k : {3U, 4U, 5U, 6U}) apart = std::max(apart, bench(k, 400, 7));
  for (const std::size_t k : {20U, 100U, 300U}) {
    const WithinTable table = table_of(18, k, 1);
    fmt::print("18 x {}: {:.3f} s, {} pairs\n", k, seconds_of([&] { (void)compare(table); }), k * (k - 1) / 2);
  }
  return apart < 1e-8 ? 0 : 1;
}
