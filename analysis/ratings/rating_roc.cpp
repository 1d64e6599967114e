#include "analysis/ratings/rating_roc.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"
#include "analysis/numerics/words.h"
#include "analysis/ratings/ordinal_probit.h"

namespace jnd {

namespace {

constexpr auto kRatingStatusWords = words<RatingStatus>({{"ok", RatingStatus::ok},
                                                         {"separated", RatingStatus::separated},
                                                         {"unbounded", RatingStatus::unbounded},
                                                         {"not_applicable", RatingStatus::not_applicable},
                                                         {"no_information", RatingStatus::no_information},
                                                         {"missing", RatingStatus::missing}});

constexpr RatingEstimate kUndefined{kNaN, kNaN};

EqualVarianceRoc undefined_equal(RatingStatus status) {
  return {status, kNaN, {}, kUndefined, kUndefined, kNaN};
}

UnequalVarianceRoc undefined_unequal(RatingStatus status) {
  return {status, kNaN, {}, kUndefined, kUndefined, kUndefined, kUndefined, kUndefined, kUndefined, kNaN, kNaN, kNaN};
}

double total_of(const std::vector<double>& row) {
  double sum = 0;
  for (const double n : row) sum += n;
  return sum;
}

// A_z = Phi(d / sqrt 2).
RatingEstimate area_of(const RatingEstimate& d) {
  const double z = d.value / std::numbers::sqrt2;
  return {normal_cdf(z), normal_density(z) / std::numbers::sqrt2 * d.se};
}

std::vector<RatingEstimate> criteria_of(const OrdinalFit& fit, std::size_t count) {
  std::vector<RatingEstimate> out;
  for (std::size_t j = 0; j < count; ++j) out.push_back({fit.place[j], fit.error(j)});
  return out;
}

// counts: noise, then signal, of categories that are used.
EqualVarianceRoc equal_variance(const OrdinalProbit& model, const CategoryCounts& counts, double saturated,
                                OrdinalFit& fit) {
  EqualVarianceRoc out = undefined_equal(RatingStatus::ok);
  for (const double direction : {1.0, -1.0})
    if (recedes(counts, {0, direction})) {
      out.status = RatingStatus::separated;
      out.log_likelihood = saturated;
      out.dprime.value = direction * kInf;
      const double shared = std::inner_product(counts[0].begin(), counts[0].end(), counts[1].begin(), 0.0);
      if (shared == 0) out.area.value = direction > 0 ? 1 : 0;
      out.deviance = 0;
      return out;
    }
  fit = fit_ordinal(model, model.box(), model.start());
  const std::size_t effect = model.criteria();
  out.log_likelihood = fit.log_likelihood;
  out.criteria = criteria_of(fit, model.criteria());
  out.dprime = {fit.place[effect], fit.error(effect)};
  out.area = area_of(out.dprime);
  out.deviance = std::fmax(0, 2 * (saturated - fit.log_likelihood));
  return out;
}

// d_a = mu sqrt(2 / (1 + sigma^2)) and its error from the covariance of mu and ln sigma.
RatingEstimate d_a_of(const OrdinalFit& fit, std::size_t mu, std::size_t ln_sigma) {
  const double variance = std::exp(2 * fit.place[ln_sigma]);
  const double per_mu = std::sqrt(2 / (1 + variance));
  const double value = fit.place[mu] * per_mu, per_ln_sigma = -value * variance / (1 + variance);
  const double covariance = fit.covariance[mu * fit.place.size() + ln_sigma];
  return {value, std::sqrt(per_mu * per_mu * fit.variance(mu) + per_ln_sigma * per_ln_sigma * fit.variance(ln_sigma) +
                           2 * per_mu * per_ln_sigma * covariance)};
}

UnequalVarianceRoc unequal_variance(const OrdinalProbit& model, const EqualVarianceRoc& equal, double saturated,
                                    const OrdinalFit& start) {
  UnequalVarianceRoc out = undefined_unequal(RatingStatus::ok);
  const auto [fit, bounded] = fit_scaled_ordinal(model, start.place);
  out.log_likelihood = std::fmax(fit.log_likelihood, equal.log_likelihood);
  out.deviance = std::fmax(0, 2 * (saturated - out.log_likelihood));
  out.lr_equal_variance = 2 * (out.log_likelihood - equal.log_likelihood);
  out.p_equal_variance = chi2_upper(out.lr_equal_variance, 1);
  if (!bounded) {
    out.status = RatingStatus::unbounded;
    return out;
  }
  const std::size_t mu = model.criteria(), ln_sigma = mu + 1;
  out.criteria = criteria_of(fit, model.criteria());
  out.mu = {fit.place[mu], fit.error(mu)};
  out.ln_sigma = {fit.place[ln_sigma], fit.error(ln_sigma)};
  const double sigma = std::exp(out.ln_sigma.value);
  out.sigma = {sigma, sigma * out.ln_sigma.se};
  out.zroc_slope = {1 / sigma, out.ln_sigma.se / sigma};
  out.d_a = d_a_of(fit, mu, ln_sigma);
  out.area = area_of(out.d_a);
  return out;
}

// DeLong's placement values: of a trial of one class, the share of the other class that it beats, ties half.
RatingEstimate trapezoid_area(const std::vector<double>& noise, const std::vector<double>& signal) {
  const double n = total_of(noise), m = total_of(signal);
  if (!(n > 0 && m > 0)) return kUndefined;
  double area = 0, noise_below = 0, noise_squares = 0, signal_squares = 0;
  std::vector<double> of_signal, of_noise;
  double signal_above = m;
  for (std::size_t j = 0; j < noise.size(); ++j) {
    signal_above -= signal[j];
    of_signal.push_back((noise_below + 0.5 * noise[j]) / n);
    of_noise.push_back((signal_above + 0.5 * signal[j]) / m);
    area += signal[j] * of_signal.back() / m;
    noise_below += noise[j];
  }
  for (std::size_t j = 0; j < noise.size(); ++j) {
    signal_squares += signal[j] * (of_signal[j] - area) * (of_signal[j] - area);
    noise_squares += noise[j] * (of_noise[j] - area) * (of_noise[j] - area);
  }
  if (n < 2 || m < 2) return {area, kNaN};
  return {area, std::sqrt(signal_squares / (m - 1) / m + noise_squares / (n - 1) / n)};
}

}  // namespace

std::string_view to_string(RatingStatus status) noexcept {
  return word_of(kRatingStatusWords, status);
}

RatingRoc rating_roc(const std::vector<int>& noise, const std::vector<int>& signal) {
  const UsedCategories used = used_categories(
      {std::vector<double>(noise.begin(), noise.end()), std::vector<double>(signal.begin(), signal.end())});
  RatingRoc out;
  for (const int category : used.used) out.categories_used.push_back(category + 1);
  out.area_trapezoid = trapezoid_area(used.counts[0], used.counts[1]);
  const bool missing = !(total_of(used.counts[0]) > 0 && total_of(used.counts[1]) > 0);
  if (missing || used.used.size() < 2) {
    const RatingStatus status = missing ? RatingStatus::missing : RatingStatus::no_information;
    out.equal = undefined_equal(status);
    out.unequal = undefined_unequal(status);
    return out;
  }
  const OrdinalProbit model(used.counts, {{0}, {1}}, {false, true});
  const double saturated = saturated_log_likelihood(used.counts);
  OrdinalFit fit;
  out.equal = equal_variance(model, used.counts, saturated, fit);
  const bool applicable = used.used.size() > 2 && out.equal.status == RatingStatus::ok;
  out.unequal =
      applicable ? unequal_variance(model, out.equal, saturated, fit) : undefined_unequal(RatingStatus::not_applicable);
  return out;
}

}  // namespace jnd
