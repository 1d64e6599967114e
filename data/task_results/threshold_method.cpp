#include "data/task_results/threshold_method.h"

#include <algorithm>

#include <fmt/format.h>

#include "data/log/storage_error.h"

namespace jnd {

namespace {

std::optional<JndMethod> method_of(const AnalysisPlan& plan) {
  const bool ml = plan.jnd_method == "ml";
  if (plan.model == "yes-no") {
    if (!ml) return jnd_method_from(plan.jnd_method);
    return plan.common_criterion ? JndMethod::ml_yes_no_common : JndMethod::ml_yes_no_series;
  }
  if (plan.model == "differencing" && ml)
    return plan.common_criterion ? JndMethod::ml_differencing_common : JndMethod::ml_differencing_series;
  if (plan.model == "independent-observation" && plan.jnd_method == "least_squares")
    return JndMethod::least_squares_independent;
  return std::nullopt;
}

}  // namespace

ThresholdMethod registered_method(const Protocol& protocol) {
  const AnalysisPlan& plan = protocol.analysis;
  const std::optional<Correction> correction = correction_from(plan.correction);
  if (!correction)
    throw StorageError(fmt::format("protocol {}: unknown correction \"{}\"", protocol.name, plan.correction));
  const std::optional<JndMethod> method = method_of(plan);
  if (!method)
    throw StorageError(fmt::format("protocol {}: unknown analysis \"{}\" of the {} model", protocol.name,
                                   plan.jnd_method, plan.model));
  return {plan.model, is_maximum_likelihood(*method) ? Correction::none : *correction, *method};
}

std::vector<ThresholdMethod> all_methods(const ThresholdMethod& registered) {
  std::vector<ThresholdMethod> methods = {registered};
  const auto add = [&](const char* model, Correction correction, JndMethod method) {
    const ThresholdMethod one{model, correction, method};
    if (std::find(methods.begin(), methods.end(), one) == methods.end()) methods.push_back(one);
  };
  for (const Correction correction : {Correction::loglinear, Correction::half, Correction::none})
    add("yes-no", correction, JndMethod::least_squares);
  add("yes-no", Correction::loglinear, JndMethod::weighted);
  add("yes-no", Correction::loglinear, JndMethod::inverse_mean_slope);
  add("yes-no", Correction::loglinear, JndMethod::mean_of_ratios);
  add("yes-no", Correction::none, JndMethod::ml_yes_no_series);
  add("yes-no", Correction::none, JndMethod::ml_yes_no_common);
  add("differencing", Correction::none, JndMethod::ml_differencing_series);
  add("differencing", Correction::none, JndMethod::ml_differencing_common);
  add("independent-observation", Correction::loglinear, JndMethod::least_squares_independent);
  return methods;
}

std::string describe(const ThresholdMethod& method) {
  if (is_maximum_likelihood(method.method))
    return fmt::format("{} model, {} on raw counts", method.model, to_string(method.method));
  return fmt::format("{} d' of {} rates, {}", method.model,
                     method.correction == Correction::none ? "raw" : to_string(method.correction),
                     to_string(method.method));
}

}  // namespace jnd
