#include "analysis/hierarchical/response_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/hierarchical/fast_functions.h"
#include "analysis/numerics/normal.h"

namespace jnd {

namespace {

// Logarithms below this are no number of their own: e^-700 is the smallest likelihood that counts.
constexpr double kLeastLog = -700;

double mixed(double log_rate, double lapse) {
  return lapse == 0 ? std::max(log_rate, kLeastLog) : std::log(lapse / 2 + (1 - lapse) * std::exp(log_rate));
}

}  // namespace

LogRates log_rates(ResponseModel model, double level, double ln_s, double criterion, double lapse) {
  return log_rates_of_slope(model, level, std::exp(-ln_s), criterion, lapse);
}

LogRates log_rates_of_slope(ResponseModel model, double level, double slope, double criterion, double lapse) {
  if (model == ResponseModel::differencing) {
    const double d = level * slope / std::numbers::sqrt2, t = std::exp(criterion) / std::numbers::sqrt2;
    const double different = normal_cdf(d - t) + normal_cdf(-d - t), same = normal_cdf(t - d) - normal_cdf(-d - t);
    return {mixed(std::log(different), lapse), mixed(std::log(same), lapse)};
  }
  const double z = model == ResponseModel::yes_no ? level * slope - criterion : (level - criterion) * slope;
  return {mixed(tabled_log_normal_cdf(z), lapse), mixed(tabled_log_normal_cdf(-z), lapse)};
}

CellInformation expected_information(ResponseModel model, std::span<const LevelTrials> design, double ln_s,
                                     double criterion, double lapse) {
  constexpr double kNudge = 1e-4, kLeastVariance = 1e-6;
  const double nudge_k = model == ResponseModel::choice ? kNudge * std::exp(ln_s) : kNudge;
  CellInformation information;
  for (const LevelTrials& one : design) {
    const auto rate = [&](double s, double k) {
      return std::exp(log_rates(model, one.level, ln_s + s, criterion + k, lapse).positive);
    };
    const double p = rate(0, 0), by_s = (rate(kNudge, 0) - rate(-kNudge, 0)) / (2 * kNudge),
                 by_k = (rate(0, nudge_k) - rate(0, -nudge_k)) / (2 * nudge_k);
    const double weight = one.trials / std::max(p * (1 - p), kLeastVariance);
    information.s += weight * by_s * by_s;
    information.k += weight * by_k * by_k;
    information.both += weight * by_s * by_k;
  }
  return information;
}

}  // namespace jnd
