#include "analysis/group/shapiro_wilk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <boost/math/constants/constants.hpp>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

// c[0] + c[1] x + c[2] x^2 + ...
template <std::size_t N>
double polynomial(const std::array<double, N>& c, double x) noexcept {
  double sum = 0;
  for (std::size_t i = N; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// Royston's polynomials, with his names.
constexpr std::array<double, 6> kC1 = {0, 0.221157, -0.147981, -2.07119, 4.434685, -2.706056};
constexpr std::array<double, 6> kC2 = {0, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633};
constexpr std::array<double, 4> kC3 = {0.544, -0.39978, 0.025054, -6.714e-4};
constexpr std::array<double, 4> kC4 = {1.3822, -0.77857, 0.062767, -0.0020322};
constexpr std::array<double, 4> kC5 = {-1.5861, -0.31082, -0.083751, 0.0038915};
constexpr std::array<double, 3> kC6 = {-0.4803, -0.082676, 0.0030302};
constexpr std::array<double, 2> kG = {-2.273, 0.459};

// The coefficients of the n/2 largest order statistics, the largest first; the others are their mirror image.
std::vector<double> coefficients(std::size_t n) {
  std::vector<double> a(n / 2);
  if (n == 3) {
    a[0] = boost::math::constants::half_root_two<double>();
    return a;
  }
  const auto size = static_cast<double>(n);
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = -normal_quantile((static_cast<double>(i + 1) - 0.375) / (size + 0.25));
    squares += 2 * a[i] * a[i];
  }
  const double root = std::sqrt(squares), x = 1 / std::sqrt(size);
  const double a1 = polynomial(kC1, x) + a[0] / root;
  std::size_t scaled_from = 1;
  double factor = 0;
  if (n > 5) {
    const double a2 = polynomial(kC2, x) + a[1] / root;
    factor = std::sqrt((squares - 2 * a[0] * a[0] - 2 * a[1] * a[1]) / (1 - 2 * a1 * a1 - 2 * a2 * a2));
    a[1] = a2;
    scaled_from = 2;
  } else {
    factor = std::sqrt((squares - 2 * a[0] * a[0]) / (1 - 2 * a1 * a1));
  }
  a[0] = a1;
  for (std::size_t i = scaled_from; i < a.size(); ++i) a[i] /= factor;
  return a;
}

// 6/pi (asin sqrt(W) - pi/3), rearranged: the difference of the two angles is one asin of the smaller gap.
double p_of_three(double gap1, double gap2) noexcept {
  const double sine = 0.5 * boost::math::constants::root_three<double>() * std::min(gap1, gap2) /
                      std::sqrt(gap1 * gap1 + gap1 * gap2 + gap2 * gap2);
  return std::min(1.0, 6 * boost::math::constants::one_div_pi<double>() * std::asin(std::min(sine, 0.5)));
}

// one_minus_w in 0..1.
double p_of(double one_minus_w, std::size_t n) noexcept {
  const auto size = static_cast<double>(n);
  const double log_n = std::log(size);
  double y = std::log(one_minus_w), mean = 0, sd = 0;
  if (n <= 11) {
    // kG exceeds every y that n values can give, so that the logarithm exists.
    y = -std::log(polynomial(kG, size) - y);
    mean = polynomial(kC3, size);
    sd = std::exp(polynomial(kC4, size));
  } else {
    mean = polynomial(kC5, log_n);
    sd = std::exp(polynomial(kC6, log_n));
  }
  return normal_cdf(-(y - mean) / sd);
}

}  // namespace

ShapiroWilk shapiro_wilk(std::span<const double> values) {
  ShapiroWilk result;
  result.n = static_cast<int>(values.size());
  result.w = result.p = kNaN;
  if (values.size() < 3) result.status = StatisticStatus::too_few;
  if (values.size() > 5000) result.status = StatisticStatus::too_many;
  if (result.status != StatisticStatus::ok) return result;

  std::vector<double> x(values.begin(), values.end());
  std::sort(x.begin(), x.end());
  const double middle = x[x.size() / 2], range = x.back() - x.front();
  if (only_rounding(range, largest_magnitude(values))) {
    result.status = StatisticStatus::no_variance;
    return result;
  }
  double mean = 0;
  for (double& value : x) {
    value = (value - middle) / range;
    mean += value;
  }
  mean /= static_cast<double>(x.size());

  // W is the squared correlation of the order statistics with the coefficients; 1 - W without cancellation.
  const std::vector<double> a = coefficients(x.size());
  double saa = 0, sxx = 0, sax = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t mirror = x.size() - 1 - i;
    const double coefficient = i == mirror ? 0.0 : (i < mirror ? -a[i] : a[mirror]);
    const double deviation = x[i] - mean;
    saa += coefficient * coefficient;
    sxx += deviation * deviation;
    sax += coefficient * deviation;
  }
  const double root = std::sqrt(saa * sxx);
  const double one_minus_w = std::clamp((root - sax) * (root + sax) / (saa * sxx), 0.0, 1.0);
  result.w = 1 - one_minus_w;
  result.p = x.size() == 3 ? p_of_three(x[1] - x[0], x[2] - x[1]) : p_of(one_minus_w, x.size());
  return result;
}

}  // namespace jnd
