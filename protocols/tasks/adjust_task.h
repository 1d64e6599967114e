// "Make the second like the first", the method of adjustment: a standard, and beside it a value that keys move through
// the levels of the series, one at a time and to and fro, until the participant accepts it. The standard is presented
// again with every new value. No correct answer: what is accepted is the answer, a number.
//
// Half of the trials start below the standard, half above it. What is measured: the mean setting (PSE), the settings'
// scatter (JND = 0.6745 SD) and the effect of the starting side (analysis/scaling/adjustment.h).
#pragma once

#include "protocols/tasks/task.h"

namespace jnd {

class AdjustTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::adjust; }
  std::string_view summary() const noexcept override { return "a value is adjusted until it feels like the standard"; }
  TaskStart start() const override;
  void read(JsonReader& section, TaskSpec& spec) const override;
  std::vector<TaskProblem> problems(const Protocol& protocol) const override;
  bool level_may_be_standard() const noexcept override { return true; }
  int balance_of(const TaskSpec&) const noexcept override { return 2; }
  int cells_in(const Series&) const noexcept override { return 1; }
  int intervals(const TaskSpec&) const noexcept override { return 2; }
  std::vector<DrawnTrial> draw(const CellDraw& cell, RandomStream& stream) const override;
  std::string target_word(const Trial& trial, const TaskSpec& spec) const override;
  bool adjusts() const noexcept override { return true; }
  std::optional<Intervals> moved(const Intervals& now, const Answer& answer, const Trial& trial,
                                 const Protocol& protocol) const override;
  double expected_looks(const Protocol& protocol) const override;
  Answer settled(Answer answer, const Intervals& presented) const noexcept override;
  Answer answer(std::span<const Felt> felt, const Trial& trial, const Protocol& protocol,
                RandomStream& stream) const override;
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override;
  TaskEstimates estimate(const Protocol& protocol, const Series& series,
                         std::span<const AnsweredTrial> trials) const override;
  std::string arrangement(const Protocol& protocol) const override;
  std::string methods(const Protocol& protocol) const override;
};

}  // namespace jnd
