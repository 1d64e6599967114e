// The results of a blinded study as tables, JSON and the fields of both.
#include <cmath>

#include <fmt/format.h>

#include "runner/results/blinded_results.h"
#include "runner/results/field_output.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

ResultTable participants_table(const BlindedResults& results) {
  const TableMaker of(blinded_participant_fields());
  return of({"monitoring",
             "Participants",
             "pooled over conditions and stimuli; how often a participant is right is not shown",
             {},
             {},
             {}},
            {of("participant"), of("state"), of("sessions"), of.share("trials_done", "trials_total", "trials"),
             of("trials_voided"), of("device_faults"), of("said_different"), of("median_response_time_s"),
             of("mean_trial_s")},
            results.participants);
}

ResultTable group_table(const BlindedResults& results, const Protocol& protocol) {
  const TableMaker of(blinded_group_fields(protocol));
  return of({"group",
             "Group by coded condition",
             fmt::format("the letters of the operator's console; a mean stands from {} participants on, so that "
                         "it is nobody's own",
                         kFewestTogether),
             {},
             {},
             {}},
            {of("code"), of.share("n", "of", "n used"), of("mean"), of.range("ci_low", "ci_high")}, results.groups);
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
  nlohmann::ordered_json out = {{"kind", to_string(results.kind)}, {"blinding", to_json(results.state)}};
  out["blinding"]["why"] = results.line;
  out["protocol_sha256"] = protocol.sha256;
  out["events_verified"] = results.chains.events;
  out["study_head"] = results.chains.study_head;
  const auto participants = blinded_participant_fields();
  const auto groups = blinded_group_fields(protocol);
  out["participants"] = nlohmann::ordered_json::array();
  for (const BlindedParticipant& row : results.participants)
    out["participants"].push_back(json_of(participants, row, {"*"}));
  out["group"] = nlohmann::ordered_json::array();
  for (const BlindedGroup& row : results.groups) out["group"].push_back(json_of(groups, row, {"*"}));
  return out;
}

Fields<BlindedParticipant> blinded_participant_fields() {
  using R = BlindedParticipant;
  using F = Field<R>;
  return {
      F("participant", "code of the participant", &R::participant),
      F("state", "how far the participant is", &R::state,
        {.levels = "finished \"not finished\" \"ended early\" excluded"}),
      F("sessions", "sessions begun", &R::sessions),
      F("trials_done", "main trials answered", &R::trials_done),
      F("trials_total", "main trials planned", &R::trials_total),
      F("trials_voided", "attempts voided, practice included", &R::trials_voided, {.title = "voided"}),
      F("device_faults", "presentations that a fault stopped", &R::device_faults, {.title = "device faults"}),
      F("said_different", "share of answers \"different\", over all stimuli", &R::said_different,
        {.title = "said different", .shown = Shown::percent}),
      F("median_response_time_s", "median response time of the participant's own entries", &R::median_response_time_s,
        {.unit = "s", .title = "median response s", .digits = 2}),
      F("mean_trial_s", "mean time per trial", &R::mean_trial_s, {.unit = "s", .title = "s per trial", .digits = 1})};
}

Fields<BlindedGroup> blinded_group_fields(const Protocol& protocol) {
  using R = BlindedGroup;
  using F = Field<R>;
  std::string unit(unit_of(protocol));
  const std::string what = protocol.design.procedure ? "threshold" : "JND";
  const int digits = stiffness_decimals(protocol);
  return {F("code", "letter of the condition on the operator's console", &R::code,
            {.column = "condition_code", .title = "condition"}),
          F("n", fmt::format("participants with a {}; empty below {}", what, kFewestTogether), &R::n),
          F("of", "participants with data", &R::of),
          F("mean", fmt::format("their mean {}", what), &R::mean,
            {.unit = unit, .title = fmt::format("mean {} {}", what, unit), .digits = digits}),
          F("ci_low", "lower end of its 95 % confidence interval", &R::ci_low, {.unit = unit, .digits = digits}),
          F("ci_high", "upper end of its 95 % confidence interval", &R::ci_high, {.unit = unit, .digits = digits}),
          beside<R>("unit", [unit](const R&) { return unit; }),
          beside<R>("status", [](const R& r) { return r.n ? "ok" : "too_few_participants"; })};
}

}  // namespace jnd
