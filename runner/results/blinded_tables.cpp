// The results of a blinded study as tables, JSON and columns of CSV files.
#include <cmath>

#include <fmt/format.h>

#include "runner/results/blinded_results.h"
#include "runner/results/result_format.h"
#include "runner/terminal/json_output.h"

namespace jnd {

namespace {

std::string measure_of(const Protocol& protocol) {
  return protocol.design.procedure ? "threshold" : "JND";
}

ResultTable participants_table(const BlindedResults& results) {
  ResultTable table{"monitoring",
                    "Participants",
                    "pooled over conditions and stimuli; how often a participant is right is not shown",
                    {{"participant"},
                     {"state"},
                     {"sessions", true},
                     {"trials", true},
                     {"voided", true},
                     {"device faults", true},
                     {"said different", true},
                     {"median response s", true},
                     {"s a trial", true}},
                    {},
                    {}};
  for (const BlindedParticipant& row : results.participants)
    table.rows.push_back({row.participant, row.state, std::to_string(row.sessions),
                          fmt::format("{} of {}", row.trials_done, row.trials_total), std::to_string(row.trials_voided),
                          std::to_string(row.device_faults), percent_text(row.said_different),
                          number_text(row.median_response_time_s, 2), number_text(row.mean_trial_s, 1)});
  return table;
}

ResultTable group_table(const BlindedResults& results, const Protocol& protocol) {
  ResultTable table{"group",
                    "Group by coded condition",
                    fmt::format("the letters of the operator's console; a mean stands from {} participants on, so that "
                                "it is nobody's own",
                                kFewestTogether),
                    {{"condition"},
                     {"n used", true},
                     {fmt::format("mean {} {}", measure_of(protocol), unit_of(protocol)), true},
                     {"95 % CI", true}},
                    {},
                    {}};
  for (const BlindedGroup& row : results.groups)
    table.rows.push_back({row.code, fmt::format("{} of {}", row.n, row.of), stiffness_text(row.mean, protocol),
                          range_text(row.ci_low, row.ci_high, stiffness_decimals(protocol))});
  return table;
}

}  // namespace

std::vector<ResultTable> blinded_tables(const BlindedResults& results, const Protocol& protocol) {
  std::vector<ResultTable> tables;
  if (!results.participants.empty()) tables.push_back(participants_table(results));
  if (!results.groups.empty()) tables.push_back(group_table(results, protocol));
  return tables;
}

nlohmann::ordered_json to_json(const BlindingState& state) {
  return {{"blinded", state.blinded},
          {"participants_planned", state.planned},
          {"participants_finished", state.finished},
          {"sessions_open", state.unfinished}};
}

nlohmann::ordered_json to_json(const BlindedResults& results, const Protocol& protocol) {
  nlohmann::ordered_json out = {{"kind", "real"}, {"blinding", to_json(results.state)}};
  out["blinding"]["why"] = results.line;
  out["protocol_sha256"] = protocol.sha256;
  out["events_verified"] = results.chains.events;
  out["study_head"] = results.chains.study_head;
  out["participants"] = nlohmann::ordered_json::array();
  for (const BlindedParticipant& row : results.participants)
    out["participants"].push_back({{"participant", row.participant},
                                   {"state", row.state},
                                   {"sessions", row.sessions},
                                   {"trials_done", row.trials_done},
                                   {"trials_total", row.trials_total},
                                   {"trials_voided", row.trials_voided},
                                   {"device_faults", row.device_faults},
                                   {"said_different", json_number(row.said_different)},
                                   {"median_response_time_s", json_number(row.median_response_time_s)},
                                   {"mean_trial_s", json_number(row.mean_trial_s)}});
  out["group"] = nlohmann::ordered_json::array();
  for (const BlindedGroup& row : results.groups)
    out["group"].push_back({{"code", row.code},
                            {"n", row.n},
                            {"of", row.of},
                            {"mean", json_number(row.mean)},
                            {"ci_low", json_number(row.ci_low)},
                            {"ci_high", json_number(row.ci_high)},
                            {"unit", unit_of(protocol)},
                            {"status", std::isnan(row.mean) ? "too_few_participants" : "ok"}});
  return out;
}

std::vector<CsvColumn<BlindedParticipant>> blinded_participant_columns() {
  using R = BlindedParticipant;
  return {{"participant", "code of the participant", "", "", [](const R& r) { return csv_text(r.participant); }},
          {"state", "how far the participant is", "", "finished \"not finished\" \"ended early\" excluded",
           [](const R& r) { return r.state; }},
          {"sessions", "sessions begun", "", "", [](const R& r) { return csv_number(r.sessions); }},
          {"trials_done", "main trials answered", "", "", [](const R& r) { return csv_number(r.trials_done); }},
          {"trials_total", "main trials planned", "", "", [](const R& r) { return csv_number(r.trials_total); }},
          {"trials_voided", "attempts voided, practice included", "", "",
           [](const R& r) { return csv_number(r.trials_voided); }},
          {"device_faults", "presentations that a fault stopped", "", "",
           [](const R& r) { return csv_number(r.device_faults); }},
          {"said_different", "share of answers \"different\", over all stimuli", "", "",
           [](const R& r) { return csv_number(r.said_different); }},
          {"median_response_time_s", "median response time of the participant's own entries", "s", "",
           [](const R& r) { return csv_number(r.median_response_time_s); }},
          {"mean_trial_s", "mean time per trial", "s", "", [](const R& r) { return csv_number(r.mean_trial_s); }}};
}

std::vector<CsvColumn<BlindedGroup>> blinded_group_columns(const Protocol& protocol) {
  using R = BlindedGroup;
  const std::string unit(unit_of(protocol));
  const std::string what = measure_of(protocol);
  return {{"condition_code", "letter of the condition on the operator's console", "", "",
           [](const R& r) { return r.code; }},
          {"n", "participants with a " + what, "", "", [](const R& r) { return csv_number(r.n); }},
          {"of", "participants with data", "", "", [](const R& r) { return csv_number(r.of); }},
          {"mean", fmt::format("mean {}; empty below {} participants", what, kFewestTogether), unit, "",
           [](const R& r) { return csv_number(r.mean); }},
          {"ci_low", "lower end of its 95 % confidence interval", unit, "",
           [](const R& r) { return csv_number(r.ci_low); }},
          {"ci_high", "upper end of its 95 % confidence interval", unit, "",
           [](const R& r) { return csv_number(r.ci_high); }}};
}

}  // namespace jnd
