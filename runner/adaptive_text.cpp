#include "runner/adaptive_text.h"

#include <cmath>

#include <fmt/format.h>

#include "runner/json_output.h"
#include "runner/terminal.h"
#include "runner/text_table.h"

namespace jnd {
namespace {

using Json = nlohmann::ordered_json;
using Align = TextTable::Align;

bool by_staircase(const Protocol& protocol) {
  return protocol.design.procedure->kind == AdaptiveProcedure::Kind::staircase;
}

const std::string& condition_name(const Protocol& protocol, int condition) {
  return protocol.conditions[static_cast<std::size_t>(condition)].name;
}

// Stiffness differences in N/m need no decimals, those in N/rad two.
std::string level_text(double level, const Protocol& protocol) {
  if (std::isnan(level)) return "-";
  return fmt::format("{:.{}f}", level, protocol.stimulus.unit == StiffnessUnit::n_per_m ? 1 : 3);
}

std::string share_text(double share) {
  return std::isnan(share) ? "-" : fmt::format("{:.1f} %", 100 * share);
}

// Of QUEST the posterior's standard deviation is of a logarithm: as a factor.
std::string sd_text(double sd, const Protocol& protocol) {
  if (std::isnan(sd)) return "-";
  return by_staircase(protocol) ? level_text(sd, protocol) : fmt::format("x/ {:.2f}", std::pow(10, sd));
}

std::string group_text(const AdaptiveResults& results, const Protocol& protocol) {
  TextTable table({"condition", fmt::format("threshold {}", to_string(protocol.stimulus.unit)), "sd", "Weber",
                   "false alarms", "participants"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::left});
  for (const AdaptiveGroup& group : results.group)
    table.add({condition_name(protocol, group.condition), level_text(group.mean, protocol),
               level_text(group.sd, protocol), share_text(group.mean / protocol.stimulus.reference),
               share_text(group.false_alarms), fmt::format("{} of {}", group.n, group.of)});
  return table.text();
}

std::string rows_text(const AdaptiveResults& results, const Protocol& protocol, bool tracks) {
  TextTable table({"participant", "condition", "track", "trials", "hits", "catch", "false alarms",
                   by_staircase(protocol) ? "reversals" : "",
                   fmt::format("threshold {}", to_string(protocol.stimulus.unit)), "sd", "Weber", "status"},
                  {Align::left, Align::left, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right, Align::right, Align::right, Align::left});
  for (const AdaptiveRow& row : results.rows) {
    if (row.track != 0 && !tracks) continue;
    table.add({printable(row.participant), condition_name(protocol, row.condition),
               row.track == 0 ? "all" : std::to_string(row.track), std::to_string(row.trials), std::to_string(row.hits),
               std::to_string(row.catch_trials), share_text(row.false_alarm_rate),
               !by_staircase(protocol) ? ""
               : row.track == 0        ? fmt::format("{} averaged", row.threshold.n)
                                       : std::to_string(row.reversals.size()),
               level_text(row.threshold.threshold, protocol), sd_text(row.threshold.sd, protocol),
               share_text(row.weber),
               fmt::format("{}{}", to_string(row.threshold.status), row.finished ? "" : ", not finished")});
  }
  return table.text();
}

Json json_of(const AdaptiveRow& row, const Protocol& protocol) {
  const auto rate = [](int count, int of) { return json_number(of > 0 ? static_cast<double>(count) / of : NAN); };
  Json out = {{"participant", row.participant},
              {"kind", to_string(row.kind)},
              {"condition", condition_name(protocol, row.condition)},
              {"track", row.track == 0 ? Json(nullptr) : Json(row.track)},
              {"finished", row.finished},
              {"trials", row.trials},
              {"hits", row.hits},
              {"hit_rate", rate(row.hits, row.trials)},
              {"catch_trials", row.catch_trials},
              {"false_alarms", row.false_alarms},
              {"false_alarm_rate", json_number(row.false_alarm_rate)},
              {"threshold", json_number(row.threshold.threshold)},
              {by_staircase(protocol) ? "sd" : "sd_log10", json_number(row.threshold.sd)},
              {"n", row.threshold.n},
              {"weber", json_number(row.weber)},
              {"status", to_string(row.threshold.status)}};
  if (row.track != 0) out["levels"] = row.levels;
  if (row.track != 0 && by_staircase(protocol)) out["reversals"] = row.reversals;
  return out;
}

}  // namespace

std::string to_text(const AdaptiveResults& results, const Protocol& protocol, bool tracks) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  std::string text = fmt::format("{}\n{}\n", bold(printable(protocol.title)), group_text(results, protocol));
  text += rows_text(results, protocol, tracks);
  text += fmt::format(
      "Threshold: the difference from {:g} {} of which \"different\" is said in {:.1f} %; {}. It moves with the "
      "criterion: compare it where the false alarms are alike.\n",
      protocol.stimulus.reference, to_string(protocol.stimulus.unit), 100 * adaptive_target(procedure),
      by_staircase(protocol)
          ? fmt::format("mean of the last {} reversals of each track", procedure.averaged_reversals / 2 * 2)
          : std::string("10 to the mean of the posterior of log10, its sd as a factor"));
  if (procedure.catch_share == 0) text += warn("Without catch trials there is no false-alarm rate, and no d'.") + "\n";
  return text;
}

Json to_json(const AdaptiveResults& results, const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  Json out = {{"kind", to_string(results.kind)},
              {"protocol_sha256", protocol.sha256},
              {"unit", to_string(protocol.stimulus.unit)},
              {"reference", protocol.stimulus.reference},
              {"procedure",
               {{"kind", by_staircase(protocol) ? "staircase" : "quest"},
                {"target", json_number(adaptive_target(procedure))},
                {"clamp", procedure.clamp},
                {"catch_share", procedure.catch_share}}}};
  out["group"] = Json::array();
  for (const AdaptiveGroup& group : results.group)
    out["group"].push_back({{"condition", condition_name(protocol, group.condition)},
                            {"n", group.n},
                            {"of", group.of},
                            {"threshold_mean", json_number(group.mean)},
                            {"threshold_sd", json_number(group.sd)},
                            {"false_alarm_rate", json_number(group.false_alarms)}});
  out["rows"] = Json::array();
  for (const AdaptiveRow& row : results.rows) out["rows"].push_back(json_of(row, protocol));
  return out;
}

}  // namespace jnd
