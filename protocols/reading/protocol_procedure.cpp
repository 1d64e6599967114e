// Reads how the answers set the levels: the member "procedure" of the design.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/reading/protocol_reading.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/posterior_model.h"

namespace jnd {
namespace {

std::string_view unit_of(const ProtocolReading& reading) {
  return to_string(reading.protocol.stimulus.unit);
}

void read_staircase(JsonReader& reader, AdaptiveProcedure& procedure, ProtocolReading& reading) {
  StaircaseRule& rule = procedure.staircase;
  rule.up = reader.integer("up", {.min = 1, .max = 10});
  rule.down = reader.integer("down", {.min = 1, .max = 10});
  rule.multiplicative = reader.boolean_or("multiplicative", false);
  const NumberLimits limits = rule.multiplicative
                                  ? NumberLimits{.min = 1, .max = 1000, .above = true}
                                  : NumberLimits{.min = 0, .max = 20000, .above = true, .unit = unit_of(reading)};
  rule.step_up = reader.number("step_up", limits);
  rule.step_down = reader.number("step_down", limits);
  if (const JsonNode* list = reader.array_or_null("halve_after", 0, 20)) {
    for (const JsonNode& item : list->items) {
      const auto reversal = integer_of(item, {.min = 1, .max = 100}, reading.errors, reading.file);
      if (!reversal) continue;
      if (std::find(rule.halve_after.begin(), rule.halve_after.end(), *reversal) != rule.halve_after.end())
        reading.error(item, fmt::format("reversal {} is named twice", *reversal), "one reversal halves once");
      rule.halve_after.push_back(*reversal);
    }
  }
  procedure.averaged_reversals = reader.integer_or("averaged_reversals", 6, {.min = 2, .max = 100});
  if (procedure.averaged_reversals % 2 != 0)
    reader.error("averaged_reversals",
                 fmt::format("{} reversals cannot be half peaks, half valleys", procedure.averaged_reversals),
                 "take an even number");
  rule.accelerated = reader.boolean_or("accelerated", false);
  if (!rule.accelerated) return;
  for (const std::string_view key : {"up", "down"})
    if (reading.sound(procedure_path(key)) && (key == "up" ? rule.up : rule.down) != 1)
      reader.error(key, "accelerated steps follow single answers", "write 1: unequal steps say what it settles at");
  if (!rule.halve_after.empty())
    reader.error("halve_after", "has no meaning beside accelerated steps, which shrink by themselves", "remove it");
}

void read_quest(JsonReader& reader, AdaptiveProcedure& procedure) {
  QuestParameters& quest = procedure.quest;
  quest.t_guess_sd = reader.number("guess_sd", {.min = 0, .max = 5, .above = true, .unit = "log10"});
  quest.p_threshold = reader.number("p_threshold", {.min = 0.01, .max = 0.99});
  quest.gamma = reader.number("gamma", {.min = 0, .max = 0.9});
  quest.beta = reader.number_or("beta", 3.5, {.min = 0.1, .max = 50});
  quest.delta = reader.number_or("delta", 0.01, {.min = 0, .max = 0.5});
  quest.grain = reader.number_or("grain", 0.01, {.min = 0.0001, .max = 1, .unit = "log10"});
  quest.range = reader.number_or("range", 2, {.min = 0.001, .max = 10, .unit = "log10"});
}

constexpr std::array<std::string_view, 8> kStaircaseKeys = {
    "accelerated", "up", "down", "multiplicative", "step_up", "step_down", "halve_after", "averaged_reversals"};
constexpr std::array<std::string_view, 7> kQuestKeys = {"guess_sd", "p_threshold", "gamma", "beta",
                                                        "delta",    "grain",       "range"};
constexpr std::array<std::string_view, 2> kPosteriorKeys = {"levels", "utility"};
constexpr std::array<std::string_view, 2> kModelKeys = {"grid", "prior"};  // of a posterior of all answers
constexpr std::array<std::string_view, 1> kThresholdKeys = {"threshold"};  // of a staircase

void refuse(JsonReader& reader, std::string_view kind, std::span<const std::string_view> keys) {
  reader.refuse(keys, fmt::format("has no meaning in a {} procedure", kind), "remove it, or change the kind");
}

// The mean of reversals, or the posterior of all answers.
void read_threshold(JsonReader& reader, AdaptiveProcedure& procedure, ProtocolReading& reading) {
  procedure.joint_likelihood =
      reader.one_of_or<bool>("threshold", {{"reversals", false}, {"joint-likelihood", true}}, false);
  if (!procedure.joint_likelihood) {
    reader.refuse(kModelKeys, "belongs to a threshold by joint likelihood",
                  R"(remove it, or write "threshold": "joint-likelihood")");
    return;
  }
  if (reading.has_pairs()) return read_response_model(reader, procedure, reading);
  for (const std::string_view key : kModelKeys) reader.ignore(key);
  reader.error("threshold",
               fmt::format("has no meaning with the task {}, whose results rest on all answers anyway",
                           in_quotes(to_string(reading.protocol.task.kind))),
               "remove it");
}

// What ends a track before its trials, by the names of its keys.
std::string early_ends(AdaptiveProcedure::Kind kind) {
  if (kind == AdaptiveProcedure::Kind::staircase) return R"(, or {"reversals": N, "at_most": N})";
  if (kind == AdaptiveProcedure::Kind::posterior) return R"(, or {"precision": SD, "at_most": N})";
  return "";
}

void read_stop(JsonReader& outer, AdaptiveProcedure& procedure, ProtocolReading& reading) {
  const JsonNode* node = outer.object("stop");
  if (node == nullptr) return;
  JsonReader reader(*node, reading.errors, reading.file);
  const auto trials = reader.optional_integer("trials", {.min = 2, .max = 2000});
  const auto reversals = reader.optional_integer("reversals", {.min = 2, .max = 100});
  const auto precision = reader.optional_number("precision", {.min = 0.01, .max = 2});
  const auto at_most = reader.optional_integer("at_most", {.min = 2, .max = 2000});
  std::vector<std::string_view> named;  // of what may end a track
  for (const std::string_view key : {"trials", "reversals", "precision"})
    if (node->find(key) != nullptr) named.push_back(key);
  const bool names_bound = node->find("at_most") != nullptr;
  const bool knows_kind = reading.sound(procedure_path("kind"));
  reader.finish();
  if (named.size() != 1) {
    const AdaptiveProcedure::Kind kind = knows_kind ? procedure.kind : AdaptiveProcedure::Kind::staircase;
    reading.error(*node,
                  named.empty() ? std::string("does not say when a track ends")
                                : fmt::format("names both {} and {}", in_quotes(named[0]), in_quotes(named[1])),
                  fmt::format(R"(write {{"trials": N}}{})", early_ends(kind)));
  } else if (named[0] == "reversals" && knows_kind && procedure.kind != AdaptiveProcedure::Kind::staircase) {
    const bool quest = procedure.kind == AdaptiveProcedure::Kind::quest;
    reading.error(*node->find("reversals"), quest ? "QUEST has no reversals" : "the posterior has no reversals",
                  fmt::format(R"(write {{"trials": N}}{})", early_ends(procedure.kind)));
  } else if (named[0] == "precision" && knows_kind && procedure.kind != AdaptiveProcedure::Kind::posterior) {
    reading.error(*node->find("precision"), "belongs to a posterior procedure",
                  fmt::format(R"(write {{"trials": N}}{})", early_ends(procedure.kind)));
  } else if (named[0] != "trials" && !names_bound) {
    reading.error(*node, "does not say how many trials a track has at most",
                  fmt::format("{} may never come: add \"at_most\"", named[0]));
  } else if (named[0] == "trials" && names_bound) {
    reading.error(*node->find("at_most"), "has no meaning beside \"trials\"", "remove it");
  }
  procedure.trials = trials ? *trials : at_most.value_or(0);
  procedure.reversals = reversals.value_or(0);
  procedure.precision = precision;
}

void look_at_clamp(const JsonNode& clamp, const AdaptiveProcedure& procedure, ProtocolReading& reading) {
  if (!reading.sound(clamp.path)) return;
  const auto [lowest, highest] = procedure.clamp;
  if (lowest >= highest) {
    reading.error(clamp, fmt::format("{} is not below {}: the level cannot move", plain(lowest), plain(highest)),
                  "write the lowest level, then the highest");
    return;
  }
  if (!reading.has_pairs()) return;  // lint_task looks at every standard
  const double reference = reading.protocol.stimulus.reference;
  const double softest = stiffness_limits(reading.protocol.stimulus.unit).min;
  if (reading.sound("$.stimulus.reference") && reference - highest < softest)
    reading.error(
        clamp.kind == JsonNode::Kind::array ? clamp.items.back() : clamp,
        fmt::format("a comparison {} {} softer than the reference, {} {}, would have {} {}", plain(highest),
                    unit_of(reading), plain(reference), unit_of(reading), plain(reference - highest), unit_of(reading)),
        fmt::format("levels are differences from the reference: at most {}", plain(reference - softest)));
}

void look_at_starts(const JsonNode& starts, const AdaptiveProcedure& procedure, ProtocolReading& reading) {
  if (!reading.sound(starts.path) || !reading.sound(procedure_path("clamp"))) return;
  for (std::size_t i = 0; i < starts.items.size(); ++i)
    if (procedure.starts[i] < procedure.clamp[0] || procedure.starts[i] > procedure.clamp[1])
      reading.error(starts.items[i],
                    fmt::format("{} {} lies outside the clamp, {} to {}", plain(procedure.starts[i]), unit_of(reading),
                                plain(procedure.clamp[0]), plain(procedure.clamp[1])),
                    "levels are differences from the reference; move the start, or widen the clamp");
}

void look_at_quest(const JsonNode& node, const AdaptiveProcedure& procedure, ProtocolReading& reading) {
  const QuestParameters& quest = procedure.quest;
  if (!reading.sound(node.path)) return;
  const double highest = quest.delta * quest.gamma + 1 - quest.delta;
  if (!(quest.p_threshold > quest.gamma && quest.p_threshold < highest))
    reading.error_at(procedure_path("p_threshold"),
                     fmt::format("{} is never reached: the probability of \"different\" goes from {} to {:.4g}",
                                 plain(quest.p_threshold), plain(quest.gamma), highest),
                     "take a value between gamma and 1 - delta (1 - gamma)");
  if (quest.range < 2 * quest.grain)
    reading.error_at(procedure_path("range"),
                     fmt::format("a grid of {} in steps of {} holds no other threshold than the guess",
                                 plain(quest.range), plain(quest.grain)),
                     "take a larger range, or a smaller grain");
  else if (const std::string problem = problem_of(quest);
           !problem.empty() && reading.sound(procedure_path("p_threshold")))
    reading.error(node, problem, "");
}

// First levels, and between which limits the answers may move them.
void read_bounds(JsonReader& reader, AdaptiveProcedure& procedure, ProtocolReading& reading) {
  const NumberLimits level{.min = 0, .max = 20000, .above = true, .unit = unit_of(reading)};
  if (const JsonNode* starts = reader.array("starts", 1, 8))
    for (const JsonNode& item : starts->items)
      procedure.starts.push_back(number_of(item, level, reading.errors, reading.file).value_or(0));
  const JsonNode* clamp = reader.array("clamp", 2, 2);
  if (clamp != nullptr && clamp->items.size() == 2)
    for (std::size_t i = 0; i < 2; ++i)
      procedure.clamp[i] = number_of(clamp->items[i], level, reading.errors, reading.file).value_or(0);
}

constexpr double kPosteriorCatchShare = 1.0 / 3;

}  // namespace

std::string procedure_path(std::string_view member) {
  return fmt::format("{}.{}", kProcedurePath, member);
}

bool ProtocolReading::adaptive() const {
  return node_at(root, kProcedurePath) != nullptr;
}

void read_procedure(const JsonNode& node, ProtocolReading& reading) {
  AdaptiveProcedure procedure;
  JsonReader reader(node, reading.errors, reading.file);
  using Kind = AdaptiveProcedure::Kind;
  std::vector<std::string_view> kinds;
  for (const auto& [word, value] : procedure_words()) kinds.push_back(word);
  const auto kind = reader.word("kind", kinds, {}, true);
  if (kind) procedure.kind = procedure_words()[*kind].second;
  const bool chooses = kind && procedure.kind == Kind::posterior;
  if (!chooses) read_bounds(reader, procedure, reading);
  if (!kind) {
    for (const auto& keys :
         {std::span<const std::string_view>(kStaircaseKeys), std::span<const std::string_view>(kQuestKeys),
          std::span<const std::string_view>(kPosteriorKeys), std::span<const std::string_view>(kModelKeys),
          std::span<const std::string_view>(kThresholdKeys)})
      for (const std::string_view key : keys) reader.ignore(key);
  } else if (procedure.kind == Kind::staircase) {
    read_staircase(reader, procedure, reading);
    read_threshold(reader, procedure, reading);
    refuse(reader, "staircase", kQuestKeys);
    refuse(reader, "staircase", kPosteriorKeys);
  } else if (procedure.kind == Kind::quest) {
    read_quest(reader, procedure);
    refuse(reader, "quest", kStaircaseKeys);
    refuse(reader, "quest", kPosteriorKeys);
    refuse(reader, "quest", kModelKeys);
    refuse(reader, "quest", kThresholdKeys);
  } else {
    read_posterior(reader, procedure, reading);
    read_response_model(reader, procedure, reading);
    refuse(reader, "posterior", kStaircaseKeys);
    refuse(reader, "posterior", kQuestKeys);
    refuse(reader, "posterior", kThresholdKeys);
  }
  read_stop(reader, procedure, reading);
  const Task& task = reading.task();
  if (!task.has_procedures())
    reading.error(node,
                  fmt::format("the task {} has no levels that answers could set", in_quotes(to_string(task.kind()))),
                  "remove it: give constant levels");
  if (task.has_catch_trials()) {
    const NumberLimits share{.min = 0, .max = 0.75};
    procedure.catch_share =
        chooses ? reader.number_or("catch_share", kPosteriorCatchShare, share) : reader.number("catch_share", share);
  } else {
    procedure.catch_share = 0;
    reader.refuse({"catch_share"}, "has no meaning where every trial has a correct answer", "remove it");
  }
  if (reading.has_pairs())
    reader.refuse({"side"}, "belongs to tasks with standards: comparisons of pairs are softer", "remove it");
  if (!reading.has_pairs())
    procedure.sides =
        reader.one_of<std::vector<int>>("side", {{"below", {-1}}, {"above", {1}}, {"both", {-1, 1}}, {"across", {0}}});
  if (task.has_catch_trials() && procedure.sides.size() > 1)
    reader.error("side", "a signal lies on one side of the noise", "write \"above\" or \"below\"");
  if (procedure.sides.front() == 0 && (task.kind() != TaskKind::which || (kind && procedure.kind != Kind::staircase)))
    reading.error_at(procedure_path("side"), "only a staircase of the task \"which\" goes across the standard",
                     "write \"below\", \"above\" or \"both\"");
  if (reading.sound(procedure_path("catch_share")) && !catch_block_of(procedure))
    reader.error("catch_share",
                 fmt::format("{} of the trials cannot be kept in short blocks", plain(procedure.catch_share)),
                 "take a fraction with a denominator of at most 20, such as 0.5, 0.25 or 0.2");
  reader.finish();
  if (const JsonNode* limits = node_at(reading.root, limits_path(procedure)))
    look_at_clamp(*limits, procedure, reading);
  if (const JsonNode* starts = node.find("starts"); starts != nullptr && !chooses)
    look_at_starts(*starts, procedure, reading);
  if (kind && procedure.kind == Kind::quest) look_at_quest(node, procedure, reading);

  Protocol& protocol = reading.protocol;
  if (reading.has_pairs() && reading.sound(limits_path(procedure)) && reading.sound("$.stimulus.reference"))
    protocol.series = {{"adaptive",
                        {plain_sum(protocol.stimulus.reference, -procedure.clamp[1]), protocol.stimulus.reference},
                        protocol.stimulus.reference}};
  protocol.design.procedure = procedure;
  protocol.design.trials_per_cell = trials_of_cell(protocol, Series());
  if (has_posterior_threshold(protocol)) lint_response_model(node, procedure, reading);
}

// What would keep the levels from moving, or the threshold from being one.

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

// Values that are above 0 in the standard are seldom meant to go below.
void warn_about_negative_comparisons(ProtocolReading& reading, const AdaptiveProcedure& procedure) {
  if (reading.has_pairs() || procedure.kind == AdaptiveProcedure::Kind::posterior) return;
  for (const Series& series : reading.protocol.series)
    for (const int side : procedure.sides)
      if (series.standard > 0 && series.standard + side * procedure.clamp[1] < 0)
        return reading.warn_at(
            procedure_path("clamp"),
            fmt::format("a comparison {:g} below the standard {:g} is below 0", procedure.clamp[1], series.standard),
            "end the clamp at the standard, or before it");
}

}  // namespace

void warn_about_procedure(const AdaptiveProcedure& procedure, ProtocolReading& reading) {
  if (procedure.kind == AdaptiveProcedure::Kind::staircase) warn_about_staircase(reading, procedure);
  if (procedure.kind == AdaptiveProcedure::Kind::quest) warn_about_quest(reading, procedure);
  if (has_posterior_threshold(reading.protocol)) warn_about_response_model(procedure, reading);
  warn_about_negative_comparisons(reading, procedure);
  if (procedure.trials < kFewTrials)
    reading.warn_at(procedure_path(can_end_early(procedure) ? "stop.at_most" : "stop.trials"),
                    fmt::format("{} trials with a difference a track are few", procedure.trials),
                    fmt::format("plan {} or more", kFewTrials));
  if (procedure.catch_share == 0 && reading.task().has_catch_trials())
    reading.warn_at(procedure_path("catch_share"),
                    "without catch trials there is no false-alarm rate: who always says \"different\" reaches the "
                    "lowest level, and d' cannot be computed",
                    "0.5 makes both answers equally likely to be right");
}

}  // namespace jnd
