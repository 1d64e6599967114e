// "Which is stiffer?", two-interval forced choice: a standard and a comparison, in either order or the standard first.
//
// Its response model: P(comparison chosen) = lapse / 2 + (1 - lapse) F((x - PSE) / s + b o), with o = +1 where the
// comparison came second and -1 where it came first (analysis/choice/two_interval.h).
#pragma once

#include "protocols/tasks/task.h"

namespace jnd {

class WhichTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::which; }
  std::string_view summary() const noexcept override { return "two intervals: which has more of the quantity?"; }
  TaskStart start() const override;
  void read(JsonReader& section, TaskSpec& spec) const override;
  std::vector<TaskProblem> problems(const Protocol& protocol) const override;
  bool level_may_be_standard() const noexcept override { return true; }
  bool has_procedures() const noexcept override { return true; }
  std::optional<PosteriorTask> posterior_task() const noexcept override { return PosteriorTask::which; }
  std::optional<AnswerModel> answer_model(const Protocol& protocol) const override;
  LevelAnswer level_answer(const AnsweredTrial& trial, const TaskSpec& spec) const override;
  int balance_of(const TaskSpec& spec) const noexcept override { return spec.standard_first ? 1 : 2; }
  int intervals(const TaskSpec&) const noexcept override { return 2; }
  std::vector<DrawnTrial> arrangements(const CellDraw& cell, double comparison, int side) const override;
  int target_of(const Intervals& stimuli, double standard, const TaskSpec& spec) const noexcept override;
  Answer answer(std::span<const Felt> felt, const Trial& trial, const Protocol& protocol,
                RandomStream& stream) const override;
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override;
  TaskEstimates estimate(const Protocol& protocol, const Series& series,
                         std::span<const AnsweredTrial> trials) const override;
  std::optional<TaskCurve> curve(const Protocol& protocol, const Series& series,
                                 std::span<const AnsweredTrial> trials) const override;
  std::string arrangement(const Protocol& protocol) const override;
  std::optional<double> jnd_of_noise(const Protocol& protocol) const override;
  std::string methods(const Protocol& protocol) const override;
};

}  // namespace jnd
