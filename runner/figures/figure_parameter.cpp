// The registered outcome, and the JND beside it, against the one number in which the conditions differ, such as a delay.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "analysis/group/group.h"
#include "analysis/numerics/special_values.h"
#include "protocols/planning/allotment.h"
#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr int kHollow = 6;  // grey
constexpr double kParameterLeft = 76, kParameterTop = 20, kParameterWidth = 460, kParameterHeight = 320,
                 kParameterRight = 30, kParameterBelow = 54;

// The one parameter in which the conditions differ, where it is a number in all of them, and another in each.
struct NumericParameter {
  std::string name;
  std::vector<double> values;  // by condition
};

std::optional<NumericParameter> numeric_parameter(const Protocol& protocol) {
  if (protocol.conditions.size() < 2) return std::nullopt;
  const Condition& first = protocol.conditions.front();
  std::optional<NumericParameter> found;
  for (const auto& entry : first.parameters) {
    const std::string& name = entry.first;
    const ParameterValue& value = entry.second;
    const bool same = std::all_of(protocol.conditions.begin(), protocol.conditions.end(), [&](const Condition& one) {
      const auto own = one.parameters.find(name);
      return own != one.parameters.end() && own->second == value;
    });
    if (same) continue;
    if (found) return std::nullopt;  // they differ in more than one
    found = NumericParameter{name, {}};
  }
  if (!found) return std::nullopt;
  for (const Condition& condition : protocol.conditions) {
    const auto own = condition.parameters.find(found->name);
    const double* const number = own == condition.parameters.end() ? nullptr : std::get_if<double>(&own->second);
    if (number == nullptr || condition.parameters.size() != first.parameters.size() || condition.cues != first.cues)
      return std::nullopt;
    found->values.push_back(*number);
  }
  // Conditions that have a value in common would count everyone twice there.
  if (std::set<double>(found->values.begin(), found->values.end()).size() < found->values.size()) return std::nullopt;
  return found;
}

// "delay (ms)" of "delay_ms": names of parameters end with their unit where they have one.
std::string parameter_title(const std::string& name) {
  constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"ms", "ms"}, {"s", "s"},   {"um", "µm"},   {"mm", "mm"}, {"cm", "cm"}, {"m", "m"},      {"n", "N"},
      {"hz", "Hz"}, {"deg", "°"}, {"rad", "rad"}, {"g", "g"},   {"kg", "kg"}, {"percent", "%"}};
  std::string title = name;
  const std::size_t last = name.rfind('_');
  if (last != std::string::npos && last > 0)
    for (const auto& [ending, unit] : kUnits)
      if (std::string_view(name).substr(last + 1) == ending) title = fmt::format("{} ({})", name.substr(0, last), unit);
  std::replace(title.begin(), title.end(), '_', ' ');
  return title;
}

// Conditions in the order of the parameter.
std::vector<std::size_t> by_parameter(const NumericParameter& parameter) {
  std::vector<std::size_t> order(parameter.values.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return parameter.values[a] < parameter.values[b]; });
  return order;
}

void draw_person(Svg& svg, const ParticipantValues& one, const NumericParameter& parameter,
                 const std::vector<std::size_t>& order, const Scale& x, const Scale& y) {
  std::vector<SvgPoint> corners;
  std::string words = fmt::format("{}:", one.participant);
  for (const std::size_t place : order) {
    if (!std::isfinite(one.values[place])) continue;
    corners.emplace_back(x.at(parameter.values[place]), y.at(one.values[place]));
    words += fmt::format(" {:g}: {}", parameter.values[place], size_text(one.values[place]));
  }
  svg.begin("point", words);
  if (corners.size() > 1) svg.polyline(corners, kFaint);
  for (const auto& [at_x, at_y] : corners) svg.circle(at_x, at_y, 2.8, condition_hollow(kHollow));
  svg.end();
}

// An outcome of everyone by condition.
struct OverParameter {
  std::string id, title, unit, what;  // what: "The registered outcome"
  std::vector<ParticipantValues> everyone;
};

OverParameter registered_over(const OutcomeComparison& outcome) {
  return {"parameter", outcome.title, outcome.unit, "The registered outcome", outcome.everyone};
}

// Where another outcome is registered, such as the PSE: the JND of the task beside it.
std::optional<OverParameter> jnd_over(const StudyResults& results, const Protocol& protocol) {
  const TaskResults& task = results.task;
  const auto jnd = std::find_if(task.outcomes.begin(), task.outcomes.end(),
                                [](const TaskOutcome& outcome) { return outcome.key == "jnd"; });
  const std::string_view registered = task.outcomes[task.registered].key;
  if (jnd == task.outcomes.end() || registered == "jnd" || registered == "weber") return std::nullopt;
  const auto place = static_cast<std::size_t>(jnd - task.outcomes.begin());
  OverParameter over{"parameter-jnd", compared_title(*jnd, protocol), jnd->unit, "The JND", {}};
  for (const ParticipantRows& one : by_participant(task.estimates, protocol.conditions.size())) {
    ParticipantValues values{one.participant, one.group, std::vector<double>(protocol.conditions.size(), kNaN), ""};
    for (const int condition : conditions_of(protocol, one.group)) {
      const auto at = static_cast<std::size_t>(condition);
      if (one.of[at] != nullptr) values.values[at] = outcome_value(*one.of[at], place, protocol);
      if (!std::isfinite(values.values[at])) values.missing = "no JND";
    }
    over.everyone.push_back(std::move(values));
  }
  return over;
}

// By the parameter, of everyone who has a value there.
std::map<double, std::vector<double>> values_by_parameter(const OverParameter& outcome,
                                                          const NumericParameter& parameter) {
  std::map<double, std::vector<double>> values;
  for (const ParticipantValues& one : outcome.everyone)
    for (std::size_t place = 0; place < one.values.size(); ++place)
      if (std::isfinite(one.values[place])) values[parameter.values[place]].push_back(one.values[place]);
  return values;
}

void draw_mean(Svg& svg, double at, const MeanEstimate& mean, const std::string& name, const Scale& x, const Scale& y) {
  svg.begin("mean", fmt::format("{} {:g}: mean {}, n = {}", name, at, size_text(mean.mean), mean.n));
  if (std::isfinite(mean.ci_low)) {
    svg.line(x.at(at), y.at(mean.ci_low), x.at(at), y.at(mean.ci_high), kInk);
    for (const double end : {mean.ci_low, mean.ci_high})
      svg.line(x.at(at) - 5, y.at(end), x.at(at) + 5, y.at(end), kInk);
  }
  svg.circle(x.at(at), y.at(mean.mean), 5, kInkFill);
  svg.end();
}

std::optional<Figure> parameter_figure(const OverParameter& outcome, const NumericParameter& parameter) {
  const std::map<double, std::vector<double>> values = values_by_parameter(outcome, parameter);
  if (values.size() < 2) return std::nullopt;
  std::map<double, MeanEstimate> means;
  double low = kInf, high = -kInf;
  for (const auto& [at, all] : values) {
    const MeanEstimate mean = means[at] = mean_with_ci(all);
    low = std::min({low, *std::min_element(all.begin(), all.end()), std::isfinite(mean.ci_low) ? mean.ci_low : low});
    high =
        std::max({high, *std::max_element(all.begin(), all.end()), std::isfinite(mean.ci_high) ? mean.ci_high : high});
  }
  const Panel panel{kParameterLeft, kParameterTop, kParameterLeft + kParameterWidth, kParameterTop + kParameterHeight};
  const Range x_range = round_range(means.begin()->first, means.rbegin()->first, 6),
              y_range = round_range(low, high, 6);
  constexpr double kInside = 14;  // marks stand clear of the frame
  const Scale x{x_range.low, x_range.high, panel.left + kInside, panel.right - kInside};
  const Scale y{y_range.low, y_range.high, panel.bottom, panel.top};
  const std::string name = parameter_title(parameter.name), title = fmt::format("{} against {}", outcome.title, name);
  std::string description;
  for (const auto& [at, mean] : means)
    description += fmt::format("{} {:g}: mean {} of {} participants. ", name, at, size_text(mean.mean), mean.n);
  Svg svg("figure-" + outcome.id, panel.right + kParameterRight, panel.bottom + kParameterBelow, title, description);
  draw_grid_rows(svg, panel, y, 6);
  svg.rectangle(panel.left, panel.top, panel.width(), panel.height(), kFrame);
  draw_x_axis(svg, panel, x, name, 6);
  draw_y_axis(svg, panel, y, outcome.unit.empty() ? outcome.title : fmt::format("{} ({})", outcome.title, outcome.unit),
              6);
  const std::vector<std::size_t> order = by_parameter(parameter);
  for (const ParticipantValues& one : outcome.everyone) draw_person(svg, one, parameter, order, x, y);
  std::vector<SvgPoint> corners;
  for (const auto& [at, mean] : means) corners.emplace_back(x.at(at), y.at(mean.mean));
  svg.polyline(corners, kInk);
  for (const auto& [at, mean] : means) draw_mean(svg, at, mean, name, x, y);
  int without = 0;
  for (const ParticipantValues& one : outcome.everyone) without += one.missing.empty() ? 0 : 1;
  return Figure{outcome.id, title,
                fmt::format("{} over the values of \"{}\", in which alone the conditions differ: each participant, "
                            "joined, and the mean with its 95 % confidence interval (Student t).{}",
                            outcome.what, parameter.name,
                            without > 0 ? fmt::format(" {} without a value in one of the conditions.",
                                                      counted(without, "participant"))
                                        : ""),
                std::move(svg)};
}

}  // namespace

std::vector<Figure> parameter_figures(const StudyResults& results, const Protocol& protocol) {
  const std::optional<NumericParameter> parameter = numeric_parameter(protocol);
  if (!parameter || results.registered() == nullptr) return {};
  std::vector<Figure> figures;
  const auto add = [&](const OverParameter& outcome) {
    if (std::optional<Figure> figure = parameter_figure(outcome, *parameter)) figures.push_back(std::move(*figure));
  };
  add(registered_over(*results.registered()));
  if (const std::optional<OverParameter> jnd = jnd_over(results, protocol)) add(*jnd);
  return figures;
}

}  // namespace jnd
