#include "protocols/course/duration.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "protocols/course/course.h"
#include "protocols/planning/allotment.h"
#include "protocols/tasks/task.h"

namespace jnd {
namespace {

constexpr double kFirstContact_s = 0.7;
constexpr double kAnswer_s = 1.5;
constexpr double kQuestion_s = 10;

// How often each thing comes in a session without a repeated trial.
struct Tally {
  int explorations = 0, trials = 0;
  std::vector<int> breaks, questions;  // by place in Protocol::breaks, Protocol::questions
};

Tally tally_of(const Protocol& protocol) {
  Tally counts;
  counts.breaks.assign(protocol.breaks.size(), 0);
  counts.questions.assign(protocol.questions.size(), 0);
  const std::vector<int> conditions = conditions_of(protocol, largest_plan(protocol));
  const auto ask = [&](const CoursePage& page) {
    for (const AskedPlace& asked : questions_on(page, protocol, conditions))
      ++counts.questions[static_cast<std::size_t>(asked.question)];
  };
  const auto rest = [&](const Break* pause) {
    if (pause != nullptr) ++counts.breaks[static_cast<std::size_t>(pause - protocol.breaks.data())];
  };
  ask({Question::When::before_session, -1, 0});
  if (protocol.practice) counts.trials += protocol.practice->trials;
  for (const CourseBlock& block : course_blocks(protocol)) {
    const auto each = static_cast<int>(block.end - block.begin);
    if (protocol.explore) {
      ++counts.explorations;
    } else {
      counts.trials += each;
      for (int done = block.planned - each + 1; done < block.planned; ++done) rest(break_within_block(done, protocol));
    }
    for (const CoursePage& page : pages_after(block, protocol.task.kind)) ask(page);
    rest(break_after(block, protocol));
  }
  ask({Question::When::after_session, -1, 0});
  return counts;
}

// From the first contact on. Who ends an interval themselves takes about 60 % of the longest (as simulated participants
// do), and a press about a second.
double expected_exploration_s(const Timeline& timeline) {
  constexpr double kShare = 0.6, kPress_s = 1;
  if (timeline.interval_end == IntervalEnd::key) return kShare * timeline.explore_s;
  if (timeline.interval_end == IntervalEnd::contacts) return std::min(timeline.explore_s, kPress_s * timeline.contacts);
  return timeline.explore_s;
}

}  // namespace

double expected_trial_s(const Protocol& protocol) {
  const Timeline& timeline = protocol.timeline;
  const Task& task = task_of(protocol.task.kind);
  const int intervals = felt_intervals(protocol.task);
  const double look_s =
      intervals * (kFirstContact_s + expected_exploration_s(timeline)) + (intervals - 1) * timeline.gap_s + kAnswer_s;
  const double looks = task.expected_looks(protocol);
  return looks * look_s + (looks - 1) * timeline.gap_s + timeline.between_trials_s;
}

double expected_duration_s(const Protocol& protocol) {
  const Tally counts = tally_of(protocol);
  double duration = 0;
  if (protocol.explore) duration += counts.explorations * protocol.explore->duration_s;
  if (counts.trials > 0) duration += counts.trials * expected_trial_s(protocol);
  for (std::size_t i = 0; i < protocol.breaks.size(); ++i) duration += counts.breaks[i] * protocol.breaks[i].duration_s;
  for (const int times : counts.questions) duration += times * kQuestion_s;
  return duration;
}

}  // namespace jnd
