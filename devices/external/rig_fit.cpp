#include "devices/external/rig_fit.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocols/input/json_reader.h"

namespace jnd {

namespace {

constexpr std::size_t kMostProblems = 20;

const std::string& name_of(const RigParameter& parameter) {
  return std::visit([](const auto& its) -> const std::string& { return its.name; }, parameter);
}

const RigParameter* find_parameter(const RigHello& hello, const std::string& name) {
  const auto found = std::find_if(hello.parameters.begin(), hello.parameters.end(),
                                  [&](const RigParameter& parameter) { return name_of(parameter) == name; });
  return found == hello.parameters.end() ? nullptr : &*found;
}

bool is_within(double value, const RigRange& range) noexcept {
  return std::isfinite(value) && value >= range.min && value <= range.max;
}

// Empty: it fits.
std::string quantity_problem(const std::string& quantity, const std::string& unit, const RigHello& hello,
                             const RigRange*& found) {
  found = nullptr;
  std::vector<std::string> known;
  for (const RigRange& range : hello.quantities) {
    if (range.name == quantity) found = &range;
    known.push_back(range.name);
  }
  if (found == nullptr)
    return fmt::format("the rig cannot present {}: it presents {}", quantity, fmt::join(known, ", "));
  if (found->unit != unit)
    return fmt::format("{} is in {} here and in {} for the rig", quantity, unit.empty() ? "no unit" : unit,
                       found->unit.empty() ? "no unit" : found->unit);
  return {};
}

// What a channel of the rig may be called: its peaks are "peak_" and its name.
std::string_view peak_of(std::string_view measure) noexcept {
  constexpr std::string_view kPeak = "peak_";
  return measure == "depth" ? "depth" : measure.starts_with(kPeak) ? measure.substr(kPeak.size()) : std::string_view();
}

bool is_measured(std::string_view measure, const RigHello& hello) {
  if (measure == "contacts") return true;  // every `done` says how many
  return std::any_of(hello.measures.begin(), hello.measures.end(), [&](const RigChannel& channel) {
    return channel.name == measure || (!peak_of(measure).empty() && channel.name == peak_of(measure));
  });
}

std::string names_of_measure(std::string_view measure) {
  const std::string_view peak = peak_of(measure);
  return peak.empty() || peak == measure ? std::string(measure) : fmt::format("{} or {}", peak, measure);
}

std::string parameter_problem(const std::string& name, const RigParameterValue& value, const RigHello& hello) {
  const RigParameter* parameter = find_parameter(hello, name);
  if (parameter == nullptr) {
    std::vector<std::string> known;
    for (const RigParameter& its : hello.parameters) known.push_back(name_of(its));
    return fmt::format("the rig has no parameter {}: it has {}", name,
                       known.empty() ? std::string("none") : fmt::format("{}", fmt::join(known, ", ")));
  }
  if (const auto* range = std::get_if<RigRange>(parameter)) {
    const auto* number = std::get_if<double>(&value);
    if (number == nullptr) return fmt::format("{} is a word here and a number for the rig", name);
    if (!is_within(*number, *range))
      return fmt::format("{} {} is out of the rig's range, {}", name, rig_value_text(*number, range->unit),
                         rig_range_text(*range));
    return {};
  }
  const auto& choice = std::get<RigChoice>(*parameter);
  const auto* word = std::get_if<std::string>(&value);
  if (word == nullptr) return fmt::format("{} is a number here and one of some words for the rig", name);
  if (std::find(choice.words.begin(), choice.words.end(), *word) == choice.words.end())
    return fmt::format("{} {} is none of the rig's: {}", name, *word, fmt::join(choice.words, ", "));
  return {};
}

std::vector<std::string> parameter_problems(const std::map<std::string, RigParameterValue>& parameters,
                                            const RigHello& hello) {
  std::vector<std::string> problems;
  for (const auto& [name, value] : parameters)
    if (std::string problem = parameter_problem(name, value, hello); !problem.empty())
      problems.push_back(std::move(problem));
  for (const RigParameter& parameter : hello.parameters)
    if (!parameters.contains(name_of(parameter)))
      problems.push_back(fmt::format("the rig's parameter {} is not given", name_of(parameter)));
  return problems;
}

std::string value_problem(double value, const RigRange& range) {
  if (is_within(value, range)) return {};
  return fmt::format("{} is out of the rig's range, {}", rig_value_text(value, range.unit), rig_range_text(range));
}

}  // namespace

std::string rig_value_text(double value, const std::string& unit) {
  return unit.empty() ? plain(value) : fmt::format("{} {}", plain(value), unit);
}

std::string rig_range_text(const RigRange& range) {
  return fmt::format("{} {} to {}", range.name, plain(range.min), rig_value_text(range.max, range.unit));
}

std::vector<std::string> rig_problems(const RigDemand& demand, const RigHello& hello) {
  std::vector<std::string> problems;
  const auto add = [&](std::string problem) {
    if (problem.empty() || std::find(problems.begin(), problems.end(), problem) != problems.end()) return;
    if (problems.size() < kMostProblems) problems.push_back(std::move(problem));
  };
  const RigRange* range = nullptr;
  add(quantity_problem(demand.quantity, demand.unit, hello, range));
  if (range != nullptr)
    for (const double value : demand.values) add(value_problem(value, *range));
  for (const auto& parameters : demand.conditions)
    for (std::string& problem : parameter_problems(parameters, hello)) add(std::move(problem));
  for (const std::string& measure : demand.measures)
    if (!is_measured(measure, hello))
      add(fmt::format("{} is held against limits, and the rig does not measure it: \"measures\" would say {}", measure,
                      names_of_measure(measure)));
  if (demand.places > hello.places) add("two values are to be felt side by side, and the rig presents one at a time");
  if (demand.gap_s && hello.holds && *demand.gap_s < hello.ready_s)
    add(fmt::format("the rig needs up to {0} s to get ready for a value, and gap_s is {1} s: make it at least {0}",
                    plain(hello.ready_s), plain(*demand.gap_s)));
  if (demand.answers && !hello.answers) add("participants are to answer on the rig, and it has no buttons");
  if (demand.real && hello.model)
    add("the rig is a model in software by its own word: what is felt with it is no real data");
  return problems;
}

std::vector<std::string> rig_cautions(const RigDemand& demand, const RigHello& hello) {
  if (hello.holds || !demand.gap_s) return {};
  return {
      "the rig cannot hold what it has prepared, so it gets ready between the cue and the stimulus: how long that takes "
      "can tell everybody present how far a value is from the one before, and so same from different"};
}

bool is_same_rig(const RigHello& before, const RigHello& now) {
  const auto facts = [](const RigHello& its) {
    return std::tie(its.name, its.version, its.serial, its.model, its.answers, its.places, its.ready_s, its.holds,
                    its.quantities, its.parameters, its.measures);
  };
  return facts(before) == facts(now);
}

std::string rig_request_problem(const RenderRequest& request, const RigHello& hello) {
  const RigRange* range = nullptr;
  if (std::string problem = quantity_problem(request.quantity, request.unit, hello, range); !problem.empty())
    return problem;
  if (std::string problem = value_problem(request.value, *range); !problem.empty()) return problem;
  if (request.beside) {
    if (hello.places < 2) return "the rig presents one value at a time";
    if (std::string problem = value_problem(*request.beside, *range); !problem.empty()) return problem;
  }
  std::vector<std::string> problems = parameter_problems(request.parameters, hello);
  if (problems.empty() && request.beside_parameters) problems = parameter_problems(*request.beside_parameters, hello);
  return problems.empty() ? std::string() : problems.front();
}

}  // namespace jnd
