#include "protocols/tasks/abx_task.h"

#include <cmath>

#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/task_estimates.h"

namespace jnd {

void AbxTask::read(JsonReader&, TaskSpec& spec) const {
  spec.classes = {"A", "B"};
}

std::vector<DrawnTrial> AbxTask::draw(const CellDraw& cell, RandomStream& stream) const {
  std::vector<DrawnTrial> trials;
  for (const double level : cell.series.levels) {
    std::vector<DrawnTrial> arrangements;
    for (const Intervals& pair : orders_of(cell.series.standard, level, false))
      for (int x = 0; x < 2; ++x) arrangements.push_back({{pair[0], pair[1], pair[static_cast<std::size_t>(x)]}, x});
    add_level(trials, std::move(arrangements), cell.trials, cell.sampling, stream);
  }
  stream.shuffle(trials);
  return trials;
}

int AbxTask::target_of(const Intervals& stimuli, double, const TaskSpec&) const noexcept {
  if (stimuli[0] == stimuli[1]) return -1;
  return stimuli[2] == stimuli[0] ? 0 : stimuli[2] == stimuli[1] ? 1 : -1;
}

// X is taken for the one that it feels nearer to: the differencing strategy.
Answer AbxTask::answer(std::span<const Felt> felt, const Trial&, const Protocol&, RandomStream&) const {
  Answer answer;
  answer.said = std::abs(felt[2].value - felt[0].value) < std::abs(felt[2].value - felt[1].value) ? 0 : 1;
  return answer;
}

std::vector<TaskOutcome> AbxTask::outcomes(const Protocol& protocol) const {
  return choice_outcomes(protocol);
}

TaskEstimates AbxTask::estimate(const Protocol&, const Series& series, std::span<const AnsweredTrial> trials) const {
  return choice_estimates(ChoiceTask::abx_differencing, series, trials);
}

std::optional<TaskCurve> AbxTask::curve(const Protocol&, const Series&, std::span<const AnsweredTrial> trials) const {
  return choice_curve(ChoiceTask::abx_differencing, trials);
}

std::string AbxTask::methods(const Protocol&) const {
  return "The JND is the difference at d' = 1, with d' in proportion to the difference, by maximum likelihood under "
         "the differencing model of ABX (Macmillan and Creelman 2005); its interval is profile likelihood, 95 %. d' and the share of correct answers beside it are of all trials "
         "together. Status: ceiling, every answer was correct (JND 0); no_sensitivity, not better than chance (JND "
         "infinite).";
}

}  // namespace jnd
