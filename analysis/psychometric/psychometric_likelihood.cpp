#include "analysis/psychometric/psychometric_likelihood.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

// A prior that excludes a lapse of 0 keeps the search this far from it.
constexpr double kLeastLapse = 1e-12;
// Below, 1 / rate would overflow; such a rate belongs to a count of 0, or the place is hopeless anyway.

void check_model(const PsychometricModel& model) {
  const double guess = model.guess.value_or(0), lapse = model.lapse.value_or(0);
  if (!(guess >= 0 && guess < 1)) throw std::invalid_argument("guess must be 0 to below 1");
  if (!(lapse >= 0 && lapse < 1)) throw std::invalid_argument("lapse must be 0 to below 1");
  const double most_guess = model.guess.value_or(kLargestGuess), most_lapse = model.lapse.value_or(kLargestLapse);
  if (!(most_guess + most_lapse < 1)) throw std::invalid_argument("guess and lapse together must stay below 1");
  if (!(model.prior.a >= 1 && model.prior.b >= 1))
    throw std::invalid_argument("the prior's a and b must be at least 1");
}

}  // namespace

PsychometricShape psychometric_shape(PsychometricFunction function, double u) noexcept {
  PsychometricShape shape;
  switch (function) {
    case PsychometricFunction::logistic: {
      const double e = std::exp(-std::abs(u));
      const double large = 1 / (1 + e), small = e / (1 + e);
      shape.g = u >= 0 ? large : small;
      shape.upper = u >= 0 ? small : large;
      shape.first = large * small;
      shape.second = shape.first * (shape.upper - shape.g);
      return shape;
    }
    case PsychometricFunction::gaussian: {
      const double small = normal_cdf(-std::abs(u));
      shape.g = u >= 0 ? 1 - small : small;
      shape.upper = u >= 0 ? small : 1 - small;
      shape.first = normal_density(u);
      shape.second = -u * shape.first;
      return shape;
    }
    case PsychometricFunction::weibull:
    case PsychometricFunction::gumbel: {
      const double e = std::exp(u);
      shape.upper = std::exp(-e);
      shape.g = -std::expm1(-e);
      // From u = 6.7 on the upper tail is 0 in double precision; so are its derivatives, though e may overflow.
      shape.first = shape.upper > 0 ? e * shape.upper : 0;
      shape.second = shape.upper > 0 ? shape.first * (1 - e) : 0;
      return shape;
    }
  }
  return shape;
}

double psychometric_shape_quantile(PsychometricFunction function, double p) noexcept {
  switch (function) {
    case PsychometricFunction::logistic:
      return std::log(p) - std::log1p(-p);
    case PsychometricFunction::gaussian:
      return normal_quantile(p);
    case PsychometricFunction::weibull:
    case PsychometricFunction::gumbel:
      return std::log(-std::log1p(-p));
  }
  return 0;
}

double psychometric_cdf(PsychometricFunction function, double location, double second, double x) noexcept {
  double u = second * (x - location);
  if (function == PsychometricFunction::gaussian) u = (x - location) / second;
  if (function == PsychometricFunction::weibull) u = second * std::log(x / location);
  return psychometric_shape(function, u).g;
}

double count_log(double k, double p) noexcept {
  return k > 0 ? k * std::log(p) : 0;
}

PsychometricData psychometric_data(std::span<const PsychometricLevel> levels, const PsychometricModel& model) {
  check_model(model);
  PsychometricData data;
  data.function = model.function;
  const bool logarithmic = model.function == PsychometricFunction::weibull;
  std::vector<PsychometricLevel> sorted;
  for (const PsychometricLevel& level : levels) {
    if (level.n < 0 || level.k < 0 || level.k > level.n) throw std::invalid_argument("counts must be 0 <= k <= n");
    if (!std::isfinite(level.x) || (logarithmic && level.x <= 0))
      throw std::invalid_argument("levels must be finite, and above 0 for the Weibull function");
    if (level.n > 0) sorted.push_back(level);
  }
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  for (const PsychometricLevel& level : sorted) {
    const double t = logarithmic ? std::log(level.x) : level.x;
    if (data.t.empty() || data.t.back() != t) {
      data.x.push_back(level.x);
      data.t.push_back(t);
      data.n.push_back(0);
      data.k.push_back(0);
    }
    data.n.back() += level.n;
    data.k.back() += level.k;
  }
  for (std::size_t i = 0; i < data.levels(); ++i) {
    const double n = data.n[i], k = data.k[i];
    if (n > std::numeric_limits<int>::max()) throw std::invalid_argument("more than 2^31 trials at one level");
    data.trials += n;
    data.answers += k;
    data.saturated += count_log(k, k / n) + count_log(n - k, (n - k) / n);
  }
  for (std::size_t i = 0; i < data.levels(); ++i) data.shift += data.t[i] * (data.n[i] / data.trials);
  if (!logarithmic && data.range() > 0) data.scale = data.range();
  for (double& t : data.t) t = (t - data.shift) / data.scale;
  return data;
}

void move_axis(PsychometricData& data, double shift, double scale) noexcept {
  for (std::size_t i = 0; i < data.levels(); ++i) {
    const double x = data.function == PsychometricFunction::weibull ? std::log(data.x[i]) : data.x[i];
    data.t[i] = (x - shift) / scale;
  }
  data.shift = shift;
  data.scale = scale;
}

PsychometricLikelihood::PsychometricLikelihood(PsychometricData data, const PsychometricModel& model)
    : data_(std::move(data)) {
  if (model.estimator == PsychometricEstimator::map && !model.lapse) {
    prior_a_ = model.prior.a - 1;
    prior_b_ = model.prior.b - 1;
  }
  const double least_lapse = prior_a_ > 0 ? kLeastLapse : 0;
  box_.lower = {-kInf, 0, model.lapse.value_or(least_lapse), model.guess.value_or(0)};
  box_.upper = {kInf, kInf, model.lapse.value_or(kLargestLapse), model.guess.value_or(kLargestGuess)};
}

PsychometricLikelihood::PsychometricLikelihood(const PsychometricLikelihood& other, PsychometricData data)
    : data_(std::move(data)), box_(other.box_), prior_a_(other.prior_a_), prior_b_(other.prior_b_) {}

int PsychometricLikelihood::free_parameters() const noexcept {
  int count = 0;
  for (std::size_t i = 0; i < variables; ++i) count += box_.lower[i] < box_.upper[i] ? 1 : 0;
  return count;
}

double PsychometricLikelihood::log_prior(double lapse_rate) const noexcept {
  return count_log(prior_a_, lapse_rate) + count_log(prior_b_, 1 - lapse_rate);
}

double PsychometricLikelihood::log_likelihood(const std::vector<double>& place) const noexcept {
  const double lower = place[guess], upper = place[lapse], span = 1 - lower - upper;
  double sum = 0;
  for (std::size_t i = 0; i < data_.levels(); ++i) {
    const PsychometricShape shape = psychometric_shape(data_.function, place[c0] + place[c1] * data_.t[i]);
    sum +=
        count_log(data_.k[i], lower + span * shape.g) + count_log(data_.n[i] - data_.k[i], upper + span * shape.upper);
  }
  return std::isnan(sum) ? -kInf : sum;
}

double PsychometricLikelihood::value(const std::vector<double>& place) const noexcept {
  return log_likelihood(place) + log_prior(place[lapse]);
}

void PsychometricLikelihood::derivatives(const std::vector<double>& place, NewtonDerivatives& out) const {
  std::array<double, variables> gradient{};
  std::array<std::array<double, variables>, variables> curvature{}, expected{};
  const double lower = place[guess], upper = place[lapse], span = 1 - lower - upper;
  out.value = log_prior(upper);
  for (std::size_t i = 0; i < data_.levels(); ++i) {
    const double t = data_.t[i], n = data_.n[i], k = data_.k[i], m = n - k;
    const PsychometricShape shape = psychometric_shape(data_.function, place[c0] + place[c1] * t);
    const double p = lower + span * shape.g, q = upper + span * shape.upper;
    out.value += count_log(k, p) + count_log(m, q);
    const std::array<double, variables> first = {span * shape.first, span * shape.first * t, -shape.g, shape.upper};
    // The ratios are formed before they are squared: p * p would underflow long before they are extreme.
    std::array<double, variables> by_p{}, by_q{};
    const double one_over_p = p > kLeastRate ? 1 / p : 0, one_over_q = q > kLeastRate ? 1 / q : 0;
    const double score = k * one_over_p - m * one_over_q;
    for (std::size_t a = 0; a < variables; ++a) {
      by_p[a] = first[a] * one_over_p;
      by_q[a] = first[a] * one_over_q;
      gradient[a] += score * first[a];
      for (std::size_t b = 0; b <= a; ++b) {
        curvature[a][b] += k * by_p[a] * by_p[b] + m * by_q[a] * by_q[b];
        expected[a][b] += n * by_p[a] * first[b] * one_over_q;
      }
    }
    // Second derivatives of p: in (c0, c1) span G'' (1, t)(1, t)^T, of c0 and c1 with lapse and guess -G' (1, t).
    curvature[c0][c0] -= score * span * shape.second;
    curvature[c1][c0] -= score * span * shape.second * t;
    curvature[c1][c1] -= score * span * shape.second * t * t;
    for (const std::size_t rate : {lapse, guess}) {
      curvature[rate][c0] += score * shape.first;
      curvature[rate][c1] += score * shape.first * t;
    }
  }
  if (prior_a_ > 0 || prior_b_ > 0) {
    const double kept = 1 - upper;
    gradient[lapse] += (prior_a_ > 0 ? prior_a_ / upper : 0) - prior_b_ / kept;
    const double prior = (prior_a_ > 0 ? prior_a_ / (upper * upper) : 0) + prior_b_ / (kept * kept);
    curvature[lapse][lapse] += prior;
    expected[lapse][lapse] += prior;
  }
  out.gradient.assign(gradient.begin(), gradient.end());
  out.curvature.resize(variables * variables);
  out.expected.resize(variables * variables);
  for (std::size_t a = 0; a < variables; ++a)
    for (std::size_t b = 0; b < variables; ++b) {
      out.curvature[a * variables + b] = a >= b ? curvature[a][b] : curvature[b][a];
      out.expected[a * variables + b] = a >= b ? expected[a][b] : expected[b][a];
    }
}

}  // namespace jnd
