#include "analysis/hierarchical/model_variants.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

ModelVariant variant_of(VariantKind kind, std::vector<HierarchicalCell> cells, HierarchicalModel model,
                        const SharedForm& estimated, VariantWork& work) {
  ModelVariant variant;
  variant.kind = kind;
  model.estimated = estimated;
  const auto without_estimates = [&](SharedStatus status) {
    for (const SharedParameter which : kSharedParameters) {
      if (!estimated.has(which)) continue;
      SharedEstimate& one = variant.shared.emplace_back();
      one.parameter = which;
      one.status = status;
    }
    return variant;
  };
  if (!estimated.identified(cells).any()) return without_estimates(SharedStatus::not_identified);
  if (work.left < work.of_each) return without_estimates(SharedStatus::out_of_work);
  HierarchicalAnalysis analysis(std::move(cells), model);
  work.left -= analysis.work();
  if (!analysis.fit().maximum.converged) return without_estimates(SharedStatus::not_converged);
  const double most_work = analysis.work() + std::max(0.0, work.left);
  const HierarchicalFit& fit = analysis.complete({.shared = true, .most_work = most_work});
  const bool bounded = std::all_of(fit.shared_estimates.begin(), fit.shared_estimates.end(),
                                   [](const SharedEstimate& one) { return !std::isinf(one.ends.high); });
  if (kind != VariantKind::lapse && bounded) analysis.complete({.intervals = true, .most_work = most_work});
  work.left = most_work - analysis.work();
  variant.shared = fit.shared_estimates;
  variant.conditions = fit.conditions;
  return variant;
}

bool whole(double count) {
  return count == std::floor(count);
}

}  // namespace

std::string_view title_of(SharedParameter parameter, bool choice) noexcept {
  switch (parameter) {
    case SharedParameter::lapse:
      return "share of trials answered by chance";
    case SharedParameter::overdispersion:
      return "correlation of answers at one level";
    case SharedParameter::drift_ln_s:
      return "ln JND, second half less first";
    case SharedParameter::sure_below:
      return "same, sure: below";
    case SharedParameter::sure_above:
      return "different, sure: above";
    case SharedParameter::drift_criterion:
      break;
  }
  return choice ? "PSE, second half less first" : "criterion, second half less first";
}

std::vector<HierarchicalCell> without_halves_and_sureness(std::span<const HierarchicalCell> cells) {
  std::vector<HierarchicalCell> plain(cells.begin(), cells.end());
  for (HierarchicalCell& cell : plain) {
    cell.second_half = false;
    cell.sure_positive = cell.sure_negative = 0;
  }
  return plain;
}

std::vector<ModelVariant> model_variants(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                                         VariantWork work) {
  const std::vector<HierarchicalCell> plain = without_halves_and_sureness(cells);
  std::vector<HierarchicalCell> halves(cells.begin(), cells.end()), graded = plain;
  bool sure = false;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    halves[i].sure_positive = halves[i].sure_negative = 0;
    graded[i].sure_positive = cells[i].sure_positive;
    graded[i].sure_negative = cells[i].sure_negative;
    sure = sure || cells[i].sure_positive > 0 || cells[i].sure_negative > 0;
  }
  std::vector<ModelVariant> variants;
  // First, since it takes least and a caution rests on it.
  ModelVariant lapse = variant_of(VariantKind::lapse, plain, model, SharedForm().with(SharedParameter::lapse), work);
  if (std::all_of(plain.begin(), plain.end(),
                  [](const HierarchicalCell& cell) { return whole(cell.positive) && whole(cell.negative); }))
    variants.push_back(variant_of(VariantKind::overdispersion, plain, model,
                                  SharedForm().with(SharedParameter::overdispersion), work));
  variants.push_back(variant_of(
      VariantKind::drift, std::move(halves), model,
      SharedForm().with(SharedParameter::drift_ln_s).with(SharedParameter::drift_criterion, model.tw), work));
  variants.push_back(std::move(lapse));
  if (sure)
    variants.push_back(variant_of(VariantKind::sureness, std::move(graded), model,
                                  SharedForm().with(SharedParameter::sure_below).with(SharedParameter::sure_above),
                                  work));
  return variants;
}

SharedEstimate lapses_beside(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                             const HierarchicalPlace& near) {
  HierarchicalModel with = model;
  with.estimated = with.estimated.with(SharedParameter::lapse);
  SharedEstimate found{.parameter = SharedParameter::lapse, .status = SharedStatus::not_identified, .ends = {}};
  if (model.estimated.has(SharedParameter::lapse) || !with.estimated.identified(cells).has(SharedParameter::lapse))
    return found;
  const auto fit_of = [&](const HierarchicalModel& of) {
    return HierarchicalAnalysis({cells.begin(), cells.end()}, of, SearchEffort::drawn, &near).fit();
  };
  const HierarchicalFit more = fit_of(with), held = fit_of(model);
  found.status = SharedStatus::ok;
  found.value = more.maximum.shared.lapse;
  found.lr = std::max(0.0, 2 * (more.maximum.log_likelihood - held.maximum.log_likelihood));
  found.p = found.value > model.shared.lapse ? chi2_upper(found.lr, 1) / 2 : 1;
  return found;
}

}  // namespace jnd
