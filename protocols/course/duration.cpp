#include "protocols/course/duration.h"

#include <algorithm>
#include <cstddef>
#include <string>
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

Tally empty_tally(const Protocol& protocol) {
  Tally counts;
  counts.breaks.assign(protocol.breaks.size(), 0);
  counts.questions.assign(protocol.questions.size(), 0);
  return counts;
}

// A session, or what is left of it where it stands.
class Counting {
 public:
  Counting(const Protocol& protocol, const std::vector<int>& conditions, const Course* course)
      : protocol_(protocol), conditions_(conditions), course_(course), counts_(empty_tally(protocol)) {}

  void ask(const CoursePage& page) {
    for (const AskedPlace& asked : questions_on(page, protocol_, conditions_))
      if (!answered(page, asked)) ++counts_.questions[static_cast<std::size_t>(asked.question)];
  }
  void rest(const Break* pause, int after_trial) {
    if (pause == nullptr || (course_ != nullptr && course_->state().breaks_after.contains(after_trial))) return;
    ++counts_.breaks[static_cast<std::size_t>(pause - protocol_.breaks.data())];
  }
  void rest_within(const CourseBlock& block) {
    const auto each = static_cast<int>(block.end - block.begin);
    const int first = block.planned - each + 1;
    for (int done = course_ == nullptr ? first : std::max(first, course_->main_done()); done < block.planned; ++done)
      rest(break_within_block(done, protocol_), done);
  }
  // All but trials and free interaction.
  void count_around(const std::vector<CourseBlock>& blocks) {
    ask({Question::When::before_session, -1, 0});
    for (const CourseBlock& block : blocks) {
      if (!protocol_.explore) rest_within(block);
      for (const CoursePage& page : pages_after(block)) ask(page);
      rest(break_after(block, protocol_), block.planned);
    }
    ask({Question::When::after_session, -1, 0});
  }
  Tally& counts() noexcept { return counts_; }

 private:
  bool answered(const CoursePage& page, const AskedPlace& asked) const {
    if (course_ == nullptr) return false;
    const std::string name = asked.condition < 0 ? "" : condition_name(protocol_, asked.condition);
    return course_->state().answered.contains(
        question_key(question_of(asked.question, protocol_).id, name, page.after_trial));
  }

  const Protocol& protocol_;
  const std::vector<int>& conditions_;
  const Course* course_;
  Tally counts_;
};

Tally tally_of(const Protocol& protocol) {
  const std::vector<int> conditions = conditions_of(protocol, largest_plan(protocol));
  const std::vector<CourseBlock> blocks = course_blocks(protocol);
  Counting counting(protocol, conditions, nullptr);
  counting.count_around(blocks);
  Tally& counts = counting.counts();
  if (protocol.practice) counts.trials += protocol.practice->trials;
  for (const CourseBlock& block : blocks)
    (protocol.explore ? counts.explorations : counts.trials) +=
        protocol.explore ? 1 : static_cast<int>(block.end - block.begin);
  return counts;
}

double seconds_of(const Tally& counts, const Protocol& protocol, double trial_s) {
  double duration = counts.trials * trial_s;
  if (protocol.explore) duration += counts.explorations * protocol.explore->duration_s;
  for (std::size_t i = 0; i < protocol.breaks.size(); ++i) duration += counts.breaks[i] * protocol.breaks[i].duration_s;
  for (const int times : counts.questions) duration += times * kQuestion_s;
  return duration;
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

double expected_presented_s(const Protocol& protocol) {
  const double interval_s = kFirstContact_s + expected_exploration_s(protocol.timeline);
  return task_of(protocol.task.kind).expected_looks(protocol) * felt_intervals(protocol.task) * interval_s;
}

double expected_trial_s(const Protocol& protocol) {
  const Timeline& timeline = protocol.timeline;
  const double looks = task_of(protocol.task.kind).expected_looks(protocol);
  const double rest_of_look_s = (felt_intervals(protocol.task) - 1) * timeline.gap_s + kAnswer_s;
  return expected_presented_s(protocol) + looks * rest_of_look_s + (looks - 1) * timeline.gap_s +
         timeline.between_trials_s;
}

double expected_duration_s(const Protocol& protocol) {
  const Tally counts = tally_of(protocol);
  return seconds_of(counts, protocol, counts.trials > 0 ? expected_trial_s(protocol) : 0);
}

double expected_left_s(const Protocol& protocol, const Plan& plan, const Course& course,
                       std::optional<double> trial_s) {
  Counting counting(protocol, plan.conditions, &course);
  counting.count_around(course_blocks(protocol, plan));
  Tally& counts = counting.counts();
  if (protocol.explore)
    counts.explorations = static_cast<int>(plan.explorations.size()) - course.explorations_done();
  else
    counts.trials = course.main_left() + course.practice_left();
  return seconds_of(counts, protocol, counts.trials > 0 ? trial_s.value_or(expected_trial_s(protocol)) : 0);
}

}  // namespace jnd
