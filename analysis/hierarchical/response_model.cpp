#include "analysis/hierarchical/response_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "analysis/lattice/fast_functions.h"
#include "analysis/numerics/normal.h"

namespace jnd {

namespace {

// Logarithms below this are no number of their own: e^-700 is the smallest likelihood that counts.
constexpr double kLeastLog = -700, kLeastRate = 1e-304;

// With guesses, half of which are this answer.
double mixed(double log_rate, double lapse) {
  return lapse == 0 ? std::max(log_rate, kLeastLog) : std::log(lapse / 2 + (1 - lapse) * std::exp(log_rate));
}

// Half of 2 z(p(c)), with the sign of the level; 1 - p(c) keeps its digits.
double unbiased_z(double dprime) {
  constexpr double kSurely = 70;  // beyond it no answer is less likely than counts
  const double half = std::min(std::abs(dprime), kSurely) / 2;
  return std::copysign(-normal_quantile(2 * normal_cdf(half) * normal_cdf(-half)), dprime);
}

}  // namespace

double judged_by(ResponseModel model, double level, double slope) {
  return model == ResponseModel::independent ? unbiased_z(level * slope) : level * slope;
}

LogRates log_rates(ResponseModel model, double level, double ln_s, double criterion, double lapse) {
  return log_rates_of_slope(model, level, std::exp(-ln_s), criterion, lapse);
}

LogRates log_rates_of_slope(ResponseModel model, double level, double slope, double criterion, double lapse) {
  if (model == ResponseModel::differencing) {
    const double d = level * slope / std::numbers::sqrt2, t = std::exp(criterion) / std::numbers::sqrt2;
    const double different = normal_cdf(d - t) + normal_cdf(-d - t), same = normal_cdf(t - d) - normal_cdf(-d - t);
    return {mixed(std::log(different), lapse), mixed(std::log(same), lapse)};
  }
  const double z = judged_by(model, level, slope) - criterion * (model == ResponseModel::choice ? slope : 1);
  return {mixed(tabled_log_normal_cdf(z), lapse), mixed(tabled_log_normal_cdf(-z), lapse)};
}

void log_rates_of_slopes(ResponseModel model, double level, std::span<const double> slopes,
                         std::span<const double> judged, double criterion, double* positive, double* negative) {
  const std::size_t count = slopes.size();
  if (model == ResponseModel::differencing) {
    // Phi(d - t), Phi(-d - t) and Phi(t - d), one after the other.
    const double t = std::exp(criterion) / std::numbers::sqrt2;
    std::vector<double> z(3 * count), rates(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const double d = level * slopes[i] / std::numbers::sqrt2;
      z[i] = d - t;
      z[count + i] = -d - t;
      z[2 * count + i] = t - d;
    }
    log_normal_cdfs(z, rates.data());
    exponentiate(rates, 0);
    for (std::size_t i = 0; i < count; ++i) {
      positive[i] = std::max(rates[i] + rates[count + i], kLeastRate);
      negative[i] = std::max(rates[2 * count + i] - rates[count + i], kLeastRate);
    }
    take_logarithms({positive, count});
    take_logarithms({negative, count});
    return;
  }
  std::vector<double> z(judged.begin(), judged.end());
  for (std::size_t i = 0; i < z.size(); ++i) z[i] -= criterion * (model == ResponseModel::choice ? slopes[i] : 1);
  log_normal_cdfs(z, positive);
  for (double& one : z) one = -one;
  log_normal_cdfs(z, negative);
  for (std::size_t i = 0; i < z.size(); ++i) {
    positive[i] = std::max(positive[i], kLeastLog);
    negative[i] = std::max(negative[i], kLeastLog);
  }
}

void log_rates_between(std::span<const double> more_positive, std::span<const double> more_negative,
                       std::span<const double> fewer_positive, std::span<const double> fewer_negative, double* found) {
  const std::size_t count = more_positive.size();
  std::vector<double> larger(count), share(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bool below = more_positive[i] < fewer_negative[i];
    larger[i] = below ? more_positive[i] : fewer_negative[i];
    share[i] = std::min(below ? fewer_positive[i] : more_negative[i], larger[i]) - larger[i];
  }
  exponentiate(share, 0);
  for (double& one : share) one = std::max(1 - one, kLeastRate);
  take_logarithms(share);
  for (std::size_t i = 0; i < count; ++i) found[i] = std::max(larger[i] + share[i], kLeastLog);
}

AnswerTally& AnswerTally::operator+=(const AnswerTally& other) noexcept {
  positive += other.positive;
  negative += other.negative;
  sure_positive += other.sure_positive;
  sure_negative += other.sure_negative;
  return *this;
}

GradedCounts graded_counts(const AnswerTally& counts, const SharedParameters& shared) noexcept {
  const double positive = std::isfinite(shared.sure_above) ? counts.sure_positive : 0,
               negative = std::isfinite(shared.sure_below) ? counts.sure_negative : 0;
  return {{counts.positive - positive, counts.negative - negative}, {positive, negative}};
}

double log_likelihood_of(const AnswerTally& counts, ResponseModel model, double level, double ln_s, double criterion,
                         const SharedParameters& shared) {
  if (!shared.graded()) {
    const LogRates rates = log_rates(model, level, ln_s, criterion, shared.lapse);
    return counts.positive * rates.positive + counts.negative * rates.negative;
  }
  const AnswerChances chances = answer_chances(model, level, ln_s, criterion, shared);
  const GradedCounts graded = graded_counts(counts, shared);
  const auto of = [](double count, const AnswerChance& one) {
    return count * std::log(std::max(one.chance, kLeastRate));
  };
  return of(graded.unsure.positive, chances.unsure_positive) + of(graded.unsure.negative, chances.unsure_negative) +
         of(graded.sure.positive, chances.sure_positive) + of(graded.sure.negative, chances.sure_negative);
}

namespace {

// F, and 1 - F, with the derivatives of F.
struct Rate {
  double positive = 0, negative = 1;
  double by_s = 0, by_k = 0;
};

Rate rate_of(ResponseModel model, double level, double slope, double criterion) {
  if (model == ResponseModel::differencing) {
    const double d = level * slope / std::numbers::sqrt2, t = std::exp(criterion) / std::numbers::sqrt2;
    const double near = normal_density(d - t), far = normal_density(d + t);
    return {normal_cdf(d - t) + normal_cdf(-d - t), normal_cdf(t - d) - normal_cdf(-d - t), -d * (near - far),
            -t * (near + far)};
  }
  const double judged = judged_by(model, level, slope);
  const double by_criterion = model == ResponseModel::choice ? slope : 1, z = judged - criterion * by_criterion;
  double z_by_s = model == ResponseModel::choice ? -z : -judged;
  if (model == ResponseModel::independent) {
    const double half = std::abs(level * slope) / 2, density = normal_density(judged);
    z_by_s = density == 0 ? 0 : 2 * half * normal_density(half) * (1 - 2 * normal_cdf(half)) / density;
    z_by_s = std::copysign(z_by_s, -level);
  }
  const double density = normal_density(z);
  return {normal_cdf(z), normal_cdf(-z), density * z_by_s, -density * by_criterion};
}

}  // namespace

AnswerChances answer_chances(ResponseModel model, double level, double ln_s, double criterion,
                             const SharedParameters& shared) {
  const double slope = std::exp(-ln_s);
  const bool above = std::isfinite(shared.sure_above), below = std::isfinite(shared.sure_below);
  const auto between = [&shared](const Rate& more, const Rate& fewer, double share) {
    const double rate =
                     more.positive < fewer.negative ? more.positive - fewer.positive : fewer.negative - more.negative,
                 left = 1 - shared.lapse;
    return AnswerChance{shared.lapse * share + left * std::max(rate, 0.0), left * (more.by_s - fewer.by_s),
                        left * (more.by_k - fewer.by_k)};
  };
  const Rate none, all{1, 0}, middle = rate_of(model, level, slope, criterion);
  const Rate surely = above ? rate_of(model, level, slope, criterion + shared.sure_above) : none;
  const Rate hardly = below ? rate_of(model, level, slope, criterion - shared.sure_below) : all;
  AnswerChances chances;
  chances.unsure_positive = between(middle, surely, above ? 0.25 : 0.5);
  chances.unsure_negative = between(hardly, middle, below ? 0.25 : 0.5);
  if (above) chances.sure_positive = between(surely, none, 0.25);
  if (below) chances.sure_negative = between(all, hardly, 0.25);
  return chances;
}

AnswerSlopes slopes_of(const AnswerTally& counts, ResponseModel model, double level, double ln_s, double criterion,
                       const SharedParameters& shared) {
  constexpr double kLeastChance = 1e-300;
  const AnswerChances chances = answer_chances(model, level, ln_s, criterion, shared);
  const GradedCounts graded = graded_counts(counts, shared);
  AnswerSlopes slopes;
  const auto add = [&](double count, const AnswerChance& one) {
    const double share = count / std::max(one.chance, kLeastChance);
    slopes.s += share * one.by_s;
    slopes.k += share * one.by_k;
  };
  add(graded.unsure.positive, chances.unsure_positive);
  add(graded.unsure.negative, chances.unsure_negative);
  add(graded.sure.positive, chances.sure_positive);
  add(graded.sure.negative, chances.sure_negative);
  return slopes;
}

CellInformation expected_information(ResponseModel model, std::span<const LevelTrials> design, double ln_s,
                                     double criterion, const SharedParameters& shared) {
  constexpr double kLeastChance = 1e-6;
  CellInformation information;
  for (const LevelTrials& level : design) {
    const AnswerChances chances = answer_chances(model, level.level, ln_s, criterion, shared);
    for (const AnswerChance* one :
         {&chances.unsure_positive, &chances.unsure_negative, &chances.sure_positive, &chances.sure_negative}) {
      const double weight = level.trials / std::max(one->chance, kLeastChance);
      information.s += weight * one->by_s * one->by_s;
      information.k += weight * one->by_k * one->by_k;
      information.both += weight * one->by_s * one->by_k;
    }
  }
  return information;
}

}  // namespace jnd
