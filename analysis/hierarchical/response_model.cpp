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
constexpr double kLeastLog = -700;

// With the share of guesses that give this answer.
double mixed(double log_rate, double lapse, double share = 0.5) {
  return lapse == 0 ? std::max(log_rate, kLeastLog) : std::log(lapse * share + (1 - lapse) * std::exp(log_rate));
}

// ln of the probability of what lies between two criteria, of which the first has more positive answers.
double log_between(const LogRates& more, const LogRates& fewer) {
  const auto log_difference = [](double large, double small) {
    return large + std::log(-std::expm1(std::min(small - large, 0.0)));
  };
  return more.positive < fewer.negative ? log_difference(more.positive, fewer.positive)
                                        : log_difference(fewer.negative, more.negative);
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
  if (model == ResponseModel::differencing) {
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const LogRates rates = log_rates_of_slope(model, level, slopes[i], criterion, 0);
      positive[i] = rates.positive;
      negative[i] = rates.negative;
    }
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

GradedLogRates graded_log_rates(ResponseModel model, double level, double ln_s, double criterion,
                                const SharedParameters& shared) {
  const auto rates_at = [&](double shift) {
    return std::isfinite(shift) ? log_rates(model, level, ln_s, criterion + shift, 0) : LogRates{};
  };
  return graded_log_rates(rates_at(0), rates_at(shared.sure_above), rates_at(-shared.sure_below), shared);
}

GradedLogRates graded_log_rates(const LogRates& middle, const LogRates& above, const LogRates& below,
                                const SharedParameters& shared) {
  GradedLogRates rates = {middle, {kLeastLog, kLeastLog}};
  const auto guess = [](double distance) { return std::isfinite(distance) ? 0.25 : 0.5; };
  if (std::isfinite(shared.sure_above)) {
    rates.sure.positive = mixed(above.positive, shared.lapse, 0.25);
    rates.unsure.positive = log_between(middle, above);
  }
  if (std::isfinite(shared.sure_below)) {
    rates.sure.negative = mixed(below.negative, shared.lapse, 0.25);
    rates.unsure.negative = log_between(below, middle);
  }
  rates.unsure.positive = mixed(rates.unsure.positive, shared.lapse, guess(shared.sure_above));
  rates.unsure.negative = mixed(rates.unsure.negative, shared.lapse, guess(shared.sure_below));
  return rates;
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
  const GradedLogRates rates = graded_log_rates(model, level, ln_s, criterion, shared);
  const GradedCounts graded = graded_counts(counts, shared);
  return graded.unsure.positive * rates.unsure.positive + graded.unsure.negative * rates.unsure.negative +
         graded.sure.positive * rates.sure.positive + graded.sure.negative * rates.sure.negative;
}

CellInformation expected_information(ResponseModel model, std::span<const LevelTrials> design, double ln_s,
                                     double criterion, const SharedParameters& shared) {
  constexpr double kNudge = 1e-4, kLeastVariance = 1e-6;
  const double nudge_k = model == ResponseModel::choice ? kNudge * std::exp(ln_s) : kNudge;
  CellInformation information;
  const auto add = [&information](double weight, double by_s, double by_k) {
    information.s += weight * by_s * by_s;
    information.k += weight * by_k * by_k;
    information.both += weight * by_s * by_k;
  };
  for (const LevelTrials& one : design) {
    if (shared.graded()) {
      const auto rates = [&](double s, double k) {
        const auto [unsure, sure] = graded_log_rates(model, one.level, ln_s + s, criterion + k, shared);
        return std::array{std::exp(unsure.positive), std::exp(unsure.negative), std::exp(sure.positive),
                          std::exp(sure.negative)};
      };
      const auto p = rates(0, 0), more_s = rates(kNudge, 0), less_s = rates(-kNudge, 0), more_k = rates(0, nudge_k),
                 less_k = rates(0, -nudge_k);
      for (std::size_t i = 0; i < p.size(); ++i)
        add(one.trials / std::max(p[i], kLeastVariance), (more_s[i] - less_s[i]) / (2 * kNudge),
            (more_k[i] - less_k[i]) / (2 * nudge_k));
      continue;
    }
    const auto rate = [&](double s, double k) {
      return std::exp(log_rates(model, one.level, ln_s + s, criterion + k, shared.lapse).positive);
    };
    const double p = rate(0, 0);
    add(one.trials / std::max(p * (1 - p), kLeastVariance), (rate(kNudge, 0) - rate(-kNudge, 0)) / (2 * kNudge),
        (rate(0, nudge_k) - rate(0, -nudge_k)) / (2 * nudge_k));
  }
  return information;
}

}  // namespace jnd
