// Answers counted: cells of pairs, every arrangement of stimuli, curves over the levels, and what they are of the standard.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/blocks/common_fields.h"
#include "data/blocks/result_blocks.h"
#include "data/fields/number_text.h"

namespace jnd {

namespace {

Block cells_block(const StudyResults& results, const Protocol& protocol) {
  using R = CellResult;
  using F = Field<R>;
  const TaskResults& task = results.task;
  const std::string unit(to_string(protocol.stimulus.unit));
  const auto yes_no = [](auto member) { return [member](const R& r) { return r.yes_no.*member; }; };
  const auto pair = [&protocol](const R& r) { return protocol.series[static_cast<std::size_t>(r.series)].pair; };
  Fields<R> fields = {
      common<R>("participant", &R::participant),
      common<R>("kind", &R::kind, {.levels = kSessionKinds}),
      condition_field<R>(protocol, [](const R& r) { return r.condition; }),
      common<R>("series", [&protocol](const R& r) { return protocol.series[static_cast<std::size_t>(r.series)].name; }),
      F("difference", "difference of the two stimuli, as asked",
        [pair](const R& r) { return std::abs(pair(r)[1] - pair(r)[0]); },
        {.unit = unit, .title = "asked " + unit, .shown = Shown::given}),
      F("delivered_difference",
        "mean delivered difference |k2 - k1| of the counted trials with different stimuli; empty without one",
        [](const R& r) { return r.delivered_difference.mean; }, {.unit = unit, .title = "delivered"}),
      F("n_delivered", "trials in that mean", [](const R& r) { return r.delivered_difference.n; }),
      F("n_without_fit", "trials left out of it: no stiffness could be fitted in one of their intervals",
        &R::without_fit),
      F("delivered_softer", "mean delivered stiffness where the softer one was asked",
        [](const R& r) { return r.delivered[0].mean; }, {.unit = unit}),
      F("n_softer", "intervals in that mean", [](const R& r) { return r.delivered[0].n; }),
      F("delivered_stiffer", "mean delivered stiffness where the stiffer one was asked",
        [](const R& r) { return r.delivered[1].mean; }, {.unit = unit}),
      F("n_stiffer", "intervals in the mean of the stiffer one", [](const R& r) { return r.delivered[1].n; }),
      F("n_diff", "counted trials with different stimuli", [](const R& r) { return r.counts.n_diff; }),
      common<R>("hits", [](const R& r) { return r.counts.hits; }),
      F("n_same", "counted trials with equal stimuli", [](const R& r) { return r.counts.n_same; }),
      common<R>("false_alarms", [](const R& r) { return r.counts.false_alarms; }),
      common<R>("excluded", &R::excluded),
      common<R>("missing", &R::missing),
      F("raw.hit_rate", "hits / n_diff", yes_no(&YesNo::raw_hit_rate), {.title = "raw H"}),
      F("raw.false_alarm_rate", "false_alarms / n_same", yes_no(&YesNo::raw_false_alarm_rate), {.title = "raw F"}),
      F("hit_rate", "corrected hit rate", yes_no(&YesNo::hit_rate), {.title = "H"}),
      common<R>("false_alarm_rate", yes_no(&YesNo::false_alarm_rate), {.title = "F"}),
      F("z_hit", "normal quantile of hit_rate", yes_no(&YesNo::z_hit), {.title = "z(H)"}),
      F("z_false_alarm", "normal quantile of false_alarm_rate", yes_no(&YesNo::z_false_alarm), {.title = "z(F)"}),
      F("dprime", "d' = z_hit - z_false_alarm", yes_no(&YesNo::dprime), {.title = "d'"}),
      F("se", "standard error of dprime (Gourevitch and Galanter 1967)", yes_no(&YesNo::se)),
      common<R>("ci_low", yes_no(&YesNo::ci_low)),
      common<R>("ci_high", yes_no(&YesNo::ci_high)),
      F("criterion", "c = -(z_hit + z_false_alarm) / 2, of corrected rates; positive: tends to say same",
        yes_no(&YesNo::criterion), {.title = "c"}),
      F("ln_beta", "ln of the likelihood ratio at that criterion", yes_no(&YesNo::ln_beta)),
      common<R>("status", yes_no(&YesNo::status), {.levels = "ok no_information missing"})};
  fields.push_back(common<R>("difference_source", [](const R& r) { return r.difference_source; },
                             {.levels = "nominal delivered mixed"}));
  // Whatever is registered.
  fields.push_back(
      common<R>("model", [](const R&) { return "yes-no"; }, {.levels = "yes-no differencing independent-observation"}));
  fields.push_back(common<R>("correction", [c = protocol.analysis.correction](const R&) { return c; },
                             {.levels = "none loglinear half"}));
  fields.push_back(protocol_field<R>(protocol));
  add_group_field(fields, protocol, [](const R& r) { return r.group; });
  fields.push_back(F("remarks", "",
                     [&task](const R& r) {
                       std::string text =
                           r.yes_no.status == RateStatus::ok ? "" : std::string(to_string(r.yes_no.status));
                       if (r.excluded > 0) text = joined(text, fmt::format("{} excluded", r.excluded));
                       if (r.missing > 0) text = joined(text, fmt::format("{} not done", r.missing));
                       if (r.without_fit > 0 && r.delivered_difference.n > 0)
                         text = joined(text, fmt::format("{} without a delivered difference", r.without_fit));
                       return joined(text, source_caution(r.difference_source, task));
                     },
                     {.title = "cautions", .place = Place::table}));
  Block block;
  block.id = "cells";
  block.section = Section::cells;
  block.title = "Cells";
  block.note = fmt::format(
      "yes-no d' = z(H) - z(F) on {} rates, raw rates beside them; 95 % CI after Gourevitch and Galanter; c > 0 leans to "
      "\"same\"; stiffness differences as asked and as delivered",
      protocol.analysis.correction);
  block.columns = {{"participant"},
                   {"condition"},
                   {"series"},
                   {"difference"},
                   {"delivered_difference"},
                   share("hits", "n_diff", "hits", "/"),
                   share("false_alarms", "n_same", "false alarms", "/"),
                   {"raw.hit_rate"},
                   {"raw.false_alarm_rate"},
                   {"hit_rate"},
                   {"false_alarm_rate"},
                   {"z_hit"},
                   {"z_false_alarm"},
                   {"dprime"},
                   range("ci_low", "ci_high"),
                   {"criterion"},
                   {"remarks"}};
  return std::move(block.with(fields, task.cells));
}

Block counts_block(const StudyResults& results, const Protocol& protocol) {
  using R = TaskCountRow;
  using F = Field<R>;
  const std::string unit(to_string(protocol.stimulus.unit));
  Fields<R> fields = {common<R>("participant", &R::participant), common<R>("kind", &R::kind, {.levels = kSessionKinds}),
                      condition_field<R>(protocol, [](const R& r) { return r.condition; })};
  add_standard_fields(fields, protocol, [](const R& r) { return r.series; });
  Block block;
  block.columns = {{"participant"}, {"condition"}, {"standard"}};
  for (int i = 0; i < task_of(protocol.task.kind).intervals(protocol.task); ++i) {
    const std::string key = fmt::format("stimulus_{}", i + 1);
    fields.push_back(F(key, fmt::format("asked in interval {}", i + 1),
                       [i](const R& r) -> std::optional<double> {
                         const auto place = static_cast<std::size_t>(i);
                         return place < r.stimuli.size() ? std::optional(r.stimuli[place]) : std::nullopt;
                       },
                       {.unit = unit, .title = fmt::format("interval {}", i + 1), .shown = Shown::given}));
    block.columns.push_back({key});
  }
  std::string words;
  if (!task_of(protocol.task.kind).adjusts())  // its answers only move what is presented
    for (const std::string& word : protocol.task.classes) words.append(words.empty() ? "" : " ").append(word);
  fields.push_back(F("target", "the answer that is correct; empty where none is",
                     [&protocol](const R& r) { return std::string(said_word(protocol.task, r.target)); },
                     {.levels = words, .title = "correct"}));
  fields.push_back(
      F("answer", "what was answered",
        [&protocol](const R& r) {
          return r.number ? FieldValue(*r.number) : FieldValue(std::string(said_word(protocol.task, r.said)));
        },
        {.levels = words, .shown = Shown::given, .type = words.empty() ? CellType::number : CellType::text}));
  if (protocol.task.sureness_levels > 0) fields.push_back(F("sureness", "how sure of it, from 1", &R::sureness));
  fields.push_back(F("count", "how often that was so", &R::n, {.title = "n"}));
  add_group_field(fields, protocol, [](const R& r) { return r.group; });
  block.id = "counts";
  block.section = Section::cells;
  block.title = "Answers";
  block.note = "how often each answer was given to each arrangement of stimuli";
  for (const char* key : {"target", "answer"}) block.columns.push_back({key});
  if (protocol.task.sureness_levels > 0) block.columns.push_back({"sureness"});
  block.columns.push_back({"count"});
  return std::move(block.with(fields, results.task.counts));
}

// The points of a curve, a row each; fitted: the curve itself, in places of its own.
struct CurvePoint {
  const TaskCurveRow* of;
  double level;
  const TaskCurve::Point* point;  // null of the fitted curve
  double fitted;
};

Block curves_block(const StudyResults& results, const Protocol& protocol) {
  using R = CurvePoint;
  using F = Field<R>;
  std::vector<R> rows;
  for (const TaskCurveRow& row : results.task.curves) {
    for (const TaskCurve::Point& point : row.curve.points) rows.push_back({&row, point.x, &point, kNaN});
    for (std::size_t i = 0; i < row.curve.x.size(); ++i)
      rows.push_back({&row, row.curve.x[i], nullptr, row.curve.fitted[i]});
  }
  Fields<R> fields = {condition_field<R>(protocol, [](const R& r) { return r.of->condition; })};
  add_standard_fields(fields, protocol, [](const R& r) { return r.of->standard; });
  fields.insert(
      fields.end(),
      {F("level", "level of the stimulus", [](const R& r) { return r.level; },
         {.unit = to_string(protocol.stimulus.unit), .shown = Shown::given}),
       F("said", "the answer that is counted", [](const R& r) { return r.of->curve.said; }),
       F("count", "how often that was so",
         [](const R& r) { return r.point == nullptr ? std::nullopt : std::optional(r.point->said); }),
       common<R>("trials", [](const R& r) { return r.point == nullptr ? std::nullopt : std::optional(r.point->n); }),
       F("fitted", "share by the curve that is fitted to the answers of all participants; empty in rows of counts",
         [](const R& r) { return r.fitted; })});
  Block block;
  block.id = "curves";
  block.section = Section::cells;
  return std::move(block.with(fields, std::move(rows)));
}

Block proportion_block(const StudyResults& results, const Protocol& protocol) {
  using R = ProportionRow;
  using F = Field<R>;
  const TaskOutcome& outcome = results.task.outcomes[results.task.registered];
  Fields<R> fields = {
      condition_field<R>(protocol, [](const R& r) { return r.condition; }),
      common<R>("outcome", [key = std::string(outcome.key)](const R&) { return key; }),
      common<R>("n", [](const R& r) { return r.exponent.n; }),
      F("exponent",
        "mean slope of its logarithm (of a Weber fraction: of its JND) on that of the standard; 1: proportional (Weber's law)",
        [](const R& r) { return r.exponent.mean; }),
      common<R>("ci_low", [](const R& r) { return r.exponent.ci_low; }),
      common<R>("ci_high", [](const R& r) { return r.exponent.ci_high; }),
      F("p_of_1", "p of an exponent of 1, Student's t", &R::p, {.title = "p of 1", .shown = Shown::p_value})};
  Block block;
  block.id = "proportion";
  block.title = fmt::format("Is the {} proportional to the standard?",
                            outcome.of_standard ? "just-noticeable difference" : outcome.title);
  block.note = "slope of its logarithm on that of the standard, of each participant; 1: Weber's law";
  block.columns = {{"condition"}, {"n"}, {"exponent"}, range("ci_low", "ci_high"), {"p_of_1"}};
  return std::move(block.with(fields, results.task.proportion));
}

}  // namespace

Blocks count_blocks(const StudyResults& results, const Protocol& protocol) {
  const TaskResults& task = results.task;
  Blocks blocks;
  if (!task.cells.empty()) blocks.push_back(cells_block(results, protocol));
  if (!task.counts.empty()) blocks.push_back(counts_block(results, protocol));
  if (!task.curves.empty()) blocks.push_back(curves_block(results, protocol));
  if (!task.proportion.empty()) blocks.push_back(proportion_block(results, protocol));
  return blocks;
}

}  // namespace jnd
