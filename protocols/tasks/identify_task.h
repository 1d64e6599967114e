// "Which of these was it?", one interval: one of N values, each with a name. No standard.
//
// What it measures is a confusion matrix: information transmitted in bits, with and without the correction of its bias,
// the share of correct answers, and d' between neighbours (analysis/ratings).
#pragma once

#include "protocols/tasks/task.h"

namespace jnd {

class IdentifyTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::identify; }
  std::string_view summary() const noexcept override { return "one interval: which of N named values was it?"; }
  std::string_view values_path() const noexcept override { return "$.classes"; }
  TaskStart start() const override;
  void read(JsonReader& section, TaskSpec& spec) const override;
  bool has_standard() const noexcept override { return false; }
  int intervals(const TaskSpec&) const noexcept override { return 1; }
  std::vector<DrawnTrial> arrangements(const CellDraw& cell, double comparison, int side) const override;
  int target_of(const Intervals& stimuli, double standard, const TaskSpec& spec) const noexcept override;
  Answer answer(std::span<const Felt> felt, const Trial& trial, const Protocol& protocol,
                RandomStream& stream) const override;
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override;
  TaskEstimates estimate(const Protocol& protocol, const Series& series,
                         std::span<const AnsweredTrial> trials) const override;
  std::string methods(const Protocol& protocol) const override;
};

}  // namespace jnd
