// "How stiff is it?", one interval, answered with a number; beside a modulus, two: first a standard that is given its
// number, then the value to be judged. No correct answer.
//
// What it measures is the exponent of a power law, after the participants' moduli are made equal (analysis/scaling).
#pragma once

#include "protocols/tasks/task.h"

namespace jnd {

class MagnitudeTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::magnitude; }
  std::string_view summary() const noexcept override { return "one interval: a number for how much it was"; }
  TaskStart start() const override;
  void read(JsonReader& section, TaskSpec& spec) const override;
  bool has_standard() const noexcept override { return false; }
  int intervals(const TaskSpec& spec) const noexcept override { return spec.modulus ? 2 : 1; }
  std::vector<DrawnTrial> arrangements(const CellDraw& cell, double comparison, int side) const override;
  Answer answer(std::span<const Felt> felt, const Trial& trial, const Protocol& protocol,
                RandomStream& stream) const override;
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override;
  TaskEstimates estimate(const Protocol& protocol, const Series& series,
                         std::span<const AnsweredTrial> trials) const override;
  std::string methods(const Protocol& protocol) const override;
};

}  // namespace jnd
