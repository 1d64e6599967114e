#include "runner/commands/starting_protocol.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "protocols/input/json_text.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/specimen_codes.h"
#include "protocols/protocol.h"
#include "protocols/tasks/task.h"
#include "runner/terminal/exit_code.h"

namespace jnd {
namespace {

using nlohmann::ordered_json;

// What a protocol says of its rig: the sections "rig" and "stimulus", a condition, and the value of the standard.
struct RigStart {
  std::string_view name, what;
  double standard = 0;
  std::string_view rig, stimulus, condition;
  std::array<std::string_view, 3> cues{};  // that it can give; of rigs that take any quantity none
};

constexpr auto kRigs = std::to_array<RigStart>({
    {"rrs3",
     "wearable devices that press and shear the fingertips",
     600,
     R"({"device": "rrs3", "fingers": ["thumb", "index"], "tracker": "hand", "separation_m": 0.13, "sphere_radius_m": 0.04})",
     R"({"quantity": "stiffness", "unit": "N/m", "expected_press_m": 0.004, "on_saturation": "flag"})",
     R"({"name": "S", "label": "force on the pulps", "cues": ["force"]})",
     {"force", "vibration"}},
    {"mckibben",
     "a finger exoskeleton that holds the joint back",
     25,
     R"({"device": "mckibben", "fingers": ["index"], "tracker": "encoder", "contact_flexion_rad": 0.1})",
     R"({"quantity": "stiffness", "unit": "N/rad", "expected_press_rad": 0.2, "on_saturation": "flag"})",
     R"({"name": "K", "label": "resistance of the joint", "cues": ["kinaesthetic"]})",
     {"kinaesthetic"}},
    {"rrs3+mckibben",
     "both on the index finger",
     600,
     R"({"device": "rrs3+mckibben", "fingers": ["index"], "tracker": "encoder", "contact_flexion_rad": 0.1})",
     R"({"quantity": "stiffness", "unit": "N/m", "expected_press_m": 0.004, "on_saturation": "flag"})",
     R"({"name": "CK", "label": "pulp and joint", "cues": ["force", "kinaesthetic"]})",
     {"force", "vibration", "kinaesthetic"}},
    {kExternalRig,
     "a device of your own, moved by a program of yours",
     500,
     R"({"device": "external"})",
     R"({"quantity": "stiffness", "unit": "N/m"})",
     R"({"name": "plain", "label": "the only condition"})",
     {}},
    {kSpecimenRig,
     "objects that the operator hands over",
     500,
     R"({"device": "specimens"})",
     R"({"quantity": "stiffness", "unit": "N/m"})",
     R"({"name": "plain", "label": "the only condition"})",
     {}},
});

constexpr std::array<std::string_view, 4> kClassNames{"soft", "medium", "firm", "hard"};

// The tasks' own questions are about stiffness.
std::string question_about(const std::string& quantity, const TaskStart& start) {
  return quantity == "stiffness" || start.asks_of_other.empty()
             ? std::string(start.asks)
             : fmt::format(fmt::runtime(start.asks_of_other), quantity);
}

const RigStart& rig_start(const std::string& name) {
  return *std::find_if(kRigs.begin(), kRigs.end(), [&](const RigStart& start) { return start.name == name; });
}

std::vector<double> values_of(const TaskStart& task, double standard) {
  std::vector<double> values;
  // In whole hundredths: 500 times 1.15 is 575.
  for (const double share : task.levels) values.push_back(std::round(share * standard * 100) / 100);
  return values;
}

ordered_json trial_section(const TaskStart& start, const Task& task, const TaskSpec& spec,
                           const std::string& question) {
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
  cues["question"] = {{"kind", "sound"}, {"say", question}};
  trial["cues"] = std::move(cues);
  if (!start.keys.empty()) trial["keys"] = json_from(start.keys);
  return trial;
}

// "soft", ...; of other than four classes their numbers.
std::string class_name(std::size_t place, std::size_t classes) {
  return classes == kClassNames.size() ? std::string(kClassNames[place]) : fmt::format("class-{}", place + 1);
}

void add_classes(ordered_json& protocol, const std::vector<double>& values) {
  ordered_json keys;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string name = class_name(i, values.size());
    protocol["classes"].push_back({{"name", name}, {"value", values[i]}});
    keys[name] = std::to_string(i + 1);
  }
  protocol["trial"]["keys"] = std::move(keys);
}

ordered_json conditions_section(const StartingPoint& point, const RigStart& rig) {
  if (point.conditions.empty()) return {json_from(rig.condition)};
  ordered_json list = ordered_json::array();
  for (const StartingPoint::Condition& condition : point.conditions) {
    list.push_back({{"name", condition.name}, {"label", condition.label}});
    if (!condition.cues.empty()) list.back()["cues"] = condition.cues;
  }
  return list;
}

ordered_json rating_question(const std::string& id, const char* when, const std::string& text) {
  constexpr int kMost = 9;
  return {{"id", id}, {"when", when}, {"kind", "rating"},    {"text", text},
          {"min", 1}, {"max", kMost}, {"low", "not at all"}, {"high", "completely"}};
}

ordered_json ratings_section(const std::vector<std::string>& ratings) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < ratings.size(); ++i)
    list.push_back(rating_question(fmt::format("rating-{}", i + 1), "after-session", ratings[i]));
  return list;
}

// What lies on the table, with codes that are in no order: each once, for up to 18 values.
ordered_json specimens(std::vector<double> values, double standard) {
  constexpr std::string_view kLetters = "ABDEHKLMPRTVWX", kDigits = "23456789";
  constexpr std::size_t kStep = 29;  // it and the number of codes have no divisor in common
  if (std::find(values.begin(), values.end(), standard) == values.end()) values.push_back(standard);
  std::sort(values.begin(), values.end());
  ordered_json list;
  std::size_t code = 0;
  for (const double value : values) {
    ordered_json codes = ordered_json::array();
    for (int i = 0; i < kAdvisedCodes; ++i, code += kStep)
      codes.push_back(std::string{kLetters[code / kDigits.size() % kLetters.size()], kDigits[code % kDigits.size()]});
    list.push_back({{"value", value}, {"codes", std::move(codes)}});
  }
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
  if (!task_of(point.task).has_pairs()) section["side"] = "above";
  section["stop"] = {{"trials", 40}};
  return section;
}

// Why the procedure is none for this task on this rig; empty where it is one.
std::string unfit_procedure(TaskKind task, const std::string& rig, const std::string& procedure) {
  if (procedure == "constant") return "";
  if (rig == kSpecimenRig) return "specimens have fixed values";
  if (!task_of(task).has_procedures())
    return fmt::format("the task {} has no levels that answers could set", to_string(task));
  if (procedure == "posterior" && !task_of(task).posterior_task())
    return fmt::format("the task {} has no response model that it could choose from", to_string(task));
  return "";
}

void require_fitting(const StartingPoint& point) {
  if (!task_of(point.task).has_trials() && point.rig != "rrs3")
    throw UsageError(fmt::format("free interaction takes the rig rrs3, not {}", point.rig));
  if (const std::string because = unfit_procedure(point.task, point.rig, point.procedure); !because.empty())
    throw UsageError(fmt::format("no {} here: {}; leave --procedure out", point.procedure, because));
}

ordered_json opening(std::string_view title) {
  return {{"$schema", "./protocol.schema.json"},
          {"format", 1},
          {"title", title},
          {"source", {{"citation", "Not published: a protocol to start from."}}}};
}

ordered_json exploring_protocol(const StartingPoint& point) {
  ordered_json protocol = opening(point.title);
  if (!point.language.empty()) protocol["language"] = point.language;
  protocol["rig"] = {{"device", "rrs3"}, {"fingers", {"thumb", "index"}}, {"tracker", "hand"}, {"separation_m", 0.13}};
  protocol["paradigm"] = "explore";
  protocol["explore"] = {{"duration_s", 60}, {"objects", {"sphere"}}};
  protocol["stimulus"] = {{"quantity", "stiffness"}, {"unit", "N/m"}, {"reference", 600}, {"expected_press_m", 0.004}};
  protocol["conditions"] = {{{"name", "S"}, {"label", "with the devices"}, {"cues", {"force"}}},
                            {{"name", "N"}, {"label", "bare hands"}, {"devices", false}}};
  protocol["design"] = {{"participants", *point.participants}, {"order", {{"conditions", "permuted"}}}};
  protocol["questions"] = ordered_json::array();
  protocol["questions"].push_back(rating_question("realism", "after-condition", "How real did the object feel?"));
  for (const ordered_json& rating : ratings_section(point.ratings)) protocol["questions"].push_back(rating);
  return protocol;
}

}  // namespace

std::vector<StartingRig> starting_rigs() {
  std::vector<StartingRig> rigs;
  for (const RigStart& rig : kRigs) rigs.push_back({rig.name, rig.what});
  return rigs;
}

std::vector<std::string_view> starting_cues(const std::string& rig) {
  const auto& cues = rig_start(rig).cues;
  return {cues.begin(), std::find(cues.begin(), cues.end(), std::string_view())};
}

std::vector<std::string> starting_procedures(TaskKind task, const std::string& rig) {
  std::vector<std::string> words = {"constant"};
  for (const auto& [word, kind] : procedure_words())
    if (unfit_procedure(task, rig, std::string(word)).empty()) words.emplace_back(word);
  return words;
}

StartingPoint filled_in(StartingPoint point) {
  constexpr int kParticipants = 12, kExploringParticipants = 8;
  const bool explores = !task_of(point.task).has_trials();
  if (point.title.empty())
    point.title = explores ? fmt::format("Free interaction on {}, to start from", point.rig)
                           : fmt::format("{} on {}, to start from", to_string(point.task), point.rig);
  if (!point.participants) point.participants = explores ? kExploringParticipants : kParticipants;
  if (explores) return point;
  const RigStart& rig = rig_start(point.rig);
  const TaskStart start = task_of(point.task).start();
  const ordered_json stimulus = json_from(rig.stimulus);
  if (point.quantity.empty()) point.quantity = stimulus["quantity"];
  if (point.question.empty()) point.question = question_about(point.quantity, start);
  if (point.unit.empty()) point.unit = stimulus["unit"];
  if (!point.standard) point.standard = rig.standard;
  if (!point.levels) point.levels = values_of(start, *point.standard);
  if (!point.trials_per_cell) point.trials_per_cell = start.trials_per_cell;
  return point;
}

ordered_json starting_protocol(const StartingPoint& given) {
  require_fitting(given);
  const StartingPoint point = filled_in(given);
  const Task& task = task_of(point.task);
  if (!task.has_trials()) return exploring_protocol(point);
  const RigStart& rig = rig_start(point.rig);
  const TaskStart start = task.start();
  const bool pairs = task.has_pairs();
  const bool adaptive = point.procedure != "constant";
  const std::vector<double>& values = *point.levels;
  const double standard = *point.standard;

  ordered_json protocol = opening(point.title);
  if (!point.language.empty()) protocol["language"] = point.language;
  protocol["rig"] = json_from(rig.rig);
  if (point.rig == kSpecimenRig) protocol["rig"]["specimens"] = specimens(values, standard);
  protocol["paradigm"] = to_string(point.task);
  protocol["trial"] = trial_section(start, task, {}, point.question);
  protocol["stimulus"] = json_from(rig.stimulus);
  protocol["stimulus"]["quantity"] = point.quantity;
  protocol["stimulus"]["unit"] = point.unit;
  if (pairs) protocol["stimulus"]["reference"] = standard;
  protocol["conditions"] = conditions_section(point, rig);
  if (point.task == TaskKind::identify) {
    add_classes(protocol, values);
  } else if (pairs && !adaptive) {
    for (std::size_t i = 0; i < values.size(); ++i)
      protocol["series"].push_back({{"name", fmt::format("pair-{}", i + 1)}, {"pair", {values[i], standard}}});
  } else if (!pairs) {
    if (task.has_standard()) protocol["standards"] = {{{"name", "standard"}, {"value", standard}}};
    if (!adaptive) protocol["levels"] = {{"absolute", values}};
  }
  ordered_json& design = protocol["design"];
  design["participants"] = *point.participants;
  if (!adaptive) design.update({{"trials_per_cell", *point.trials_per_cell}, {"sampling", "balanced"}});
  design["conditions"] = "blocked";
  design["order"] = {{"series", pairs && !adaptive ? "permuted" : "fixed"}, {"conditions", "permuted"}};
  if (adaptive) design["procedure"] = procedure_section(point, standard);
  protocol["instructions"] = {
      {{"id", "task"},
       {"when", "before-session"},
       {"text", fmt::format("In each trial you feel what is presented and answer the question: {}", point.question)}}};
  if (!point.ratings.empty()) protocol["questions"] = ratings_section(point.ratings);
  protocol["feedback"] = "none";
  protocol["analysis"] = json_from(start.analysis);
  return protocol;
}

}  // namespace jnd
