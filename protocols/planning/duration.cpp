#include "protocols/planning/duration.h"

namespace jnd {
namespace {

constexpr double kFirstContact_s = 0.7;
constexpr double kAnswer_s = 1.5;
constexpr double kQuestion_s = 10;

// Parts of a session that repeat the conditions; free interaction has one.
int parts_of(const Protocol& protocol) {
  return protocol.paradigm == Paradigm::explore ? 1 : static_cast<int>(protocol.series.size());
}

int times_asked(const Protocol& protocol, const Question& question) {
  const int series = parts_of(protocol);
  const auto conditions = static_cast<int>(protocol.conditions.size());
  switch (question.when) {
    case Question::When::before_session:
      return 1;
    case Question::When::after_condition:
      return series * conditions;
    case Question::When::after_series:
      return series;
    case Question::When::after_session:
      return question.per_condition ? conditions : 1;
  }
  return 0;
}

// Breaks stand between things: none comes after the last block, series or trial.
int times_taken(const Protocol& protocol, const Break& pause, int trials) {
  const int series = parts_of(protocol);
  const auto conditions = static_cast<int>(protocol.conditions.size());
  const int blocks = protocol.design.arrangement == Arrangement::mixed ? series : series * conditions;
  switch (pause.after) {
    case Break::After::block:
      return blocks - 1;
    case Break::After::series:
      return series - 1;
    case Break::After::trials:
      return (trials - 1) / pause.trials;
  }
  return 0;
}

}  // namespace

double expected_trial_s(const Timeline& timeline) {
  return 2 * (kFirstContact_s + timeline.explore_s) + timeline.gap_s + kAnswer_s + timeline.between_trials_s;
}

double expected_duration_s(const Protocol& protocol) {
  const int trials =
      protocol.design.trials_per_cell * static_cast<int>(protocol.series.size() * protocol.conditions.size());
  double duration = 0;
  if (protocol.explore) duration += static_cast<double>(protocol.conditions.size()) * protocol.explore->duration_s;
  const int practice = protocol.practice ? protocol.practice->trials : 0;
  duration += (trials + practice) * expected_trial_s(protocol.timeline);
  for (const Break& pause : protocol.breaks) duration += times_taken(protocol, pause, trials) * pause.duration_s;
  for (const Question& question : protocol.questions) duration += times_asked(protocol, question) * kQuestion_s;
  return duration;
}

}  // namespace jnd
