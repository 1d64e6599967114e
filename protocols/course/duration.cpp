#include "protocols/course/duration.h"

#include "protocols/course/course.h"

namespace jnd {
namespace {

constexpr double kFirstContact_s = 0.7;
constexpr double kAnswer_s = 1.5;
constexpr double kQuestion_s = 10;

double asking_s(const CoursePage& page, const Protocol& protocol) {
  return static_cast<double>(questions_on(page, protocol).size()) * kQuestion_s;
}

double rest_s(const Break* pause) {
  return pause == nullptr ? 0 : pause->duration_s;
}

// The trials of a block, or its exploration, and the breaks between them.
double block_s(const CourseBlock& block, const Protocol& protocol) {
  if (protocol.paradigm == Paradigm::explore) return protocol.explore ? protocol.explore->duration_s : 0;
  const auto trials = static_cast<int>(block.end - block.begin);
  double duration = trials * expected_trial_s(protocol.timeline);
  for (int done = block.planned - trials + 1; done < block.planned; ++done)
    duration += rest_s(break_within_block(done, protocol));
  return duration;
}

}  // namespace

double expected_trial_s(const Timeline& timeline) {
  return 2 * (kFirstContact_s + timeline.explore_s) + timeline.gap_s + kAnswer_s + timeline.between_trials_s;
}

double expected_duration_s(const Protocol& protocol) {
  double duration = asking_s({Question::When::before_session, -1, 0}, protocol);
  if (protocol.practice) duration += protocol.practice->trials * expected_trial_s(protocol.timeline);
  for (const CourseBlock& block : course_blocks(protocol)) {
    duration += block_s(block, protocol);
    for (const CoursePage& page : pages_after(block, protocol.paradigm)) duration += asking_s(page, protocol);
    duration += rest_s(break_after(block, protocol));
  }
  return duration + asking_s({Question::When::after_session, -1, 0}, protocol);
}

}  // namespace jnd
