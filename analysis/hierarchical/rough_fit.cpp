#include "analysis/hierarchical/rough_fit.h"

#include <algorithm>
#include <cmath>

#include "analysis/hierarchical/hierarchical_information.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

RoughFit rough_fit(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                   const HierarchicalPlace& near, std::span<const std::array<int, 2>> contrasts) {
  const std::size_t conditions = near.mu.size(), stride = 2 * conditions;
  const SearchRange range = search_range(cells, model.response);
  HierarchicalForm form = HierarchicalForm::separate(conditions);
  const bool several =
      std::any_of(cells.begin(), cells.end(), [](const HierarchicalCell& cell) { return cell.participant > 0; });
  form.tu = model.tu && several;
  form.tv = model.tv && several && conditions > 1;
  form.tw = model.tw && several;
  form.rho = model.rho && form.tu && form.tw;
  form.lowest = range.lowest();
  form.highest = range.highest();
  HierarchicalPlace start = near;
  for (double& mu : start.mu) mu = std::clamp(mu, form.lowest, form.highest);
  if (!form.tu) start.tu = 0;
  if (!form.tv) start.tv = 0;
  if (!form.tw) start.tw = 0;
  if (!form.rho) start.rho = 0;
  HierarchicalLikelihood likelihood(cells, model.response, model.shared, kRoughFineness);
  const HierarchicalMaximum best = maximise(likelihood, form, start, range.criterion_unit, kRoughlyNegligible);
  const std::vector<double> covariance = covariance_of_estimates(likelihood.cell_information(best.place), best.place);
  RoughFit fit;
  for (std::size_t c = 0; c < conditions; ++c) {
    RoughMean& one = fit.means.emplace_back();
    const double mu = best.place.mu[c];
    if (!best.converged)
      one.status = SlopeStatus::missing;
    else if (mu > range.greatest)
      one.status = SlopeStatus::no_sensitivity;
    else if (mu < range.least)
      one.status = SlopeStatus::ceiling;
    if (one.status != SlopeStatus::ok) continue;
    one.mu = mu;
    one.error = std::sqrt(covariance[c * stride + c]);
  }
  for (const auto& [first, second] : contrasts) {
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    RoughDifference& one = fit.differences.emplace_back();
    one.difference = fit.means[a].mu - fit.means[b].mu;
    const double variance =
        std::max(0.0, covariance[a * stride + a] + covariance[b * stride + b] - 2 * covariance[a * stride + b]);
    if (!std::isnan(one.difference)) one.error = std::sqrt(variance);
    // Where the means would be equal if ln L were a parabola: a step from there the search is at its end.
    HierarchicalPlace start_equal = best.place;
    if (variance > 0) {
      const double step = (best.place.mu[a] - best.place.mu[b]) / variance;
      for (std::size_t c = 0; c < conditions; ++c) {
        const auto along = [&](std::size_t row) { return covariance[row * stride + a] - covariance[row * stride + b]; };
        start_equal.mu[c] -= step * along(c);
        start_equal.kappa[c] -= step * along(conditions + c);
      }
    }
    const HierarchicalForm equal = form.with_difference(a, b, 0);
    // Only its ln L counts, which is known to a hundredth where the place is not yet.
    constexpr double kNegligibleForTest = 0.02;
    const HierarchicalMaximum without =
        maximise(likelihood, equal, start_equal, range.criterion_unit, kNegligibleForTest);
    if (best.converged && without.converged)
      one.p = chi2_upper(std::max(0.0, 2 * (best.log_likelihood - without.log_likelihood)), 1);
  }
  return fit;
}

}  // namespace jnd
