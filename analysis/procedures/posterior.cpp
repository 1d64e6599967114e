#include "analysis/procedures/posterior.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr double kScaledStandard = 900;  // that the numbers below are for

// from, from + step, ...
std::vector<double> even_grid(double from, double step, int size) {
  std::vector<double> grid;
  for (int i = 0; i < size; ++i) grid.push_back(from + i * step);
  return grid;
}

std::vector<double> logarithmic_grid(double low, double high, int size) {
  return even_grid(std::log(low), (std::log(high) - std::log(low)) / (size - 1), size);
}

}  // namespace

PosteriorConfiguration default_posterior(PosteriorTask task, double standard) {
  const double scale = standard / kScaledStandard;
  PosteriorConfiguration c;
  c.task = task;
  if (task == PosteriorTask::same_different) {
    c.ln_s = logarithmic_grid(60 * scale, 1200 * scale, 31);
    c.shift = even_grid(-0.5, 0.1875, 17);
    c.lapse = {0, 0.025, 0.05};
    c.ln_s_prior = {std::log(275 * scale), 0.7};
    c.shift_prior = {0.75, 0.75};
    c.lapse_weights = {0.5, 0.3, 0.2};
    return c;
  }
  c.standard = standard;
  c.ln_s = logarithmic_grid(40 * scale, 800 * scale, 30);
  c.shift = even_grid(-120 * scale, 20 * scale, 13);
  c.lapse = {0, 0.02, 0.06};
  c.ln_s_prior = {std::log(180 * scale), 0.8};
  c.shift_prior = {0, 60 * scale};
  c.lapse_weights = {0.5, 0.35, 0.15};
  return c;
}

namespace {

constexpr double kLeastProbability = 1e-9;
constexpr double kTie = 1e-12;

// The sum of a b. Four sums side by side, whatever the machine: they need not wait for one another.
double inner_product_of(const double* a, const double* b, std::size_t size) noexcept {
  double sums[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= size; i += 4)
    for (std::size_t lane = 0; lane < 4; ++lane) sums[lane] += a[i + lane] * b[i + lane];
  double rest = 0;
  for (; i < size; ++i) rest += a[i] * b[i];
  return (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest;
}

double binary_entropy(double p) noexcept {
  return -p * std::log(p) - (1 - p) * std::log1p(-p);
}

double gaussian_weight(double x, const PosteriorPrior& prior) noexcept {
  const double z = (x - prior.mean) / prior.sd;
  return std::exp(-z * z / 2);
}

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

bool distinct(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return std::adjacent_find(values.begin(), values.end()) == values.end();
}

double probability(PosteriorTask task, double standard, double level, double s, double shift, double lapse) noexcept {
  const double z = task == PosteriorTask::same_different ? level / s - shift : (level - standard - shift) / s;
  return std::clamp(lapse / 2 + (1 - lapse) * normal_cdf(z), kLeastProbability, 1 - kLeastProbability);
}

std::string problem_of_levels(const PosteriorConfiguration& c) {
  if (c.levels.size() < 2) return "a choice needs at least two levels";
  if (!all_finite(c.levels)) return "levels are finite numbers";
  if (!distinct(c.levels)) return "every level is given once";
  if (c.task == PosteriorTask::which) return std::isfinite(c.standard) ? "" : "the standard is a finite number";
  if (c.levels.front() != 0) return "the first level of same-different is 0: the same trial";
  if (std::any_of(c.levels.begin() + 1, c.levels.end(), [](double level) { return level <= 0; }))
    return "levels of same-different are differences above 0, behind the 0 of the same trial";
  return {};
}

std::string problem_of_prior(const PosteriorConfiguration& c) {
  for (const PosteriorPrior& prior : {c.ln_s_prior, c.shift_prior})
    if (!std::isfinite(prior.mean) || !std::isfinite(prior.sd) || !(prior.sd > 0))
      return "a prior has a finite mean and a standard deviation above 0";
  if (c.lapse_weights.size() != c.lapse.size()) return "there are as many weights as lapses";
  if (!all_finite(c.lapse_weights) ||
      std::any_of(c.lapse_weights.begin(), c.lapse_weights.end(), [](double weight) { return weight < 0; }) ||
      std::accumulate(c.lapse_weights.begin(), c.lapse_weights.end(), 0.0) <= 0)
    return "weights of lapses are 0 or more, and one of them is above 0";
  const auto mass = [](const std::vector<double>& grid, const PosteriorPrior& prior) {
    double sum = 0;
    for (const double x : grid) sum += gaussian_weight(x, prior);
    return sum;
  };
  if (!(mass(c.ln_s, c.ln_s_prior) > 1e-100) || !(mass(c.shift, c.shift_prior) > 1e-100))
    return "the prior is practically 0 everywhere on the grid: bring its mean onto the grid, or make it wider";
  return {};
}

}  // namespace

std::string problem_of(const PosteriorConfiguration& c) {
  if (std::string problem = problem_of_levels(c); !problem.empty()) return problem;
  if (c.ln_s.empty() || c.shift.empty() || c.lapse.empty()) return "the grid has at least one value of each";
  for (const std::vector<double>* grid : {&c.ln_s, &c.shift, &c.lapse})
    if (!all_finite(*grid) || !distinct(*grid)) return "the grid has finite numbers, each once";
  if (!std::is_sorted(c.ln_s.begin(), c.ln_s.end())) return "the grid of ln s ascends";
  if (std::abs(c.ln_s.front()) > 100 || std::abs(c.ln_s.back()) > 100)
    return "ln s is the natural logarithm of s: from -100 to 100";
  if (std::any_of(c.lapse.begin(), c.lapse.end(), [](double lapse) { return lapse < 0 || lapse >= 1; }))
    return "a lapse is a share from 0 to below 1";
  const double cells = static_cast<double>(c.levels.size()) * static_cast<double>(c.ln_s.size()) *
                       static_cast<double>(c.shift.size()) * static_cast<double>(c.lapse.size());
  if (cells > static_cast<double>(kMostPosteriorCells))
    return "levels times values of ln s, shift and lapse are more than 10 million: a coarser grid";
  return problem_of_prior(c);
}

std::optional<PosteriorSlot> posterior_slot_from(char letter, PosteriorTask task) noexcept {
  const bool which = task == PosteriorTask::which;
  switch (letter) {
    case 'F':
      return PosteriorSlot::free;
    case 'S':
      return which ? std::nullopt : std::optional(PosteriorSlot::same);
    case 'D':
      return which ? std::nullopt : std::optional(PosteriorSlot::different);
    case 'L':
      return which ? std::optional(PosteriorSlot::below) : std::nullopt;
    case 'U':
      return which ? std::optional(PosteriorSlot::above) : std::nullopt;
    case 'B':
      return which ? std::optional(PosteriorSlot::balanced) : std::nullopt;
    default:
      return std::nullopt;
  }
}

PosteriorProcedure::PosteriorProcedure(const PosteriorConfiguration& c)
    : task_(c.task),
      utility_(c.utility),
      standard_(c.standard),
      levels_(c.levels),
      ln_s_(c.ln_s),
      shift_(c.shift),
      lapse_(c.lapse),
      utilities_(c.levels.size()) {
  const double middle = ln_s_.front() + (ln_s_.back() - ln_s_.front()) / 2;
  for (const double ln_s : ln_s_) {
    centred_.push_back(ln_s - middle);
    for (const double shift : shift_)
      for (std::size_t i = 0; i < lapse_.size(); ++i)
        posterior_.push_back(gaussian_weight(ln_s, c.ln_s_prior) * gaussian_weight(shift, c.shift_prior) *
                             c.lapse_weights[i]);
  }
  const double total = std::accumulate(posterior_.begin(), posterior_.end(), 0.0);
  for (double& mass : posterior_) mass /= total;

  probabilities_.reserve(levels_.size() * posterior_.size());
  for (const double level : levels_)
    for (const double ln_s : ln_s_)
      for (const double shift : shift_)
        for (const double lapse : lapse_)
          probabilities_.push_back(probability(task_, standard_, level, std::exp(ln_s), shift, lapse));
  if (utility_ == PosteriorUtility::entropy) {
    entropies_.reserve(probabilities_.size());
    for (const double p : probabilities_) entropies_.push_back(binary_entropy(p));
  }
  remember_moments();
}

double PosteriorProcedure::row_mass(std::size_t row) const noexcept {
  const double* const begin = posterior_.data() + row * row_size();
  return std::accumulate(begin, begin + row_size(), 0.0);
}

void PosteriorProcedure::remember_moments() noexcept {
  first_ = second_ = 0;
  for (std::size_t row = 0; row < ln_s_.size(); ++row) {
    const double mass = row_mass(row);
    first_ += mass * centred_[row];
    second_ += mass * centred_[row] * centred_[row];
  }
}

double PosteriorProcedure::utility_of(std::size_t level) const noexcept {
  const std::size_t size = posterior_.size();
  const double* const p_of = probabilities_.data() + level * size;
  if (utility_ == PosteriorUtility::entropy) {
    const double p = inner_product_of(posterior_.data(), p_of, size);
    return binary_entropy(p) - inner_product_of(posterior_.data(), entropies_.data() + level * size, size);
  }
  double p = 0, m1 = 0;  // m1: sum of posterior P ln s; ln s is the same along a row
  for (std::size_t row = 0; row < ln_s_.size(); ++row) {
    const std::size_t begin = row * row_size();
    const double mass = inner_product_of(posterior_.data() + begin, p_of + begin, row_size());
    p += mass;
    m1 += mass * centred_[row];
  }
  const double m0 = first_ - m1;
  const double explained = m1 * m1 / p + m0 * m0 / (1 - p);  // neither p nor 1 - p is below 1e-9
  return task_ == PosteriorTask::which ? explained - first_ * first_ : explained - second_;
}

PosteriorSlot PosteriorProcedure::narrowed(PosteriorSlot slot) const noexcept {
  if (slot == PosteriorSlot::balanced) {
    if (2 * below_ > trials_ + 1) return PosteriorSlot::above;
    return 2 * below_ < trials_ - 1 ? PosteriorSlot::below : PosteriorSlot::free;
  }
  if (slot == PosteriorSlot::free && task_ == PosteriorTask::same_different) {
    if (same_ + 1 > (trials_ + 2) / 2) return PosteriorSlot::different;  // ceil((t+1)/2)
    return same_ < (trials_ + 1) / 3 ? PosteriorSlot::same : PosteriorSlot::free;
  }
  return slot;
}

bool PosteriorProcedure::allowed(std::size_t level, PosteriorSlot slot) const noexcept {
  switch (slot) {
    case PosteriorSlot::same:
      return level == 0;
    case PosteriorSlot::different:
      return level > 0;
    case PosteriorSlot::below:
      return levels_[level] < standard_;
    case PosteriorSlot::above:
      return levels_[level] > standard_;
    default:
      return true;
  }
}

PosteriorChoice PosteriorProcedure::choose(PosteriorSlot slot) noexcept {
  if (slot == PosteriorSlot::same) return {0, kNaN};
  const PosteriorSlot narrow = narrowed(slot);
  double best = -kInf;
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    if (!allowed(level, narrow)) continue;
    utilities_[level] = utility_of(level);
    best = std::max(best, utilities_[level]);
  }
  for (std::size_t level = 0; level < levels_.size(); ++level)
    if (allowed(level, narrow) && utilities_[level] >= best - kTie) return {level, utilities_[level]};
  return {0, kNaN};  // no level in the slot: see the constructor's and choose's conditions
}

void PosteriorProcedure::update(std::size_t level, bool positive) noexcept {
  const double* const p_of = probabilities_.data() + level * posterior_.size();
  double total = 0;
  for (std::size_t i = 0; i < posterior_.size(); ++i) {
    posterior_[i] *= positive ? p_of[i] : 1 - p_of[i];
    total += posterior_[i];
  }
  for (double& mass : posterior_) mass /= total;  // above 1e-9, as every probability is
  ++trials_;
  if (task_ == PosteriorTask::same_different && levels_[level] == 0) ++same_;
  if (task_ == PosteriorTask::which && levels_[level] < standard_) ++below_;
  remember_moments();
}

PosteriorEstimate PosteriorProcedure::estimate() const noexcept {
  PosteriorEstimate of;
  const auto each = [&](auto what) {
    std::size_t i = 0;
    for (const double ln_s : ln_s_)
      for (const double shift : shift_)
        for (const double lapse : lapse_) what(posterior_[i++], ln_s, shift, lapse);
  };
  each([&](double mass, double ln_s, double shift, double lapse) {
    of.mean_ln_s += mass * ln_s;
    of.mean_shift += mass * shift;
    of.mean_lapse += mass * lapse;
  });
  each([&](double mass, double ln_s, double shift, double lapse) {
    of.sd_ln_s += mass * (ln_s - of.mean_ln_s) * (ln_s - of.mean_ln_s);
    of.sd_shift += mass * (shift - of.mean_shift) * (shift - of.mean_shift);
    of.sd_lapse += mass * (lapse - of.mean_lapse) * (lapse - of.mean_lapse);
  });
  of.sd_ln_s = std::sqrt(of.sd_ln_s);
  of.sd_shift = std::sqrt(of.sd_shift);
  of.sd_lapse = std::sqrt(of.sd_lapse);
  return of;
}

void PosteriorProcedure::ln_s_masses(std::vector<double>& masses) const {
  masses.resize(ln_s_.size());
  for (std::size_t row = 0; row < masses.size(); ++row) masses[row] = row_mass(row);
}

double PosteriorProcedure::ln_s_quantile(double share) const noexcept {
  double below = 0;
  for (std::size_t row = 0; row < ln_s_.size(); ++row) {
    const double mass = row_mass(row);
    if (below + mass < share && row + 1 < ln_s_.size()) {
      below += mass;
      continue;
    }
    const double from = row > 0 ? (ln_s_[row - 1] + ln_s_[row]) / 2 : ln_s_[row];
    const double to = row + 1 < ln_s_.size() ? (ln_s_[row] + ln_s_[row + 1]) / 2 : ln_s_[row];
    return mass > 0 ? from + (to - from) * std::clamp((share - below) / mass, 0.0, 1.0) : from;
  }
  return ln_s_.back();
}

}  // namespace jnd
