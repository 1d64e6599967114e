// What would keep the levels of an adaptive procedure from moving, or its threshold from being one.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "protocols/planning/adaptive_run.h"
#include "protocols/reading/protocol_reading.h"

namespace jnd {
namespace {

constexpr int kFewLevels = 5;  // distinct ones of a QUEST grid within the clamp
constexpr int kFewReversals = 6;
constexpr int kFewTrials = 20;  // of a track

void warn_about_staircase(ProtocolReading& reading, const AdaptiveProcedure& procedure) {
  const double lowest = procedure.clamp[0], highest = procedure.clamp[1];
  const StaircaseRule& rule = procedure.staircase;
  const auto look = [&](double step, std::string_view key) {
    const bool too_far = rule.multiplicative ? step > highest / lowest : step > highest - lowest;
    if (too_far)
      reading.warn_at(procedure_path(key),
                      fmt::format("a step of {} is larger than the clamp, {} to {}: the level jumps between its ends",
                                  plain(step), plain(lowest), plain(highest)),
                      "take a smaller step, or a wider clamp");
  };
  look(rule.step_up, "step_up");
  look(rule.step_down, "step_down");
  for (std::size_t i = 0; i < procedure.starts.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", procedure_path("starts"), i);
    if (procedure.starts[i] == highest)
      reading.warn_at(
          path, fmt::format("starts at the upper end of the clamp, {}: wrong answers cannot raise it", plain(highest)),
          "who cannot tell it apart stays there: start below, or widen the clamp");
    if (procedure.starts[i] == lowest)
      reading.warn_at(
          path, fmt::format("starts at the lower end of the clamp, {}: right answers cannot lower it", plain(lowest)),
          "start above it");
  }
  const int averaged = procedure.averaged_reversals;
  if (procedure.reversals > 0 && procedure.reversals < averaged)
    reading.warn_at(
        procedure_path("stop.reversals"),
        fmt::format("a track ends after {} reversals, but {} are to be averaged", procedure.reversals, averaged),
        "stop later, or set \"averaged_reversals\"");
  else if (procedure.reversals > 0 && procedure.reversals < kFewReversals)
    reading.warn_at(procedure_path("stop.reversals"),
                    fmt::format("{} reversals make a rough threshold", procedure.reversals),
                    fmt::format("plan {} or more, and leave the first ones out", kFewReversals));
  const auto halvings = static_cast<int>(rule.halve_after.size());
  const int last = halvings == 0 ? 0 : *std::max_element(rule.halve_after.begin(), rule.halve_after.end());
  if (procedure.reversals > 0 && last > procedure.reversals - averaged)
    reading.warn_at(procedure_path("halve_after"),
                    fmt::format("reversal {} still halves the step, within the last {} of {} that are averaged", last,
                                averaged, procedure.reversals),
                    "halve earlier, or stop later");
}

void warn_about_quest(ProtocolReading& reading, const AdaptiveProcedure& procedure) {
  const double lowest = procedure.clamp[0], highest = procedure.clamp[1];
  for (std::size_t i = 0; i < procedure.starts.size(); ++i) {
    const QuestParameters quest = quest_of_track(procedure, static_cast<int>(i) + 1);
    const int half = quest_grid_size(quest) / 2;
    int levels = 0;
    double before = -1;
    for (int step = -half; step <= half; ++step) {
      const double level = quest_level(quest.t_guess + step * quest.grain, procedure.clamp);
      levels += level != before ? 1 : 0;
      before = level;
    }
    if (levels < kFewLevels)
      reading.warn_at(procedure_path("grain"),
                      fmt::format("the grid about {} has {} levels within the clamp, {} to {}: it can hardly move",
                                  plain(procedure.starts[i]), levels, plain(lowest), plain(highest)),
                      "take a smaller grain, a larger range or a wider clamp");
    const double low = quest.t_guess - half * quest.grain, high = quest.t_guess + half * quest.grain;
    if (std::pow(10, low) > lowest || std::pow(10, high) < highest)
      reading.warn_at(
          procedure_path("range"),
          fmt::format("the grid about {} holds thresholds from {:.4g} to {:.4g} only; the clamp allows {} "
                      "to {}",
                      plain(procedure.starts[i]), std::pow(10, low), std::pow(10, high), plain(lowest), plain(highest)),
          "a threshold beyond the grid is never found: take a larger range");
  }
}

}  // namespace

void warn_about_procedure(ProtocolReading& reading) {
  const AdaptiveProcedure& procedure = *reading.protocol.design.procedure;
  if (procedure.kind == AdaptiveProcedure::Kind::staircase)
    warn_about_staircase(reading, procedure);
  else
    warn_about_quest(reading, procedure);
  if (procedure.trials < kFewTrials)
    reading.warn_at(procedure_path(procedure.reversals > 0 ? "stop.at_most" : "stop.trials"),
                    fmt::format("{} trials with a difference a track are few", procedure.trials),
                    fmt::format("plan {} or more", kFewTrials));
  if (procedure.catch_share == 0)
    reading.warn_at(procedure_path("catch_share"),
                    "without catch trials there is no false-alarm rate: who always says \"different\" reaches the "
                    "lowest level, and d' cannot be computed",
                    "0.5 makes both answers equally likely to be right");
}

}  // namespace jnd
