#include "runner/commands/starting_protocol.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "protocols/protocol.h"
#include "protocols/tasks/task.h"
#include "runner/terminal/exit_code.h"

namespace jnd {
namespace {

using nlohmann::ordered_json;

// What a protocol says of its rig: the sections "rig" and "stimulus", a condition, and the value of the standard.
struct RigStart {
  std::string_view name;
  double standard = 0;
  std::string_view rig, stimulus, condition;
};

constexpr auto kRigs = std::to_array<RigStart>({
    {"rrs3", 600,
     R"({"device": "rrs3", "fingers": ["thumb", "index"], "tracker": "hand", "separation_m": 0.13, "sphere_radius_m": 0.04})",
     R"({"quantity": "stiffness", "unit": "N/m", "expected_press_m": 0.004, "on_saturation": "flag"})",
     R"({"name": "S", "label": "force on the pulps", "cues": ["force"]})"},
    {"mckibben", 25,
     R"({"device": "mckibben", "fingers": ["index"], "tracker": "encoder", "contact_flexion_rad": 0.1})",
     R"({"quantity": "stiffness", "unit": "N/rad", "expected_press_rad": 0.2, "on_saturation": "flag"})",
     R"({"name": "K", "label": "resistance of the joint", "cues": ["kinaesthetic"]})"},
    {"rrs3+mckibben", 600,
     R"({"device": "rrs3+mckibben", "fingers": ["index"], "tracker": "encoder", "contact_flexion_rad": 0.1})",
     R"({"quantity": "stiffness", "unit": "N/m", "expected_press_m": 0.004, "on_saturation": "flag"})",
     R"({"name": "CK", "label": "pulp and joint", "cues": ["force", "kinaesthetic"]})"},
    {kExternalRig, 500, R"({"device": "external"})", R"({"quantity": "stiffness", "unit": "N/m"})",
     R"({"name": "plain", "label": "the only condition"})"},
    {kSpecimenRig, 500, R"({"device": "specimens"})", R"({"quantity": "stiffness", "unit": "N/m"})",
     R"({"name": "plain", "label": "the only condition"})"},
});

// What a protocol says of its task. Values are shares of the standard.
struct TaskStart {
  TaskKind kind;
  std::string_view asks;  // what is said after the intervals
  std::string_view keys;
  std::span<const double> levels;  // of identify the classes, of same-different the other value of each pair
  int trials_per_cell = 0;
  std::string_view analysis;
};

constexpr std::array kBothSides{0.5, 0.7, 0.85, 1.15, 1.3, 1.5};
constexpr std::array kAbove{1.2, 1.35, 1.5};
constexpr std::array kSignal{1.3};
constexpr std::array kSofter{0.5, 0.7};
constexpr std::array kClasses{0.5, 0.8, 1.15, 1.5};
constexpr std::array kSettings{0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5};
constexpr std::array<std::string_view, kClasses.size()> kClassNames{"soft", "medium", "firm", "hard"};

constexpr auto kTasks = std::to_array<TaskStart>({
    {TaskKind::same_different, "Same or different?", R"({"same": "s", "different": "d"})", kSofter, 24,
     R"({"model": "yes-no", "correction": "loglinear", "jnd": "least_squares"})"},
    {TaskKind::which, "Which was stiffer, the first or the second?", R"({"first": "1", "second": "2"})", kBothSides, 12,
     R"({"outcome": "jnd"})"},
    {TaskKind::yes_no, "Was it the stiffer one?", R"({"no": "n", "yes": "y"})", kSignal, 60,
     R"({"outcome": "threshold"})"},
    {TaskKind::identify, "Which one was it?", R"({"soft": "1", "medium": "2", "firm": "3", "hard": "4"})", kClasses, 15,
     R"({"outcome": "information"})"},
    {TaskKind::oddity, "Which was the odd one?", R"({"first": "1", "second": "2", "third": "3"})", kAbove, 24,
     R"({"outcome": "jnd"})"},
    {TaskKind::abx, "Was the third like the first or like the second?", R"({"A": "a", "B": "b"})", kAbove, 24,
     R"({"outcome": "jnd"})"},
    {TaskKind::magnitude, "How stiff was it?", "", kBothSides, 6, R"({"outcome": "exponent"})"},
    {TaskKind::adjust, "Less, more, or alike?", R"({"less": "1", "more": "2", "accept": "0"})", kSettings, 10,
     R"({"outcome": "jnd"})"},
});

const TaskStart& start_of(TaskKind task) {
  return *std::find_if(kTasks.begin(), kTasks.end(), [&](const TaskStart& start) { return start.kind == task; });
}

ordered_json parsed(std::string_view text) {
  return ordered_json::parse(text);
}

std::vector<double> values_of(const TaskStart& task, double standard) {
  std::vector<double> values;
  // In whole hundredths: 500 times 1.15 is 575.
  for (const double share : task.levels) values.push_back(std::round(share * standard * 100) / 100);
  return values;
}

ordered_json trial_section(const TaskStart& start, const Task& task, const TaskSpec& spec) {
  ordered_json trial = {{"explore_s", 3}, {"no_contact_time_out_s", 20}};
  const int intervals = task.intervals(spec);
  if (intervals > 1) trial["gap_s"] = 1;
  trial["between_trials_s"] = 1;
  trial["answer_time_out_s"] = 60;
  trial["max_attempts"] = 3;
  ordered_json cues;
  constexpr std::array kOrdinals{"first", "second", "third"};
  constexpr std::array kSaid{"First", "Second", "Third"};
  for (int i = 0; i < intervals; ++i) {
    const auto interval = static_cast<std::size_t>(i);
    cues[kOrdinals[interval]] = {{"kind", "sound"}, {"say", intervals == 1 ? "Now" : kSaid[interval]}};
  }
  cues["question"] = {{"kind", "sound"}, {"say", start.asks}};
  trial["cues"] = std::move(cues);
  if (!start.keys.empty()) trial["keys"] = parsed(start.keys);
  return trial;
}

// What lies on the table, with codes that are in no order.
ordered_json specimens(std::vector<double> values, double standard) {
  constexpr std::array kCodes{"K", "7", "T", "2", "M", "9", "D", "4", "X", "1", "R", "6",
                              "B", "8", "W", "3", "H", "5", "P", "0", "L", "A", "V", "E"};
  if (std::find(values.begin(), values.end(), standard) == values.end()) values.push_back(standard);
  std::sort(values.begin(), values.end());
  ordered_json list;
  // Every second code, and the others: each once, for up to 12 values, and never in a row.
  for (std::size_t i = 0; i < values.size(); ++i)
    list.push_back(
        {{"value", values[i]}, {"codes", {kCodes[14 * i % kCodes.size()], kCodes[(14 * i + 7) % kCodes.size()]}}});
  return list;
}

ordered_json procedure_section(const StartingPoint& point, double standard) {
  ordered_json section = {{"kind", point.procedure}};
  const bool catches = task_of(point.task).has_catch_trials();
  if (point.procedure == "posterior")
    section["levels"] = {{"from", 0.05 * standard}, {"to", 0.5 * standard}, {"step", 0.05 * standard}};
  else
    section.update({{"starts", {0.4 * standard}}, {"clamp", {0.02 * standard, 0.5 * standard}}});
  if (point.procedure == "posterior") {
    section["utility"] = "variance";
  } else if (point.procedure == "staircase") {
    section.update({{"up", 1},
                    {"down", 2},
                    {"step_up", 1.5},
                    {"step_down", 1.5},
                    {"multiplicative", true},
                    {"halve_after", {1, 2}}});
  } else {
    // The rate of correct answers by guessing; of tasks with catch trials that of false alarms.
    const double gamma = catches ? 0.1 : point.task == TaskKind::oddity ? 1.0 / 3 : 0.5;
    section.update({{"guess_sd", 0.5}, {"p_threshold", 0.75}, {"gamma", gamma}});
  }
  if (catches && point.procedure != "posterior") section["catch_share"] = 0.5;
  if (point.task != TaskKind::same_different) section["side"] = "above";
  section["stop"] = {{"trials", 40}};
  return section;
}

void require_fitting(const StartingPoint& point) {
  if (point.task == TaskKind::explore && point.rig != "rrs3")
    throw UsageError(fmt::format("free interaction takes the rig rrs3, not {}", point.rig));
  if (point.procedure == "constant") return;
  const auto refuse = [&](std::string_view because) {
    throw UsageError(fmt::format("no {} here: {}; leave --procedure out", point.procedure, because));
  };
  if (point.rig == kSpecimenRig) refuse("specimens have fixed values");
  if (point.task == TaskKind::explore || !task_of(point.task).has_procedures())
    refuse(fmt::format("the task {} has no levels that answers could set", to_string(point.task)));
  if (point.procedure == "posterior" && !task_of(point.task).posterior_task())
    refuse(fmt::format("the task {} has no response model that it could choose from", to_string(point.task)));
}

ordered_json opening(std::string_view title) {
  return {{"$schema", "./protocol.schema.json"},
          {"format", 1},
          {"title", title},
          {"source", {{"citation", "Not published: a protocol to start from."}}}};
}

ordered_json exploring_protocol() {
  ordered_json protocol = opening("Free interaction on rrs3, to start from");
  protocol["rig"] = {{"device", "rrs3"}, {"fingers", {"thumb", "index"}}, {"tracker", "hand"}, {"separation_m", 0.13}};
  protocol["paradigm"] = "explore";
  protocol["explore"] = {{"duration_s", 60}, {"objects", {"sphere"}}};
  protocol["stimulus"] = {{"quantity", "stiffness"}, {"unit", "N/m"}, {"reference", 600}, {"expected_press_m", 0.004}};
  protocol["conditions"] = {{{"name", "S"}, {"label", "with the devices"}, {"cues", {"force"}}},
                            {{"name", "N"}, {"label", "bare hands"}, {"devices", false}}};
  protocol["design"] = {{"participants", 8}, {"order", {{"conditions", "permuted"}}}};
  protocol["questions"] = {{{"id", "realism"},
                            {"when", "after-condition"},
                            {"kind", "rating"},
                            {"text", "How real did the object feel?"},
                            {"min", 1},
                            {"max", 9},
                            {"low", "not at all"},
                            {"high", "completely"}}};
  return protocol;
}

}  // namespace

ordered_json starting_protocol(const StartingPoint& point) {
  require_fitting(point);
  if (point.task == TaskKind::explore) return exploring_protocol();
  const auto& rig =
      *std::find_if(kRigs.begin(), kRigs.end(), [&](const RigStart& start) { return start.name == point.rig; });
  const TaskStart& start = start_of(point.task);
  const Task& task = task_of(point.task);
  const bool pairs = point.task == TaskKind::same_different;
  const bool adaptive = point.procedure != "constant";
  const std::vector<double> values = values_of(start, rig.standard);

  ordered_json protocol = opening(fmt::format("{} on {}, to start from", to_string(point.task), point.rig));
  protocol["rig"] = parsed(rig.rig);
  if (point.rig == kSpecimenRig) protocol["rig"]["specimens"] = specimens(values, rig.standard);
  protocol["paradigm"] = to_string(point.task);
  protocol["trial"] = trial_section(start, task, {});
  protocol["stimulus"] = parsed(rig.stimulus);
  if (pairs) protocol["stimulus"]["reference"] = rig.standard;
  protocol["conditions"] = {parsed(rig.condition)};
  if (point.task == TaskKind::identify) {
    for (std::size_t i = 0; i < values.size(); ++i)
      protocol["classes"].push_back({{"name", kClassNames[i]}, {"value", values[i]}});
  } else if (pairs && !adaptive) {
    for (std::size_t i = 0; i < values.size(); ++i)
      protocol["series"].push_back({{"name", fmt::format("pair-{}", i + 1)}, {"pair", {values[i], rig.standard}}});
  } else if (!pairs) {
    if (task.has_standard()) protocol["standards"] = {{{"name", "standard"}, {"value", rig.standard}}};
    if (!adaptive) protocol["levels"] = {{"absolute", values}};
  }
  ordered_json& design = protocol["design"];
  design["participants"] = 12;
  if (!adaptive) design.update({{"trials_per_cell", start.trials_per_cell}, {"sampling", "balanced"}});
  design["conditions"] = "blocked";
  design["order"] = {{"series", pairs && !adaptive ? "permuted" : "fixed"}, {"conditions", "permuted"}};
  if (adaptive) design["procedure"] = procedure_section(point, rig.standard);
  protocol["instructions"] = {
      {{"id", "task"},
       {"when", "before-session"},
       {"text", fmt::format("In each trial you feel what is presented and answer the question: {}", start.asks)}}};
  protocol["feedback"] = "none";
  protocol["analysis"] = parsed(start.analysis);
  return protocol;
}

}  // namespace jnd
