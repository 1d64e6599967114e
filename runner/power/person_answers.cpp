#include "runner/power/person_answers.h"

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "protocols/planning/allotment.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/same_different_task.h"

namespace jnd {

namespace {

// "1": its number; what results call a participant does not matter here.
std::string name_of(int participant) {
  return fmt::format("{}", participant);
}

// Same-different with given levels.
void add_thresholds(DrawnPerson& person, int participant, const std::vector<PersonAnswer>& given,
                    const Protocol& protocol) {
  const ThresholdMethod method = registered_method(protocol);
  for (const int condition : conditions_of(protocol, person.group)) {
    std::vector<SeriesCounts> series;
    for (const Series& one : protocol.series) series.push_back({std::abs(one.pair[1] - one.pair[0]), {}});
    for (const PersonAnswer& one : given) {
      if (one.condition != condition) continue;
      series[static_cast<std::size_t>(one.series)].counts.add(one.trial.target == kClassSame,
                                                              one.trial.said == kClassDifferent);
    }
    add_threshold(person, participant, static_cast<std::size_t>(condition), series, protocol, method);
  }
}

void add_estimates(DrawnPerson& person, int participant, const PersonAnswers& answers, const Protocol& protocol) {
  std::map<std::pair<int, int>, std::vector<AnsweredTrial>> by_cell;  // condition and series
  for (const PersonAnswer& one : answers.given) by_cell[{one.condition, one.series}].push_back(one.trial);
  for (const auto& [place, trials] : by_cell) {
    std::vector<AdaptiveTrack> own;
    for (const AdaptiveTrack& track : answers.tracks)
      if (track.condition == place.first && track.series == place.second) own.push_back(track);
    TaskEstimateRow& row = person.estimates.emplace_back();
    row.participant = name_of(participant);
    row.group = person.group;
    row.condition = place.first;
    row.standard = place.second;
    row.trials = static_cast<int>(trials.size());
    row.estimates = measured_estimates(protocol, protocol.series[static_cast<std::size_t>(place.second)], trials, own);
  }
}

}  // namespace

void add_answers(std::vector<HierarchicalCell>& cells, std::size_t condition, double level, int positive,
                 int negative) {
  for (HierarchicalCell& cell : cells)
    if (cell.condition == static_cast<int>(condition) && cell.level == level) {
      cell.positive += positive;
      cell.negative += negative;
      return;
    }
  cells.push_back(
      {0, static_cast<int>(condition), level, static_cast<double>(positive), static_cast<double>(negative)});
}

void add_threshold(DrawnPerson& person, int participant, std::size_t condition, const std::vector<SeriesCounts>& series,
                   const Protocol& protocol, const ThresholdMethod& method) {
  TaskEstimateRow& row = person.estimates.emplace_back();
  row.participant = name_of(participant);
  row.group = person.group;
  row.condition = static_cast<int>(condition);
  const double reference = protocol.stimulus.reference;
  row.estimates = estimates_of(estimate_jnd(series, reference, method.method, method.correction), reference);
}

void add_measured(DrawnPerson& person, int participant, const PersonAnswers& answers, const Protocol& protocol) {
  const Task& task = task_of(protocol.task.kind);
  const AnswerModel observer = task.answer_model(protocol).value();
  const bool given_pairs = task.evidence(protocol) == Evidence::counts;
  for (const PersonAnswer& one : answers.given) {
    LevelAnswer answer = task.level_answer(one.trial, protocol.task);
    if (answer.level == 0 && given_pairs) {
      const std::array<double, 2>& pair = protocol.series[static_cast<std::size_t>(one.series)].pair;
      answer.level = observer.level_of_equal(std::abs(pair[1] - pair[0]));
    }
    add_answers(person.answers, static_cast<std::size_t>(one.condition), answer.level, answer.positive ? 1 : 0,
                answer.positive ? 0 : 1);
  }
  if (given_pairs)
    add_thresholds(person, participant, answers.given, protocol);
  else
    add_estimates(person, participant, answers, protocol);
}

}  // namespace jnd
