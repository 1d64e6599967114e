// "Is X like A or like B?", three intervals: a standard and a comparison in either order, then one of them again.
//
// Its response models are independent observation and differencing (analysis/choice).
#include <cmath>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/task.h"
#include "protocols/tasks/task_estimates.h"

namespace jnd {
namespace {

class AbxTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::abx; }
  std::string_view summary() const noexcept override {
    return "three intervals: is the third like the first or like the second?";
  }
  TaskStart start() const override {
    return {.asks = "Was the third like the first or like the second?",
            .keys = R"({"A": "a", "B": "b"})",
            .levels = {1.2, 1.35, 1.5},
            .trials_per_cell = 24,
            .analysis = R"({"outcome": "jnd"})"};
  }
  void read(JsonReader&, TaskSpec& spec) const override { spec.classes = {"A", "B"}; }
  bool has_procedures() const noexcept override { return true; }
  int balance_of(const TaskSpec&) const noexcept override { return 4; }
  int intervals(const TaskSpec&) const noexcept override { return 3; }
  // Either of the two first, and either of them once more as X.
  std::vector<DrawnTrial> arrangements(const CellDraw& cell, double comparison, int) const override {
    std::vector<DrawnTrial> arrangements;
    for (const Intervals& pair : orders_of(cell.series.standard, comparison, false))
      for (int x = 0; x < 2; ++x) arrangements.push_back({{pair[0], pair[1], pair[static_cast<std::size_t>(x)]}, x});
    return arrangements;
  }
  int target_of(const Intervals& stimuli, double, const TaskSpec&) const noexcept override {
    if (stimuli[0] == stimuli[1]) return -1;
    return stimuli[2] == stimuli[0] ? 0 : stimuli[2] == stimuli[1] ? 1 : -1;
  }
  // X is taken for the one that it feels nearer to: the differencing strategy.
  Answer answer(std::span<const Felt> felt, const Trial&, const Protocol&, RandomStream&) const override {
    Answer answer;
    answer.said = std::abs(felt[2].value - felt[0].value) < std::abs(felt[2].value - felt[1].value) ? 0 : 1;
    return answer;
  }
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override { return choice_outcomes(protocol); }
  TaskEstimates estimate(const Protocol&, const Series& series, std::span<const AnsweredTrial> trials) const override {
    return choice_estimates(ChoiceTask::abx_differencing, series, trials);
  }
  std::optional<TaskCurve> curve(const Protocol&, const Series&, std::span<const AnsweredTrial> trials) const override {
    return choice_curve(ChoiceTask::abx_differencing, trials);
  }
  std::string arrangement(const Protocol& protocol) const override {
    return fmt::format("Standard and comparison came first, and again as the third, {}. ", how_often(protocol));
  }
  // At d' = 1, which is of one interval's noise.
  std::optional<double> jnd_of_noise(const Protocol&) const override { return 1 / std::sqrt(2.0); }
  std::string methods(const Protocol&) const override {
    return "The JND is the difference at d' = 1, with d' in proportion to the difference, by maximum likelihood under "
           "the differencing model of ABX (Macmillan and Creelman 2005); its interval is profile likelihood, 95 %. d' and the share of correct answers beside it are of all trials "
           "together. There is no JND where the status is ceiling (every answer was correct) or no_sensitivity (not "
           "better than chance): its interval is open on one side.";
  }
};

}  // namespace

const Task& abx_task() noexcept {
  static const AbxTask task;
  return task;
}

}  // namespace jnd
