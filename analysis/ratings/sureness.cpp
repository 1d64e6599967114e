#include "analysis/ratings/sureness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"
#include "analysis/numerics/words.h"
#include "analysis/ratings/ordinal_probit.h"

namespace jnd {

namespace {

constexpr auto kSurenessStatusWords = words<SurenessStatus>({{"ok", SurenessStatus::ok},
                                                             {"flat", SurenessStatus::flat},
                                                             {"separated", SurenessStatus::separated},
                                                             {"not_identified", SurenessStatus::not_identified},
                                                             {"no_information", SurenessStatus::no_information},
                                                             {"missing", SurenessStatus::missing}});

// The deltas that have trials, in order, each once.
struct DistinctLevels {
  std::vector<double> deltas;
  CategoryCounts counts;
};

DistinctLevels distinct_levels(const std::vector<SurenessLevel>& levels) {
  std::map<double, std::vector<double>> sums;
  for (const SurenessLevel& level : levels) {
    if (std::all_of(level.counts.begin(), level.counts.end(), [](int n) { return n <= 0; })) continue;
    std::vector<double>& sum = sums[level.delta + 0.0];  // -0 is 0
    sum.resize(level.counts.size(), 0);
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += level.counts[j];
  }
  DistinctLevels out;
  for (auto& [delta, counts] : sums) {
    out.deltas.push_back(delta);
    out.counts.push_back(std::move(counts));
  }
  return out;
}

// The model in a covariate of its own: u = (delta - middle) / range, from -1/2 to 1/2, so that levels far from 0 and
// close together are no harder than others. slope = range / sigma.
class SurenessModel {
 public:
  SurenessModel(const std::vector<double>& deltas, const CategoryCounts& counts)
      : middle_(0.5 * deltas.front() + 0.5 * deltas.back()),
        range_(deltas.back() - deltas.front()),
        model_(counts, design(deltas)) {}

  const OrdinalProbit& model() const { return model_; }
  double range() const { return range_; }

  // Everything but the slope at its best for the slope.
  OrdinalFit at_slope(double slope, std::vector<double> start) const {
    NewtonBox box = model_.box();
    const std::size_t effect = model_.criteria();
    box.lower[effect] = box.upper[effect] = slope;
    return fit_ordinal(model_, box, std::move(start));
  }

  // c of the model in delta itself.
  std::vector<double> criteria(const OrdinalFit& fit) const {
    std::vector<double> out;
    const double shift = fit.place[model_.criteria()] * (middle_ / range_);
    for (std::size_t j = 0; j < model_.criteria(); ++j) out.push_back(fit.place[j] + shift);
    return out;
  }

 private:
  std::vector<std::vector<double>> design(const std::vector<double>& deltas) const {
    std::vector<std::vector<double>> rows;
    for (const double delta : deltas) rows.push_back({(delta - middle_) / range_});
    return rows;
  }
  double middle_, range_;
  OrdinalProbit model_;
};

// The likelihood maximised over the criteria at each slope.
class SlopeProfile {
 public:
  SlopeProfile(const SurenessModel& model, double maximum, std::vector<double> start)
      : model_(model), maximum_(maximum), place_(std::move(start)) {}
  ProfilePoint operator()(double slope) {
    const OrdinalFit fit = model_.at_slope(slope, place_);
    place_ = fit.place;
    NewtonDerivatives at;
    model_.model().derivatives(fit.place, at);
    return {maximum_ - fit.log_likelihood, -at.gradient[model_.model().criteria()]};
  }

 private:
  const SurenessModel& model_;
  double maximum_;
  std::vector<double> place_;
};

// slope: the estimate, 0 or inf at a boundary; error: a first guess of its standard error.
void set_sigma_interval(Sureness& out, const SurenessModel& model, double slope, double error,
                        const OrdinalFit& at_zero) {
  SlopeProfile profile(model, out.log_likelihood, at_zero.place);
  const double middle = std::isfinite(slope) ? slope : 4;
  double low = 0, high = kInf;
  if (slope > 0 && out.log_likelihood - at_zero.log_likelihood > kProfileDrop)
    low = profile_bound(profile, slope, 0, std::fmax(middle - 2 * error, 0.5 * middle));
  if (std::isfinite(slope)) high = profile_bound(profile, slope, kInf, middle + 2 * error);
  out.sigma_low = std::isfinite(high) ? model.range() / high : 0;
  out.sigma_high = low > 0 ? model.range() / low : kInf;
}

Sureness undefined_sureness(SurenessStatus status) {
  Sureness out;
  out.status = status;
  out.log_likelihood_saturated = out.log_likelihood = out.sigma = out.ln_sigma_se = out.deviance = kNaN;
  out.sigma_low = out.sigma_high = out.lr_zero_slope = out.p_zero_slope = kNaN;
  return out;
}

// What bounds the slope: at least two deltas, and at least two categories in use.
Sureness estimate_sureness(const DistinctLevels& levels) {
  Sureness out = undefined_sureness(SurenessStatus::ok);
  const SurenessModel model(levels.deltas, levels.counts);
  const std::size_t effect = model.model().criteria();
  out.log_likelihood_saturated = saturated_log_likelihood(levels.counts);
  const OrdinalFit at_zero = model.at_slope(0, model.model().start());
  NewtonDerivatives slopes;
  model.model().derivatives(at_zero.place, slopes);
  double slope = 0, error = 1;
  if (slopes.gradient[effect] <= 1e-12 * (1 + std::abs(at_zero.log_likelihood))) {
    out.status = SurenessStatus::flat;
    out.log_likelihood = at_zero.log_likelihood;
    out.sigma = kInf;
    out.criteria = model.criteria(at_zero);
    error = 1 / std::sqrt(slopes.expected[effect * model.model().size() + effect]);
  } else if (recedes(levels.counts, levels.deltas)) {
    out.status = SurenessStatus::separated;
    out.log_likelihood = out.log_likelihood_saturated;
    out.sigma = 0;
    slope = kInf;
  } else {
    const OrdinalFit fit = fit_ordinal(model.model(), model.model().box(), at_zero.place);
    slope = fit.place[effect];
    error = fit.error(effect);
    out.log_likelihood = fit.log_likelihood;
    out.sigma = model.range() / slope;
    out.criteria = model.criteria(fit);
    out.ln_sigma_se = error / slope;
  }
  out.deviance = std::fmax(0, 2 * (out.log_likelihood_saturated - out.log_likelihood));
  out.lr_zero_slope = std::fmax(0, 2 * (out.log_likelihood - at_zero.log_likelihood));
  out.p_zero_slope = chi2_upper(out.lr_zero_slope, 1);
  set_sigma_interval(out, model, slope, error, at_zero);
  return out;
}

}  // namespace

std::string_view to_string(SurenessStatus status) noexcept {
  return word_of(kSurenessStatusWords, status);
}

Sureness sureness(const std::vector<SurenessLevel>& levels) {
  DistinctLevels distinct = distinct_levels(levels);
  UsedCategories used = used_categories(distinct.counts);
  distinct.counts = std::move(used.counts);
  Sureness out;
  if (distinct.deltas.empty())
    out = undefined_sureness(SurenessStatus::missing);
  else if (used.used.size() < 2)
    out = undefined_sureness(SurenessStatus::no_information);
  else if (distinct.deltas.size() < 2)
    out = undefined_sureness(SurenessStatus::not_identified);
  else
    out = estimate_sureness(distinct);
  for (const int category : used.used) out.categories_used.push_back(category + 1);
  return out;
}

}  // namespace jnd
