// How the answers were given: does the order of the two objects matter, is one answer preferred, does it change.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "runner/drawing/figure_forest.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr std::size_t kMostPeople = 40;  // with a row of their own
constexpr double kBehaviourNames = 110, kBehaviourPlot = 230, kBehaviourRow = 18;

// One quantity of a row; status: empty, or why there is no value.
struct BehaviourValue {
  double value = kNaN, low = kNaN, high = kNaN;
  double holm = kNaN;
  std::string status{};
};

std::string reason(OrderStatus status) {
  constexpr auto kReasons = words<OrderStatus>({{"", OrderStatus::ok},
                                                {"the stiffer never came first", OrderStatus::no_stiffer_first},
                                                {"the stiffer never came second", OrderStatus::no_stiffer_second},
                                                {"no trial of different objects", OrderStatus::no_different_trials}});
  return std::string(word_of(kReasons, status));
}

std::string reason(RateStatus status) {
  constexpr auto kReasons = words<RateStatus>({{"", RateStatus::ok},
                                               {"all answers were the same", RateStatus::no_information},
                                               {"no trial of one kind", RateStatus::missing}});
  return std::string(word_of(kReasons, status));
}

BehaviourValue order_of(const BehaviourRow& row) {
  if (row.order.status != OrderStatus::ok) return {.status = reason(row.order.status)};
  return {row.order.difference, row.order.ci_low, row.order.ci_high, row.holm.order};
}

BehaviourValue bias_of(const BehaviourRow& row) {
  if (row.bias.status != RateStatus::ok) return {.status = reason(row.bias.status)};
  return {row.bias.criterion, row.bias.ci_low, row.bias.ci_high, row.holm.bias};
}

BehaviourValue drift_of(const BehaviourRow& row) {
  if (row.drift.status != RateStatus::ok) return {.status = reason(row.drift.status)};
  const HalfDifference& change = row.drift.dprime;
  return {change.difference, change.ci_low, change.ci_high, row.holm.drift};
}

struct BehaviourSubject {
  const char *title, *x_title;
  BehaviourValue (*of)(const BehaviourRow&);
};

constexpr std::array<BehaviourSubject, 3> kSubjects = {
    {{"Order of the two objects", "stiffer object first − second", order_of},
     {"Preference for an answer", "criterion c", bias_of},
     {"Change within the blocks", "d' of the second half − first", drift_of}}};

ForestRow forest_row(const BehaviourValue& value, const std::string& name, bool of_group) {
  ForestRow row{.name = name,
                .value = value.value,
                .low = value.low,
                .high = value.high,
                .numbers = value.status,
                .words = {},
                .of_group = of_group};
  if (value.status.empty()) {
    row.numbers = fmt::format("{} ({})", number_text(value.value, 2), range_text(value.low, value.high, 2));
    if (!std::isnan(value.holm)) row.numbers += ", " + p_text(value.holm);
  }
  row.words = fmt::format("{}: {}", name, row.numbers);
  return row;
}

ForestColumn behaviour_column(const BehaviourSubject& subject, const StudyBehaviour& behaviour, std::size_t people,
                              const Protocol& protocol) {
  ForestColumn column{.title = subject.title, .x_title = subject.x_title, .rows = {}};
  for (const BehaviourRow& row : behaviour.conditions)
    column.rows.push_back(
        forest_row(subject.of(row), fmt::format("{}, everyone", condition_text(protocol, row.condition)), true));
  for (std::size_t i = 0; i < people; ++i)
    column.rows.push_back(
        forest_row(subject.of(behaviour.participants[i]), behaviour.participants[i].participant, false));
  return column;
}

}  // namespace

std::vector<Figure> behaviour_figures(const StudyResults& results, const Protocol& protocol) {
  const StudyBehaviour& behaviour = results.behaviour;
  if (behaviour.participants.empty()) return {};
  const std::size_t people = std::min(behaviour.participants.size(), kMostPeople);
  Forest forest;
  forest.id = "figure-behaviour";
  forest.title = "How the answers were given";
  forest.names = kBehaviourNames;
  forest.plot = kBehaviourPlot;
  forest.numbers = 0;
  forest.between = 36;
  forest.row = kBehaviourRow;
  for (const BehaviourSubject& subject : kSubjects) {
    const ForestColumn& column = forest.columns.emplace_back(behaviour_column(subject, behaviour, people, protocol));
    forest.description += fmt::format("{}: ", column.title);
    for (std::size_t i = 0; i < behaviour.conditions.size(); ++i)
      forest.description += column.rows[i].words + (i + 1 < behaviour.conditions.size() ? "; " : ". ");
  }
  const std::string caption =
      "Everyone together by condition, then each participant over all conditions, with 95 % intervals. Left: among "
      "pairs of different objects, how much more often \"different\" was said where the stiffer object came first "
      "(Miettinen and Nurminen). Middle: the criterion of all trials together (Wald); negative prefers \"different\", positive "
      "\"same\", and at 0 both are equally likely where nothing is felt. Right: what is learnt or forgotten, or what "
      "tiredness takes, d' in the second half of each cell's trials less the first (Wald). A cross: there is no value; "
      "the table of the same name has the numbers, their p, and the reasons.";
  return {{"behaviour", forest.title, caption + first_of(people, behaviour.participants.size()), draw_forest(forest),
           draw_forest(forest, false)}};
}

}  // namespace jnd
