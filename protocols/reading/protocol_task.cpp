// Reads what each trial asks and what is compared: the members "task", "standards", "levels" and "classes".
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "protocols/reading/protocol_reading.h"
#include "protocols/tasks/level_source.h"

namespace jnd {
namespace {

// How the numbers of "levels" are meant.
enum class LevelForm { absolute, difference, ratio };

constexpr auto kLevelForms = std::to_array<std::pair<std::string_view, LevelForm>>(
    {{"absolute", LevelForm::absolute}, {"difference", LevelForm::difference}, {"ratio", LevelForm::ratio}});

struct Levels {
  const JsonNode* node = nullptr;
  LevelForm form = LevelForm::absolute;
  std::vector<double> values;
};

double level_of(const Levels& levels, double value, double standard) {
  switch (levels.form) {
    case LevelForm::absolute:
      return value;
    case LevelForm::difference:
      return plain_sum(standard, value);
    case LevelForm::ratio:
      return plain_decimal(standard * value);
  }
  return value;
}

std::optional<Levels> read_level_list(const JsonNode& node, bool has_standard, ProtocolReading& reading) {
  JsonReader reader(node, reading.errors, reading.file);
  Levels levels;
  levels.node = &node;
  int forms = 0;
  for (const auto& [word, form] : kLevelForms) {
    const NumberLimits limits = form == LevelForm::ratio ? NumberLimits{.min = 0, .max = 1000, .above = true}
                                                         : NumberLimits{.min = -1e12, .max = 1e12};
    const JsonNode* given = reader.member(word);
    if (given == nullptr) continue;
    ++forms;
    levels.form = form;
    if (form != LevelForm::absolute && !has_standard)
      reading.error(*given, fmt::format("{} of what? This task has no standard", in_quotes(word)),
                    "write \"absolute\" and the values themselves");
    if (given->kind == JsonNode::Kind::object) {
      levels.values = read_steps(*given, limits, reading);
    } else if (const JsonNode* list = reader.array_or_null(word, 1, 50)) {
      for (const JsonNode& item : list->items)
        levels.values.push_back(number_of(item, limits, reading.errors, reading.file).value_or(0));
    }
  }
  reader.finish();
  if (forms != 1 && reading.sound(node.path))
    reading.error(node, forms == 0 ? "names no levels" : "says in two ways what the levels are",
                  R"(write one of {"absolute": [...]}, {"difference": [...]}, {"ratio": [...]}: of the standard)");
  return reading.sound(node.path) ? std::optional(levels) : std::nullopt;
}

// The levels of a series, each once and none equal to its standard unless the task can use it.
void set_levels(Series& series, const Levels& levels, ProtocolReading& reading) {
  const NumberLimits limits = value_limits(reading.protocol);
  std::set<double> seen;
  for (const double value : levels.values) {
    const double level = level_of(levels, value, series.standard);
    if (level < limits.min || level > limits.max)
      reading.error(*levels.node, fmt::format("{} makes a level of {} {}", plain(value), plain(level), limits.unit),
                    fmt::format("levels lie between {} and {} {}", plain(limits.min), plain(limits.max), limits.unit));
    else if (!seen.insert(level).second)
      reading.error(*levels.node, fmt::format("the level {} {} is named twice", plain(level), limits.unit),
                    "remove one");
    series.levels.push_back(level);
  }
}

void read_standards(const JsonNode& list, const std::optional<Levels>& shared, ProtocolReading& reading) {
  for (const JsonNode& item : list.items) {
    Series series;
    JsonReader reader(item, reading.errors, reading.file);
    series.name = read_name(reader, "name", reading).value_or("");
    series.standard = reader.number("value", value_limits(reading.protocol));
    const JsonNode* own = reader.object_or_null("levels");
    reader.finish();
    if (reading.adaptive()) {
      if (own != nullptr)
        reading.error(*own, "has no meaning beside $.design.procedure: the answers set the levels", "remove it");
    } else if (own != nullptr) {
      if (const auto levels = read_level_list(*own, true, reading)) set_levels(series, *levels, reading);
    } else if (shared) {
      set_levels(series, *shared, reading);
    } else if (reading.root.find("levels") == nullptr) {
      reading.error(item, "has no levels", "add \"levels\" here, or $.levels for all standards");
    }
    reading.protocol.series.push_back(std::move(series));
  }
}

void read_classes(const JsonNode& list, ProtocolReading& reading) {
  TaskSpec& task = reading.protocol.task;
  Series series{.name = "all"};
  for (const JsonNode& item : list.items) {
    JsonReader reader(item, reading.errors, reading.file);
    const std::string name = read_name(reader, "name", reading).value_or("");
    const double value = reader.number("value", value_limits(reading.protocol));
    reader.finish();
    if (std::find(task.classes.begin(), task.classes.end(), name) != task.classes.end())
      reading.error(item, fmt::format("there are two classes named {}", in_quotes(name)), "names must differ");
    if (std::find(task.class_values.begin(), task.class_values.end(), value) != task.class_values.end() &&
        reading.sound(item.path))
      reading.error(item, fmt::format("there are two classes of {}", plain(value)), "values must differ");
    task.classes.push_back(name);
    task.class_values.push_back(value);
    series.levels.push_back(value);
  }
  reading.protocol.series.push_back(std::move(series));
}

void refuse_member(JsonReader& reader, std::string_view key, const std::string& task, const std::string& instead) {
  reader.refuse({key}, fmt::format("has no meaning with the task {}", in_quotes(task)), instead);
}

// Every value must lie on the table, and where a trial presents it twice, twice.
void lint_specimens(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  if (!reading.sound("$.rig")) return;
  if (reading.procedure() != nullptr)
    reading.error_at(kProcedurePath, "specimens have fixed values: answers cannot set the levels",
                     "give constant levels");
  const int intervals = task_of(protocol.task.kind).intervals(protocol.task);
  const auto look = [&](double value, std::size_t needed) {
    for (const Specimen& specimen : protocol.rig.specimens)
      if (specimen.value == value && specimen.codes.size() >= needed) return;
    reading.error_at("$.rig.specimens",
                     fmt::format("{} of {} {} {} needed at once", needed == 1 ? "one" : "two", plain(value),
                                 to_string(protocol.stimulus.unit), needed == 1 ? "is" : "are"),
                     needed == 1 ? "add a specimen of that value, with its code"
                                 : "give that value two codes: of two specimens that are alike");
  };
  for (const Series& series : protocol.series) {
    if (task_of(protocol.task.kind).has_standard()) look(series.standard, intervals > 2 ? 2 : 1);
    for (const double level : series.levels) look(level, intervals > 2 || level == series.standard ? 2 : 1);
    for (const double value : series.pair)
      if (reading.has_pairs()) look(value, 2);
  }
}

}  // namespace

std::vector<double> read_steps(const JsonNode& node, const NumberLimits& limits, ProtocolReading& reading) {
  constexpr int kMostSteps = 400;
  JsonReader reader(node, reading.errors, reading.file);
  const double from = reader.number("from", limits);
  const double to = reader.number("to", limits);
  const double step = reader.number("step", {.min = 0, .max = 1e12, .above = true});
  reader.finish();
  if (!reading.sound(node.path)) return {};
  const double steps = std::round((to - from) / step);
  if (!(to > from) || std::abs(from + steps * step - to) > 1e-6 * step) {
    reading.error(
        node, fmt::format("no whole number of steps of {} leads from {} to {}", plain(step), plain(from), plain(to)),
        "move one of the ends, or change the step");
    return {};
  }
  if (steps >= kMostSteps) {
    reading.error(node, fmt::format("{} steps are more than {} values", plain(steps), kMostSteps),
                  "take a larger step");
    return {};
  }
  std::vector<double> values;
  for (int i = 0; i <= static_cast<int>(steps); ++i) values.push_back(plain_sum(from, i * step));
  return values;
}

NumberLimits value_limits(const Protocol& protocol) {
  if (protocol.rig.built_in()) return stiffness_limits(protocol.stimulus.unit);
  return {.min = -1e9, .max = 1e9, .unit = to_string(protocol.stimulus.unit)};
}

void read_task(JsonReader& outer, ProtocolReading& reading) {
  static const JsonNode kNothing = [] {
    JsonNode nothing;
    nothing.kind = JsonNode::Kind::object;
    nothing.path = "$.task";
    return nothing;
  }();
  const JsonNode* node = outer.object_or_null("task");
  JsonReader section(node == nullptr ? kNothing : *node, reading.errors, reading.file);
  TaskSpec& task = reading.protocol.task;
  task.classes.clear();
  task.answers.clear();
  task_of(task.kind).read(section, task);
  // Those of the other tasks.
  for (const std::string_view key : {"chosen", "odd", "standard", "presentation", "sureness", "signal_share", "modulus",
                                     "lowest", "highest", "start"}) {
    const auto& known = section.known_keys();
    if (std::find(known.begin(), known.end(), key) == known.end())
      refuse_member(section, key, std::string(to_string(task.kind)), "remove it");
  }
  section.finish();
}

void read_comparisons(JsonReader& outer, ProtocolReading& reading) {
  const Task& task = task_of(reading.protocol.task.kind);
  const std::string word(to_string(task.kind()));
  refuse_member(outer, "series", word, "write \"standards\" and \"levels\"");
  const JsonNode* standards = nullptr;
  if (task.kind() == TaskKind::identify) {
    refuse_member(outer, "standards", word, "write \"classes\": the values that are named");
    refuse_member(outer, "levels", word, "write \"classes\": the values that are named");
    if (const JsonNode* classes = outer.array("classes", 2, 20)) read_classes(*classes, reading);
    return;
  }
  refuse_member(outer, "classes", word, "they belong to \"identify\"; write \"standards\" and \"levels\"");
  const bool standard = task.has_standard() || reading.protocol.task.modulus.has_value();
  if (standard)
    standards = outer.array("standards", 1, 50);
  else
    refuse_member(outer, "standards", word, "its values stand for themselves: write \"levels\"");
  std::optional<Levels> shared;
  if (reading.adaptive())
    refuse_member(outer, "levels", word + " and a procedure", "remove it: the answers set the levels");
  else if (const JsonNode* levels = standard ? outer.object_or_null("levels") : outer.object("levels"))
    shared = read_level_list(*levels, standard, reading);
  if (standards != nullptr) return read_standards(*standards, shared, reading);
  Series series{.name = "all"};
  if (shared) set_levels(series, *shared, reading);
  reading.protocol.series.push_back(std::move(series));
}

void set_extremes(Protocol& protocol) {
  const bool standard = task_of(protocol.task.kind).has_standard() || protocol.task.modulus.has_value();
  for (Series& series : protocol.series) {
    std::vector<double> values = extreme_comparisons(protocol, series);
    if (standard) values.push_back(series.standard);
    if (values.empty()) continue;
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
    series.pair = {*least, *greatest};
  }
  if (protocol.series.empty()) return;
  const Series& first = protocol.series.front();
  protocol.stimulus.reference = standard ? first.standard : 0.5 * (first.pair[0] + first.pair[1]);
}

void lint_task(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  const Task& task = task_of(protocol.task.kind);
  const Design& design = protocol.design;
  const int balance = task.balance_of(protocol.task);
  const bool counts = reading.sound("$.design.trials_per_cell") && reading.sound("$.design.sampling");
  if (levels_given(protocol) && counts && design.sampling == Sampling::balanced &&
      design.trials_per_cell % balance != 0) {
    const int below = design.trials_per_cell / balance * balance;
    reading.error_at(
        "$.design.trials_per_cell",
        reading.has_pairs() ? fmt::format("{} trials cannot hold the four pairs equally often", design.trials_per_cell)
                            : fmt::format("{} trials of each level cannot hold its {} orders equally often",
                                          design.trials_per_cell, balance),
        below == 0 && reading.has_pairs() ? "balanced sampling needs a multiple of 4: 4"
        : below == 0
            ? fmt::format("balanced sampling needs a multiple of {}", balance)
            : fmt::format("balanced sampling needs a multiple of {}: {} or {}", balance, below, below + balance));
  }
  for (std::size_t i = 0; i < protocol.series.size(); ++i) {
    const Series& series = protocol.series[i];
    const bool alike = std::find(series.levels.begin(), series.levels.end(), series.standard) != series.levels.end();
    if (alike && task.has_standard() && !task.level_may_be_standard())
      reading.error_at(protocol.series.size() > 1 ? fmt::format("$.standards[{}]", i) : std::string("$.levels"),
                       fmt::format("a level equals the standard, {}", plain(series.standard)),
                       "there is no correct answer to it: remove it");
  }
  if (const AdaptiveProcedure* procedure = reading.procedure();
      procedure != nullptr && !reading.has_pairs() && reading.sound(kProcedurePath)) {
    const NumberLimits limits = value_limits(protocol);
    for (const Series& series : protocol.series) {
      for (const double furthest : extreme_comparisons(protocol, series)) {
        if (furthest < limits.min || furthest > limits.max)
          reading.error_at(
              limits_path(*procedure),
              fmt::format("a comparison {} from the standard {} would have {} {}",
                          plain(plain_sum(furthest, -series.standard)), plain(series.standard), plain(furthest),
                          limits.unit),
              fmt::format("values lie between {} and {} {}", plain(limits.min), plain(limits.max), limits.unit));
      }
    }
  }
  if (protocol.rig.device == kSpecimenRig) lint_specimens(reading);
  for (const TaskProblem& problem : task.problems(protocol))
    reading.error_at(problem.path, problem.message, problem.suggestion);
}

}  // namespace jnd
