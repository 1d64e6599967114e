#include "runner/precision/precision_json.h"

#include "runner/terminal/json_output.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(const std::optional<int>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json of_participant(const ParticipantPrecision& one) {
  Json out = {{"true_jnd", one.true_jnd}};
  out["any_extreme_rate"] = one.risks.any_extreme;
  out["any_dprime_not_positive"] = one.risks.any_not_positive;
  out["any_series_missing"] = one.risks.any_missing;
  out["method"] = to_string(one.method);
  out["replicates"] = one.replicates;
  out["status"] = {{"ok", one.status.ok},
                   {"no_sensitivity", one.status.no_sensitivity},
                   {"ceiling", one.status.ceiling},
                   {"no_information", one.status.no_information}};
  out["estimate"] = {{"q025", json_number(one.q025)},     {"q05", json_number(one.q05)},
                     {"median", json_number(one.median)}, {"q95", json_number(one.q95)},
                     {"q975", json_number(one.q975)},     {"mean", json_number(one.mean)}};
  out["median_se"] = json_number(one.median_se);
  out["share_se"] = json_number(one.share_se);
  out["bias_of_median"] = json_number(one.bias_of_median);
  out["bias_of_mean"] = json_number(one.bias_of_mean);
  out["outside_tested"] = one.outside_tested;
  out["cv"] = json_number(one.cv);
  out["spread"] = json_number(one.spread);
  out["trials_for_cv"] = number_or_null(one.proposed_trials);
  out["interval"] = {{"method", to_string(PrecisionMethod::simulation)},
                     {"replicates", one.interval_draws},
                     {"median_width", json_number(one.interval_width)},
                     {"median_width_se", json_number(one.interval_width_se)},
                     {"unbounded", one.interval_unbounded}};
  return out;
}

Json of_group(const GroupPrecision& one) {
  return {{"median", json_number(one.median)},
          {"q05", json_number(one.q05)},
          {"q95", json_number(one.q95)},
          {"ci_width", json_number(one.ci_width)},
          {"ci_width_se", json_number(one.ci_width_se)},
          {"without_interval", one.without_interval},
          {"with_undefined", one.with_undefined},
          {"mean_undefined", one.mean_undefined}};
}

Json of_contrast(const ContrastPrecision& one, const Protocol& protocol) {
  return {{"a", protocol.conditions[static_cast<std::size_t>(one.a)].name},
          {"b", protocol.conditions[static_cast<std::size_t>(one.b)].name},
          {"true_difference", one.true_difference},
          {"median", json_number(one.median)},
          {"ci_width", json_number(one.ci_width)},
          {"ci_width_se", json_number(one.ci_width_se)},
          {"power", one.power},
          {"power_se", one.power_se},
          {"power_of_slopes", one.power_of_slopes},
          {"power_of_slopes_se", one.power_of_slopes_se},
          {"without_interval", one.without_interval},
          {"with_undefined", one.with_undefined}};
}

}  // namespace

nlohmann::ordered_json precision_json(const PlannedPrecision& planned, const Protocol& protocol) {
  const Precision& precision = planned.precision;
  const PrecisionQuestion& question = precision.question;
  const std::string note = precision_note(protocol);
  Json out = {{"model", "yes-no"}, {"correction", to_string(question.design.correction)}, {"jnd", "least_squares"}};
  out["note"] = note.empty() ? Json(nullptr) : Json(note);
  out["criterion"] = "half of the difference";
  out["assumed"] = assumed_of_participants(question);
  out["unit"] = to_string(protocol.stimulus.unit);
  out["differences"] = question.design.differences;
  out["trials_per_cell"] = question.design.trials;
  out["sampling"] = to_string(question.design.class_sizes);
  out["participants"] = question.participants;
  out["between_cv"] = question.between_cv;
  out["wanted_cv"] = question.wanted_cv;
  out["seed"] = question.seed;
  out["conditions"] = Json::array();
  for (std::size_t i = 0; i < precision.participant.size(); ++i) {
    Json row = {{"condition", protocol.conditions[i].name}, {"jnd_source", to_string(planned.sources[i])}};
    row.update(of_participant(precision.participant[i]));
    out["conditions"].push_back(row);
  }
  Json group = {{"method", to_string(PrecisionMethod::simulation)}, {"replicates", question.experiments}};
  group["conditions"] = Json::array();
  for (std::size_t i = 0; i < precision.group.size(); ++i) {
    Json row = {{"condition", protocol.conditions[i].name}};
    row.update(of_group(precision.group[i]));
    group["conditions"].push_back(row);
  }
  group["contrasts"] = Json::array();
  for (const ContrastPrecision& contrast : precision.contrasts)
    group["contrasts"].push_back(of_contrast(contrast, protocol));
  out["group"] = group;
  return out;
}

}  // namespace jnd
