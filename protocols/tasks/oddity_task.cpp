#include "protocols/tasks/oddity_task.h"

#include <cmath>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/task_estimates.h"

namespace jnd {

void OddityTask::read(JsonReader&, TaskSpec& spec) const {
  spec.classes = {"first", "second", "third"};
}

namespace {

// Either of the two odd, in every place.
std::vector<DrawnTrial> triads_of(double standard, double comparison, int side = -1) {
  std::vector<DrawnTrial> triads;
  for (const auto& [odd, others] : {std::pair(comparison, standard), std::pair(standard, comparison)}) {
    for (std::size_t place = 0; place < 3; ++place) {
      Intervals stimuli{others, others, others};
      stimuli[place] = odd;
      triads.push_back({stimuli, static_cast<int>(place), side});
    }
  }
  return triads;
}

}  // namespace

std::vector<DrawnTrial> OddityTask::draw(const CellDraw& cell, RandomStream& stream) const {
  std::vector<DrawnTrial> trials;
  for (const double level : cell.series.levels)
    add_level(trials, triads_of(cell.series.standard, level), cell.trials, cell.sampling, stream);
  stream.shuffle(trials);
  return trials;
}

std::vector<DrawnTrial> OddityTask::draw_track(const CellDraw& track, RandomStream& stream) const {
  const double standard = track.series.standard;
  std::vector<DrawnTrial> block;
  for (const int side : track.protocol.design.procedure->sides) {
    const std::vector<DrawnTrial> triads = triads_of(standard, set_by_answers(standard), side);
    block.insert(block.end(), triads.begin(), triads.end());
  }
  return track_of(block, track.trials, stream);
}

int OddityTask::target_of(const Intervals& stimuli, double, const TaskSpec&) const noexcept {
  if (stimuli[0] == stimuli[1]) return stimuli[1] == stimuli[2] ? -1 : 2;
  return stimuli[0] == stimuli[2] ? 1 : stimuli[1] == stimuli[2] ? 0 : -1;
}

// The two that feel nearest to each other are taken for alike: the third is odd.
Answer OddityTask::answer(std::span<const Felt> felt, const Trial&, const Protocol&, RandomStream&) const {
  const auto distance = [&](std::size_t a, std::size_t b) { return std::abs(felt[a].value - felt[b].value); };
  const double d01 = distance(0, 1), d02 = distance(0, 2), d12 = distance(1, 2);
  Answer answer;
  answer.said = d12 < d01 && d12 < d02 ? 0 : d02 < d01 ? 1 : 2;
  return answer;
}

std::vector<TaskOutcome> OddityTask::outcomes(const Protocol& protocol) const {
  return choice_outcomes(protocol);
}

TaskEstimates OddityTask::estimate(const Protocol&, const Series& series, std::span<const AnsweredTrial> trials) const {
  return choice_estimates(ChoiceTask::oddity, series, trials);
}

std::optional<TaskCurve> OddityTask::curve(const Protocol&, const Series&,
                                           std::span<const AnsweredTrial> trials) const {
  return choice_curve(ChoiceTask::oddity, trials);
}

std::string OddityTask::arrangement(const Protocol& protocol) const {
  return fmt::format("Standard and comparison were the odd one, in each of the three places, {}. ",
                     how_often(protocol));
}

std::string OddityTask::methods(const Protocol&) const {
  return "The JND is the difference at d' = 1, with d' in proportion to the difference, by maximum likelihood under "
         "the Thurstonian model of the triangle, comparison of distances (Ennis 1993); its interval is profile likelihood, 95 %. d' and the share of correct answers beside it are of all trials "
         "together. There is no JND where the status is ceiling (every answer was correct) or no_sensitivity (not "
         "better than chance): its interval is open on one side.";
}

}  // namespace jnd
