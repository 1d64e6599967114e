// The results of a blinded study as blocks and JSON.
#include <fmt/format.h>

#include "data/blocks/common_fields.h"
#include "runner/results/blinded_results.h"
#include "runner/results/block_output.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

Block monitoring_block(const BlindedResults& results) {
  using R = BlindedParticipant;
  using F = Field<R>;
  const Fields<R> fields = {
      common<R>("participant", &R::participant),
      F("state", "how far the participant is", &R::state,
        {.levels = "finished \"not finished\" \"ended early\" excluded"}),
      F("sessions", "sessions that were opened", &R::sessions),
      F("trials_done", "main trials answered, over all sessions", &R::trials_done),
      F("trials_total", "main trials planned", &R::trials_total),
      F("trials_voided", "attempts voided, practice included", &R::trials_voided, {.title = "voided"}),
      F("device_faults", "presentations that a fault stopped", &R::device_faults, {.title = "device faults"}),
      F("said_different", "share of \"different\" answers", &R::said_different,
        {.title = "said different", .shown = Shown::percent}),
      F("median_response_time_s", "median of the times that the participant entered; empty without one",
        &R::median_response_time_s, {.unit = "s", .title = "median response s"}),
      F("mean_trial_s", "mean time of a counted trial; empty without one", &R::mean_trial_s,
        {.unit = "s", .title = "s per trial"})};
  Block block;
  block.id = "monitoring";
  block.section = Section::participants;
  block.title = "Participants";
  block.note = "pooled over conditions and stimuli; how often a participant is right is not shown";
  block.columns = {
      {"participant"},   {"state"},         {"sessions"},       share("trials_done", "trials_total", "trials"),
      {"trials_voided"}, {"device_faults"}, {"said_different"}, {"median_response_time_s"},
      {"mean_trial_s"}};
  return std::move(block.with(fields, results.participants));
}

Block coded_block(const BlindedResults& results, const Protocol& protocol) {
  using R = BlindedGroup;
  using F = Field<R>;
  const std::string unit(unit_of(protocol));
  const std::string title = fmt::format("mean {}", unit);
  const Fields<R> fields = {
      F("condition_code", "letter of the condition on the operator's console", &R::code, {.title = "condition"}),
      common<R>("n", &R::n),
      common<R>("participants", &R::of),
      common<R>("mean", &R::mean, {.unit = unit, .title = title}),
      common<R>("ci_low", &R::ci_low, {.unit = unit}),
      common<R>("ci_high", &R::ci_high, {.unit = unit}),
      common<R>("unit", [&protocol](const R&) { return unit_of(protocol); }),
      common<R>("status", [](const R& r) { return r.n ? "ok" : "too_few_participants"; },
                {.levels = "ok too_few_participants"})};
  Block block;
  block.id = "coded";
  block.section = Section::participants;
  block.title = "Group by coded condition";
  block.note = fmt::format(
      "the letters of the operator's console; a mean stands from {} participants on, so that it is nobody's own",
      kFewestTogether);
  block.columns = {{"condition_code"}, share("n", "participants", "n used"), {"mean"}, range("ci_low", "ci_high")};
  return std::move(block.with(fields, results.groups));
}

}  // namespace

std::vector<Block> blinded_blocks(const BlindedResults& results, const Protocol& protocol) {
  std::vector<Block> blocks;
  blocks.push_back(monitoring_block(results));
  blocks.push_back(coded_block(results, protocol));
  return blocks;
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
  for (const Block& block : blinded_blocks(results, protocol)) out[block.id] = json_rows(block);
  return out;
}

}  // namespace jnd
