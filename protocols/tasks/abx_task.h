// "Is X like A or like B?", three intervals: a standard and a comparison in either order, then one of them again.
//
// Its response models are independent observation and differencing (analysis/choice).
#pragma once

#include "protocols/tasks/task.h"

namespace jnd {

class AbxTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::abx; }
  std::string_view summary() const noexcept override {
    return "three intervals: is the third like the first or like the second?";
  }
  TaskStart start() const override;
  void read(JsonReader& section, TaskSpec& spec) const override;
  bool has_procedures() const noexcept override { return true; }
  int balance_of(const TaskSpec&) const noexcept override { return 4; }
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
