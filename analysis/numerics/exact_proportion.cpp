#include "analysis/numerics/exact_proportion.h"

#include <algorithm>

#include <boost/math/special_functions/beta.hpp>

#include "analysis/numerics/special_values.h"

namespace jnd {

ExactProportion exact_proportion(int k, int n, double confidence) {
  ExactProportion result{.k = k, .n = n, .share = 0, .ci_low = 0, .ci_high = 1};
  result.share = n > 0 ? static_cast<double>(k) / n : kNaN;
  const double tail = (1 - confidence) / 2;
  if (k > 0) result.ci_low = boost::math::ibeta_inv(k, n - k + 1.0, tail);
  if (k < n) result.ci_high = boost::math::ibetac_inv(k + 1.0, n - k, tail);
  return result;
}

namespace {

// Probabilities relative to that of the outcome `at`, by the ratios of neighbours: ratio_up(k) = P(k+1)/P(k). Outcomes
// run from least to most. Far from the centre they fall faster and faster, so that the walk may end when they no longer
// matter.
template <typename Ratio>
double no_likelier(int at, int least, int most, const Ratio& ratio_up) {
  constexpr double kNegligible = 1e-20;
  // What is likelier by less than this is a tie that rounding has split (R uses the same).
  constexpr double kTie = 1 + 1e-7;
  double total = 1, counted = 1;
  const auto add = [&](double relative) {
    total += relative;
    if (relative <= kTie) counted += relative;
    return relative > kNegligible;
  };
  double relative = 1;
  for (int k = at; k < most; ++k)
    if (!add(relative *= ratio_up(k))) break;
  relative = 1;
  for (int k = at; k > least; --k)
    if (!add(relative /= ratio_up(k - 1))) break;
  return std::min(1.0, counted / total);
}

}  // namespace

double fisher_exact_p(int k1, int n1, int k2, int n2) {
  const int said = k1 + k2;
  return no_likelier(k1, std::max(0, said - n2), std::min(said, n1), [=](int k) {
    return (static_cast<double>(n1 - k) / (k + 1)) * (static_cast<double>(said - k) / (n2 - said + k + 1));
  });
}

double binomial_exact_p(int k, int n, double p) {
  const double odds = p / (1 - p);
  return no_likelier(k, 0, n, [=](int i) { return static_cast<double>(n - i) / (i + 1) * odds; });
}

}  // namespace jnd
