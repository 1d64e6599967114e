#include "analysis/numerics/studentised_range.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <tuple>
#include <vector>

#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

constexpr int kLargestGroups = 1000;

// No long double, so that every machine gets the same bits; errors are thrown, as by default.
using NoPromotion = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

bool valid(int groups, double df) noexcept {
  return groups >= 2 && groups <= kLargestGroups && df >= 1;
}

// ln(1 + r^2), also where r^2 would overflow.
double log_one_plus_square(double r) noexcept {
  return r > 1e4 ? 2 * std::log(std::hypot(1.0, r)) : std::log1p(r * r);
}

// (6/pi) Int_0^{pi/6} (1 + q^2 / (2 df cos^2 x))^(-df/2) dx
double upper_of_three(double q, double df) {
  const bool normal = std::isinf(df);
  const double r = normal ? 0 : q / std::sqrt(2 * df);
  const auto integrand = [&](double x) {
    const double cosine = std::cos(x);
    if (normal) return std::exp(-q * q / (4 * cosine * cosine));
    return std::exp(-0.5 * df * log_one_plus_square(r / cosine));
  };
  // Near 0 a Gaussian of precision kappa: beyond 9.5 of its standard deviations there is nothing left to add.
  const double kappa = normal ? q * q / 2 : df * (r < 1 ? r * r / (1 + r * r) : 1 / (1 + 1 / r / r));
  const double sixth = boost::math::constants::pi<double>() / 6;
  const double end = std::min(sixth, 9.5 / std::sqrt(kappa));
  return boost::math::quadrature::gauss<double, 30>::integrate(integrand, 0.0, end) / sixth;
}

// P(W > w) of the range W of `groups` standard normal values:
//   groups Int phi(z) [a^(groups-1) - (a - b)^(groups-1)] dz, a = P(Z > z), b = P(Z > z + w),
// with z the smallest. The bracket is written as a product, so that nothing cancels.
class RangeTail {
 public:
  RangeTail(int groups, double step) : step_(step), power_(groups - 1) {
    const int nodes = static_cast<int>((kLast - kFirst) / step);
    for (int i = 0; i < nodes; ++i) {
      const double z = kFirst + step * i, above = normal_cdf(-z);
      above_.push_back(above);
      weight_.push_back(step * groups * normal_density(z) * std::pow(above, power_));
    }
  }
  double operator()(double w) const {
    if (w <= 0) return 1;
    // From -w/2, where the smallest and the largest are both as near as they can be, outwards until nothing is added.
    const int centre = static_cast<int>(std::max(0.0, (-0.5 * w - kFirst) / step_));
    const int nodes = static_cast<int>(weight_.size());
    double sum = 0;
    for (const int direction : {1, -1}) {
      for (int i = direction > 0 ? centre : centre - 1; i >= 0 && i < nodes; i += direction) {
        const auto node = static_cast<std::size_t>(i);
        const double ratio = normal_cdf(-(kFirst + step_ * i + w)) / above_[node];
        const double next = -weight_[node] * std::expm1(power_ * std::log1p(-std::min(ratio, 1.0)));
        sum += next;
        if (next <= 1e-17 * sum) break;
      }
    }
    return std::min(1.0, sum);
  }

 private:
  static constexpr double kFirst = -37, kLast = 9.7;  // where phi leaves the range of double, and where nothing is left
  double step_, power_;
  std::vector<double> above_, weight_;
};

// Steps of the two trapezoidal sums. More groups bend the integrands more. Halving the steps changes p by less than
// 1e-13 (up to 100 groups) and 1e-12 (more) over q = 0.3..60, df = 1..inf.
struct Steps {
  double z, u, u_spread;  // u_spread: in units of the standard deviation of ln s
};
constexpr Steps steps_for(int groups) noexcept {
  if (groups <= 10) return {0.25, 0.1, 0.5};
  if (groups <= 100) return {0.125, 0.08, 0.35};
  return {0.125, 0.04, 0.25};
}

// P(W > w) at w = exp(i step), i = ..., -1, 0, 1, ...: each value is computed when it is first asked for, and kept.
// Any thread may ask: who comes second computes the same value.
class RangeGrid {
 public:
  RangeGrid(const RangeTail& tail, double step)
      : tail_(tail),
        step_(step),
        first_(static_cast<std::int64_t>(std::ceil(kFirst / step))),
        values_(static_cast<std::size_t>((kLast - kFirst) / step) + 1) {}
  double step() const noexcept { return step_; }
  double at(std::int64_t node) {
    const std::int64_t place = node - first_;
    if (place < 0) return 1;
    if (place >= static_cast<std::int64_t>(values_.size())) return tail_(w(node));
    std::atomic<double>& kept = values_[static_cast<std::size_t>(place)];
    double value = kept.load(std::memory_order_relaxed);
    if (value == kUnknown) {
      value = tail_(w(node));
      kept.store(value, std::memory_order_relaxed);
    }
    return value;
  }

 private:
  // ln w: before the first, P(W > w) is not to be told from 1; past the last nothing is left.
  static constexpr double kFirst = -14, kLast = 4.5, kUnknown = 0;
  double w(std::int64_t node) const noexcept { return std::exp(step_ * static_cast<double>(node)); }

  const RangeTail& tail_;
  double step_;
  std::int64_t first_;
  std::vector<std::atomic<double>> values_;
};

// What all q and df of one number of groups share. The sum over ln s converges wherever its nodes lie: those of every q
// and df can lie on one of a few grids.
class RangeTable {
 public:
  explicit RangeTable(int groups) : steps_(steps_for(groups)), tail_(groups, steps_.z) {}

  double operator()(double w) const { return tail_(w); }

  // The step in ln s that df asks for.
  double step(double df) const noexcept { return std::min(steps_.u, steps_.u_spread / std::sqrt(2 * df)); }
  // A grid at least as fine; none for many thousands of degrees of freedom, whose narrow sums differences of logarithms
  // would spoil.
  RangeGrid* grid(double step) {
    std::size_t level = 0;
    while (level < kKept && step_of(level) > step) ++level;
    if (level == kKept) return nullptr;
    std::call_once(made_[level], [&] { grids_[level] = std::make_unique<RangeGrid>(tail_, step_of(level)); });
    return grids_[level].get();
  }

 private:
  static constexpr std::size_t kKept = 16;
  double step_of(std::size_t level) const noexcept { return steps_.u * std::pow(2, -0.5 * static_cast<double>(level)); }

  Steps steps_;
  RangeTail tail_;
  std::array<std::once_flag, kKept> made_;
  std::array<std::unique_ptr<RangeGrid>, kKept> grids_;
};

// One table for each number of groups, made when it is first asked for.
RangeTable& range_table(int groups) {
  static std::array<std::once_flag, kLargestGroups + 1> made;
  static std::array<std::unique_ptr<RangeTable>, kLargestGroups + 1> tables;
  const auto place = static_cast<std::size_t>(groups);
  std::call_once(made[place], [&] { tables[place] = std::make_unique<RangeTable>(groups); });
  return *tables[place];
}

// term(0) + term(1) + term(-1) + ..., to either side until nothing is added.
template <typename Term>
double outward_sum(Term term) {
  double sum = term(0);
  for (const std::int64_t direction : {-1, 1}) {
    for (std::int64_t i = 1; i < 100'000; ++i) {
      const double next = term(direction * i);
      sum += next;
      if (next <= 1e-17 * sum) break;
    }
  }
  return sum;
}

// Int P(W > q s) f(s) ds over the distribution of s = sqrt(chi2_df / df), in u = ln s:
//   f(u) = 2 (df/2)^(df/2) / Gamma(df/2) exp(df (u - e^(2u)/2)).
double upper_of_many(RangeTable& table, double q, double df) {
  // Beyond this the spread of s is below the rounding of q.
  if (df > 1e15) return table(q);
  const double half = df / 2;
  const double factor = 2 * half * boost::math::gamma_p_derivative(half, half, NoPromotion());
  const auto density = [&](double u) {
    // (e^(2u) - 1)/2 - u without cancellation near 0, where it matters for many degrees of freedom.
    const double drop = std::abs(u) < 0.01
                            ? u * u * (1 + u * (2.0 / 3 + u * (1.0 / 3 + u * (2.0 / 15 + u * (2.0 / 45)))))
                            : 0.5 * std::expm1(2 * u) - u;
    return std::exp(-df * drop);
  };
  // The peak of exp(df (u - e^(2u)/2) - q^2 e^(2u)/4), and the curvature 2 df of its logarithm there.
  const double peak = -0.5 * log_one_plus_square(q / std::sqrt(2 * df)), step = table.step(df);
  double sum = 0;
  if (RangeGrid* grid = table.grid(step); grid != nullptr) {
    const double log_q = std::log(q);
    const std::int64_t centre = std::llround((peak + log_q) / grid->step());
    sum = grid->step() * outward_sum([&](std::int64_t i) {
            const double weight = density(grid->step() * static_cast<double>(centre + i) - log_q);
            return weight > 0 ? weight * grid->at(centre + i) : 0.0;
          });
  } else {
    sum = step * outward_sum([&](std::int64_t i) {
            const double u = peak + step * static_cast<double>(i), weight = density(u);
            return weight > 0 ? weight * table(q * std::exp(u)) : 0.0;
          });
  }
  return std::min(1.0, factor * sum);
}

// q > 0; groups and df valid.
double upper(double q, int groups, double df) {
  if (std::isinf(q)) return 0;
  if (groups == 2) return student_t_two_sided(q * boost::math::constants::half_root_two<double>(), df);
  if (groups == 3) return std::min(1.0, upper_of_three(q, df));
  RangeTable& table = range_table(groups);
  return std::isinf(df) ? table(q) : upper_of_many(table, q, df);
}

// q of P(|q1 - q2| studentised > q) = p: the range of two.
double quantile_of_two(double p, double df) noexcept {
  return boost::math::constants::root_two<double>() * student_t_quantile_two_sided(p, df);
}

}  // namespace

double studentised_range_upper(double q, int groups, double df) {
  if (std::isnan(q) || !valid(groups, df)) return kNaN;
  return q > 0 ? upper(q, groups, df) : 1;
}

double studentised_range_quantile_upper(double p_upper, int groups, double df) {
  if (!(p_upper >= 0 && p_upper <= 1) || !valid(groups, df)) return kNaN;
  if (p_upper == 1) return 0;
  if (p_upper == 0) return kInf;
  if (groups == 2) return quantile_of_two(p_upper, df);

  // The range exceeds that of any two of its values, and Bonferroni's bound over all pairs exceeds its tail.
  const double pairs = 0.5 * groups * (groups - 1);
  double low = std::log(quantile_of_two(p_upper, df)), high = std::log(quantile_of_two(p_upper / pairs, df));
  // Logarithms straighten the curve in the tail; near 1 they would flatten it.
  const bool tail = p_upper < 0.5;
  const double target = tail ? std::log(p_upper) : p_upper;
  const auto excess = [&](double log_q) {
    const double p = upper(std::exp(log_q), groups, df);
    return (tail ? std::log(p) : p) - target;
  };
  const double at_low = excess(low), at_high = excess(high);
  if (!(at_low > 0)) return std::exp(low);
  if (!(at_high < 0)) return std::exp(high);
  std::uintmax_t steps = 100;
  const auto enough = [](double a, double b) { return std::abs(b - a) < 1e-14 * std::max(1.0, std::abs(a)); };
  std::tie(low, high) = boost::math::tools::toms748_solve(excess, low, high, at_low, at_high, enough, steps);
  return std::exp(0.5 * (low + high));
}

double studentised_range_quantile(double p, int groups, double df) {
  return studentised_range_quantile_upper(1 - p, groups, df);
}

}  // namespace jnd
