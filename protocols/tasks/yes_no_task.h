// "Was it there?", one interval: a signal, which is one of the levels, or noise, which is the standard. Answered with yes or
// no, or on a scale of sureness. Trials of noise are its catch trials.
//
// Its response model is that of signal detection: "yes" where what was felt exceeds a criterion; d' is the distance of
// signal and noise in units of the noise's standard deviation (analysis/detection, analysis/ratings).
#pragma once

#include "protocols/tasks/task.h"

namespace jnd {

class YesNoTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::yes_no; }
  std::string_view summary() const noexcept override { return "one interval: was the signal there?"; }
  TaskStart start() const override;
  void read(JsonReader& section, TaskSpec& spec) const override;
  bool has_procedures() const noexcept override { return true; }
  std::optional<PosteriorTask> posterior_task() const noexcept override { return PosteriorTask::same_different; }
  std::optional<AnswerModel> answer_model(const Protocol&) const override { return AnswerModel{.jnd = "threshold"}; }
  LevelAnswer level_answer(const AnsweredTrial& trial, const TaskSpec& spec) const override;
  bool has_catch_trials() const noexcept override { return true; }
  std::vector<TaskProblem> problems(const Protocol& protocol) const override;
  int trials_of_levels(const Protocol& protocol, const Series& series) const override;
  int intervals(const TaskSpec&) const noexcept override { return 1; }
  std::vector<DrawnTrial> draw(const CellDraw& cell, RandomStream& stream) const override;
  std::vector<DrawnTrial> draw_track(const CellDraw& track, const AdaptiveProcedure& procedure,
                                     RandomStream& stream) const override;
  int target_of(const Intervals& stimuli, double standard, const TaskSpec& spec) const noexcept override;
  Answer answer(std::span<const Felt> felt, const Trial& trial, const Protocol& protocol,
                RandomStream& stream) const override;
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override;
  TaskEstimates estimate(const Protocol& protocol, const Series& series,
                         std::span<const AnsweredTrial> trials) const override;
  std::optional<TaskCurve> curve(const Protocol& protocol, const Series& series,
                                 std::span<const AnsweredTrial> trials) const override;
  std::optional<double> jnd_of_noise(const Protocol& protocol) const override;
  std::string methods(const Protocol& protocol) const override;
};

}  // namespace jnd
