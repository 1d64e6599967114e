// "Which is the odd one?", three intervals: two of them alike, a standard and a comparison in either role. Directed, "which of
// the three is stiffer?": the comparison is always the greater, or the lesser (3AFC).
//
// Its response model is the Thurstonian triangle, where the two that feel nearest to each other are taken for alike;
// directed, that of three alternatives, where the greatest is chosen (analysis/choice).
#pragma once

#include "protocols/tasks/task.h"

namespace jnd {

class OddityTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::oddity; }
  std::string_view summary() const noexcept override { return "three intervals: which is the odd one?"; }
  TaskStart start() const override;
  void read(JsonReader& section, TaskSpec& spec) const override;
  bool has_procedures() const noexcept override { return true; }
  std::vector<TaskProblem> problems(const Protocol& protocol) const override;
  int balance_of(const TaskSpec& spec) const noexcept override { return spec.directed ? 3 : 6; }
  int intervals(const TaskSpec&) const noexcept override { return 3; }
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
