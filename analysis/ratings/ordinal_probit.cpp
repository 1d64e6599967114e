#include "analysis/ratings/ordinal_probit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

UsedCategories used_categories(const CategoryCounts& counts) {
  UsedCategories out;
  out.counts.resize(counts.size());
  const std::size_t categories = counts.empty() ? 0 : counts.front().size();
  for (std::size_t j = 0; j < categories; ++j) {
    const auto uses = [j](const std::vector<double>& row) { return row[j] > 0; };
    if (std::none_of(counts.begin(), counts.end(), uses)) continue;
    out.used.push_back(static_cast<int>(j));
    for (std::size_t i = 0; i < counts.size(); ++i) out.counts[i].push_back(counts[i][j]);
  }
  return out;
}

double saturated_log_likelihood(const CategoryCounts& counts) {
  double sum = 0;
  for (const std::vector<double>& row : counts) {
    double trials = 0;
    for (const double n : row) trials += n;
    for (const double n : row)
      if (n > 0) sum += n * std::log(n / trials);
  }
  return sum;
}

bool recedes(const CategoryCounts& counts, const std::vector<double>& direction) {
  // Criterion m (between categories m and m + 1) has to move at least as far as every row with answers below it, and at
  // most as far as every row with answers above it.
  const std::size_t categories = counts.empty() ? 0 : counts.front().size();
  for (std::size_t m = 0; m + 1 < categories; ++m) {
    double at_least = -kInf, at_most = kInf;
    for (std::size_t i = 0; i < counts.size(); ++i)
      for (std::size_t j = 0; j < categories; ++j) {
        if (!(counts[i][j] > 0)) continue;
        if (j <= m) at_least = std::fmax(at_least, direction[i]);
        if (j > m) at_most = std::fmin(at_most, direction[i]);
      }
    if (at_least > at_most) return false;
  }
  return true;
}

namespace {

// ln(Phi(high) - Phi(low)), with phi(high) and phi(low) over that difference. No difference of two numbers near 1 or
// two near 0 is taken, so that cells far out in a tail keep their digits.
struct NormalSlice {
  double log_mass, at_high, at_low;
};

NormalSlice lower_slice(double low, double high) {  // high <= 0
  const LogNormalCdf upper = log_normal_cdf(high);
  if (std::isinf(low)) return {upper.log_cdf, upper.inverse_mills, 0};
  const double share = -std::expm1(log_normal_cdf(low).log_cdf - upper.log_cdf);  // of Phi(high)
  const double at_high = upper.inverse_mills / share;
  return {upper.log_cdf + std::log(share), at_high, at_high * std::exp(0.5 * (high - low) * (high + low))};
}

NormalSlice normal_slice(double low, double high) {
  if (high <= 0) return lower_slice(low, high);
  if (low >= 0) {
    const NormalSlice mirrored = lower_slice(-high, -low);
    return {mirrored.log_mass, mirrored.at_low, mirrored.at_high};
  }
  if (std::isinf(low)) {
    const LogNormalCdf all = log_normal_cdf(high);
    return {all.log_cdf, all.inverse_mills, 0};
  }
  if (std::isinf(high)) {
    const LogNormalCdf all = log_normal_cdf(-low);
    return {all.log_cdf, 0, all.inverse_mills};
  }
  const double mass = 0.5 * (std::erf(high / std::numbers::sqrt2) - std::erf(low / std::numbers::sqrt2));
  return {std::log(mass), normal_density(high) / mass, normal_density(low) / mass};
}

double trials_of(const std::vector<double>& row) {
  double sum = 0;
  for (const double n : row) sum += n;
  return sum;
}

}  // namespace

// x = (c - eta) / s, and its derivatives on the parameters that it depends on. Curved: the second derivatives, all of
// which have ln sigma in them: d2x / (d ln sigma d parameter) = -dx / d parameter.
struct OrdinalProbit::Cut {
  double x = 0;
  std::vector<std::pair<std::size_t, double>> on;
  bool scaled = false;
};

OrdinalProbit::OrdinalProbit(CategoryCounts counts, std::vector<std::vector<double>> design, std::vector<bool> scaled)
    : counts_(std::move(counts)),
      design_(std::move(design)),
      scaled_(std::move(scaled)),
      criteria_(counts_.front().size() - 1),
      effects_(design_.front().size()) {
  scaled_.resize(counts_.size(), false);
}

OrdinalProbit::Cut OrdinalProbit::cut(const std::vector<double>& place, std::size_t row, std::size_t category) const {
  Cut out;
  out.scaled = scaled_[row];
  const double inverse_scale = out.scaled ? std::exp(-place.back()) : 1;
  double numerator = place[category];
  out.on.emplace_back(category, inverse_scale);
  for (std::size_t k = 0; k < effects_; ++k) {
    const double weight = design_[row][k];
    if (weight == 0) continue;
    numerator -= weight * place[criteria_ + k];
    out.on.emplace_back(criteria_ + k, -weight * inverse_scale);
  }
  out.x = numerator * inverse_scale;
  if (out.scaled) out.on.emplace_back(size() - 1, -out.x);
  return out;
}

double OrdinalProbit::value(const std::vector<double>& place) const {
  for (std::size_t j = 1; j < criteria_; ++j)
    if (!(place[j] > place[j - 1])) return -kInf;
  double sum = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    double low = -kInf;
    for (std::size_t j = 0; j <= criteria_; ++j) {
      const double high = j < criteria_ ? cut(place, i, j).x : kInf;
      if (counts_[i][j] > 0) sum += counts_[i][j] * normal_slice(low, high).log_mass;
      low = high;
    }
  }
  return std::isnan(sum) ? -kInf : sum;
}

void OrdinalProbit::derivatives(const std::vector<double>& place, NewtonDerivatives& out) const {
  const std::size_t k = size();
  out.value = value(place);
  out.gradient.assign(k, 0);
  out.curvature.assign(k * k, 0);
  out.expected.assign(k * k, 0);
  if (!std::isfinite(out.value)) return;
  const auto add_product = [&](double factor, const Cut& a, const Cut& b) {
    for (const auto& [p, dp] : a.on)
      for (const auto& [q, dq] : b.on) out.expected[p * k + q] += factor * dp * dq;
  };
  // The slope on a cut, its curvature, and what curves because the cut itself does.
  const auto add_cut = [&](double slope, double curvature, const Cut& at) {
    for (const auto& [p, dp] : at.on) out.gradient[p] += slope * dp;
    add_product(curvature, at, at);
    if (!at.scaled) return;
    for (const auto& [p, dp] : at.on) {
      out.curvature[p * k + k - 1] += slope * dp;
      if (p != k - 1) out.curvature[(k - 1) * k + p] += slope * dp;
    }
  };
  for (std::size_t i = 0; i < counts_.size(); ++i)
    for (std::size_t j = 0; j <= criteria_; ++j) {
      const double n = counts_[i][j];
      if (!(n > 0)) continue;
      const bool has_low = j > 0, has_high = j < criteria_;
      const Cut low = has_low ? cut(place, i, j - 1) : Cut{-kInf, {}, false};
      const Cut high = has_high ? cut(place, i, j) : Cut{kInf, {}, false};
      const NormalSlice slice = normal_slice(low.x, high.x);
      if (has_high) add_cut(n * slice.at_high, n * slice.at_high * (high.x + slice.at_high), high);
      if (has_low) add_cut(-n * slice.at_low, n * slice.at_low * (slice.at_low - low.x), low);
      if (!has_low || !has_high) continue;
      add_product(-n * slice.at_high * slice.at_low, high, low);
      add_product(-n * slice.at_high * slice.at_low, low, high);
    }
  for (std::size_t p = 0; p < k * k; ++p) out.curvature[p] += out.expected[p];
}

std::vector<double> OrdinalProbit::start() const {
  std::vector<double> place(size(), 0);
  double trials = 0, below = 0;
  for (const std::vector<double>& row : counts_) trials += trials_of(row);
  for (std::size_t j = 0; j < criteria_; ++j) {
    for (const std::vector<double>& row : counts_) below += row[j];
    place[j] = below <= 0.5 * trials ? normal_quantile(below / trials) : -normal_quantile((trials - below) / trials);
  }
  return place;
}

NewtonBox OrdinalProbit::box(double ln_sigma) const {
  NewtonBox box{std::vector<double>(size(), -kInf), std::vector<double>(size(), kInf)};
  box.lower.back() = box.upper.back() = ln_sigma;
  return box;
}

double OrdinalFit::error(std::size_t i) const {
  return std::sqrt(variance(i));
}

namespace {

// The inverse of the matrix restricted to what is free.
std::vector<double> inverse_of_free(const std::vector<double>& information, const NewtonBox& box) {
  const std::size_t k = box.lower.size();
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < k; ++i)
    if (box.lower[i] != box.upper[i]) free.push_back(i);
  std::vector<double> out(k * k, 0);
  const std::size_t m = free.size();
  for (std::size_t column = 0; column < m; ++column) {
    std::vector<double> a(m * m), b(m, 0);
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = 0; j < m; ++j) a[i * m + j] = information[free[i] * k + free[j]];
    b[column] = 1;
    if (!solve_positive_definite(a, b)) return std::vector<double>(k * k, kNaN);
    for (std::size_t i = 0; i < m; ++i) out[free[i] * k + free[column]] = b[i];
  }
  return out;
}

}  // namespace

OrdinalFit fit_ordinal(const OrdinalProbit& model, const NewtonBox& box, std::vector<double> start) {
  for (std::size_t i = 0; i < start.size(); ++i) start[i] = std::clamp(start[i], box.lower[i], box.upper[i]);
  const NewtonResult found = maximise_in_box(model, std::move(start), box);
  NewtonDerivatives at;
  model.derivatives(found.place, at);
  return {found.place, at.value, inverse_of_free(at.curvature, box)};
}

ScaledOrdinalFit fit_scaled_ordinal(const OrdinalProbit& model, const std::vector<double>& start) {
  constexpr int kSteps = 28;
  const double end = -std::log(kLeastSigma);
  NewtonResult best = maximise_in_box(model, start, model.box(start.back()));
  double at_ends = -kInf;
  for (const double sign : {-1.0, 1.0}) {
    std::vector<double> place = start;
    for (int i = 0; i <= kSteps; ++i) {
      const NewtonBox held = model.box(sign * end * i / kSteps);
      place.back() = held.lower.back();
      const NewtonResult found = maximise_in_box(model, place, held);
      place = found.place;
      if (found.value > best.value) best = found;
      if (i == kSteps) at_ends = std::fmax(at_ends, found.value);
    }
  }
  NewtonBox box = model.box();
  box.lower.back() = -end;
  box.upper.back() = end;
  ScaledOrdinalFit out{fit_ordinal(model, box, best.place), true};
  const double rounding = 1e-9 * (1 + std::abs(at_ends));
  out.bounded = at_ends < out.fit.log_likelihood - rounding;
  if (!out.bounded) out.fit.log_likelihood = std::fmax(out.fit.log_likelihood, at_ends);
  return out;
}

}  // namespace jnd
