// How the answers were given: does the order of the two objects matter, is one answer preferred, does it change.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "runner/figures/figure.h"
#include "runner/figures/figure_forest.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr std::size_t kMostPeople = 40;  // with a row of their own
constexpr double kBehaviourRow = 22;

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
  const char *id, *title, *x_title, *caption;
  BehaviourValue (*of)(const BehaviourRow&);
};

constexpr std::array<BehaviourSubject, 3> kSubjects = {
    {{"order", "Order of the two objects", "share of \"different\": the stiffer object first minus second",
      "Among pairs of different objects, how much more often \"different\" was said where the stiffer object came "
      "first, with Newcombe's 95 % interval.",
      order_of},
     {"bias", "Preference for an answer", "criterion c: negative prefers \"different\", positive \"same\"",
      "Criterion of all trials together, with its 95 % interval (Wald). At 0 both answers are equally likely where "
      "nothing is felt.",
      bias_of},
     {"drift", "Change within the blocks", "d' in the second half of each cell's trials minus the first",
      "What is learnt or forgotten, or what tiredness takes: d' in the second half of each cell's trials less the "
      "first, with its 95 % interval (Wald).",
      drift_of}}};

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
    if (!std::isnan(value.holm)) row.numbers += fmt::format(", p = {}", p_value_text(value.holm));
  }
  row.words = fmt::format("{}: {}", name, row.numbers);
  return row;
}

Figure behaviour_figure(const BehaviourSubject& subject, const StudyBehaviour& behaviour, const Protocol& protocol) {
  Forest forest;
  forest.id = fmt::format("figure-{}", subject.id);
  forest.title = subject.title;
  forest.x_title = subject.x_title;
  forest.row = kBehaviourRow;
  for (const BehaviourRow& row : behaviour.conditions)
    forest.rows.push_back(
        forest_row(subject.of(row), fmt::format("{}, everyone", condition_text(protocol, row.condition)), true));
  for (const ForestRow& row : forest.rows) forest.description += row.words + ". ";
  const std::size_t people = std::min(behaviour.participants.size(), kMostPeople);
  for (std::size_t i = 0; i < people; ++i)
    forest.rows.push_back(
        forest_row(subject.of(behaviour.participants[i]), behaviour.participants[i].participant, false));
  const std::string more = people < behaviour.participants.size()
                               ? fmt::format(" The first {} of {} participants.", people, behaviour.participants.size())
                               : "";
  return {subject.id, subject.title,
          fmt::format("{} Above everyone together by condition, below each participant over all conditions; p is "
                      "Holm's over the rows of a kind. A cross: there is no value, for the reason at the right.{}",
                      subject.caption, more),
          draw_forest(forest)};
}

}  // namespace

std::vector<Figure> behaviour_figures(const StudyResults& results, const Protocol& protocol) {
  const auto* constant = std::get_if<ConstantResults>(&results.measured);
  if (constant == nullptr || !constant->detailed || constant->behaviour.participants.empty()) return {};
  std::vector<Figure> figures;
  for (const BehaviourSubject& subject : kSubjects)
    figures.push_back(behaviour_figure(subject, constant->behaviour, protocol));
  return figures;
}

}  // namespace jnd
