// `jnd calc fit --json`.
#include <nlohmann/json.hpp>

#include "runner/calc/calc_psychometric.h"
#include "runner/terminal/json_output.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;

ordered_json bounds_json(const ConfidenceBounds& bounds) {
  return ordered_json::array({json_number(bounds.low), json_number(bounds.high)});
}

// The parameters in their order: the two of the function, then the rates that are free.
template <typename Entry>
ordered_json parameters_json(const PsychometricFit& fit, Entry entry) {
  const auto [location, second] = parameter_names(fit.model.function);
  ordered_json out = ordered_json::object();
  out[std::string(location)] = entry(fit.location);
  out[std::string(second)] = entry(fit.second);
  if (!fit.model.lapse) out["lapse"] = entry(fit.lapse);
  if (!fit.model.guess) out["guess"] = entry(fit.guess);
  return out;
}

ordered_json bootstrap_json(const PsychometricBootstrap& bootstrap) {
  return {{"replicates", bootstrap.replicates},
          {"estimates", bootstrap.estimates},
          {"separated", bootstrap.separated},
          {"not_increasing", bootstrap.not_increasing},
          {"others", bootstrap.others},
          {"with_pse", bootstrap.with_pse},
          {"deviance_p", json_number(bootstrap.deviance_p)}};
}

}  // namespace

ordered_json psychometric_json(const PsychometricAnswer& answer) {
  const PsychometricFit& fit = answer.fit;
  const PsychometricIntervals& intervals = answer.intervals;
  ordered_json out;
  out["group"] = answer.group ? ordered_json(*answer.group) : ordered_json(nullptr);
  out["function"] = to_string(fit.model.function);
  out["estimator"] = to_string(fit.model.estimator);
  out["parameters"] = parameters_json(fit, [](const PsychometricEstimate& one) { return json_number(one.value); });
  out["se"] = parameters_json(fit, [](const PsychometricEstimate& one) { return json_number(one.se); });
  // A fixed rate is known, whatever the data.
  out["guess"] = json_number(fit.model.guess.value_or(fit.guess.value));
  out["lapse"] = json_number(fit.model.lapse.value_or(fit.lapse.value));
  out["log_likelihood"] = json_number(fit.log_likelihood);
  out["deviance"] = json_number(fit.deviance);
  out["degrees_of_freedom"] = fit.degrees_of_freedom;
  out["deviance_p"] = json_number(fit.deviance_p);
  out["pse"] = json_number(fit.pse.value);
  out["jnd"] = json_number(fit.jnd.value);
  out["slope"] = json_number(fit.slope.value);
  out["se_pse"] = json_number(fit.pse.se);
  out["se_jnd"] = json_number(fit.jnd.se);
  out["se_slope"] = json_number(fit.slope.se);
  const auto [location, second] = parameter_names(fit.model.function);
  ordered_json ci = {{"pse", bounds_json(intervals.pse)},
                     {"jnd", bounds_json(intervals.jnd)},
                     {"slope", bounds_json(intervals.slope)}};
  ci[std::string(location)] = bounds_json(intervals.location);
  ci[std::string(second)] = bounds_json(intervals.second);
  if (!fit.model.lapse) ci["lapse"] = bounds_json(intervals.lapse);
  if (!fit.model.guess) ci["guess"] = bounds_json(intervals.guess);
  out["ci"] = ci;
  out["interval"] = answer.bootstrap ? "bootstrap" : "profile";
  out["confidence"] = intervals.confidence;
  if (answer.bootstrap) out["bootstrap"] = bootstrap_json(*answer.bootstrap);
  out["levels"] = fit.levels;
  out["trials"] = fit.trials;
  out["status"] = to_string(fit.status);
  return out;
}

ordered_json psychometric_json(const PsychometricComparison& comparison) {
  ordered_json models = ordered_json::array(), tests = ordered_json::array();
  for (const SharingFit& fit : comparison.fits)
    models.push_back({{"model", to_string(fit.sharing)},
                      {"parameters", fit.parameters},
                      {"log_likelihood", json_number(fit.log_likelihood)},
                      {"lapse", json_number(fit.lapse)},
                      {"guess", json_number(fit.guess)},
                      {"status", to_string(fit.status)}});
  for (const SharingTest& test : comparison.tests)
    tests.push_back({{"simpler", to_string(test.simpler)},
                     {"general", to_string(test.general)},
                     {"chi2", json_number(test.chi_square)},
                     {"df", test.df},
                     {"p", json_number(test.p)},
                     {"status", to_string(test.status)}});
  return {{"comparison", {{"groups", comparison.groups}, {"models", models}, {"tests", tests}}}};
}

}  // namespace jnd
