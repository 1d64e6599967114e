// "Are the two the same?": two intervals with a pair of values, drawn independently or in balance.
//
// What it measures is in the d' of its three models (analysis/detection) and the JNDs of several differences
// (analysis/thresholds); data/task_results/pair_cells.h has both.
#pragma once

#include "protocols/tasks/task.h"

namespace jnd {

// Its classes.
inline constexpr int kClassSame = 0, kClassDifferent = 1;

class SameDifferentTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::same_different; }
  std::string_view summary() const noexcept override { return "two intervals: are they the same or different?"; }
  void read(JsonReader& section, TaskSpec& spec) const override;
  std::vector<TaskProblem> problems(const Protocol& protocol) const override;
  bool has_procedures() const noexcept override { return true; }
  std::optional<PosteriorTask> posterior_task() const noexcept override { return PosteriorTask::same_different; }
  std::optional<AnswerModel> answer_model(const Protocol& protocol) const override;
  LevelAnswer level_answer(const AnsweredTrial& trial, const TaskSpec& spec) const override;
  bool has_pairs() const noexcept override { return true; }
  std::string_view first_class_key() const noexcept override { return "same"; }
  std::string_view values_path() const noexcept override { return "$.series"; }
  TaskStart start() const override;
  std::string without_model(const Protocol& protocol) const override;
  bool has_catch_trials() const noexcept override { return true; }
  int balance_of(const TaskSpec&) const noexcept override { return 4; }
  int trials_of_levels(const Protocol& protocol, const Series&) const override {
    return protocol.design.trials_per_cell;
  }
  Evidence evidence(const Protocol& protocol) const noexcept override;
  std::string cells_text(const Protocol& protocol) const override;
  int intervals(const TaskSpec&) const noexcept override { return 2; }
  // Each of (a, a), (b, b), (a, b), (b, a) equally often; or each interval drawn on its own, so that P(same) = 1/2.
  std::vector<DrawnTrial> draw(const CellDraw& cell, RandomStream& stream) const override;
  std::vector<DrawnTrial> draw_track(const CellDraw& track, const AdaptiveProcedure& procedure,
                                     RandomStream& stream) const override;
  // Of both classes, where there are two trials.
  std::vector<DrawnTrial> draw_practice(const CellDraw& round, RandomStream& stream) const override;
  int target_of(const Intervals& stimuli, double standard, const TaskSpec& spec) const noexcept override;
  // By the response model of its thresholds.
  std::optional<double> jnd_of_noise(const Protocol&) const override { return 1; }
  Answer answer(std::span<const Felt> felt, const Trial& trial, const Protocol& protocol,
                RandomStream& stream) const override;
  bool compares_cues() const noexcept override { return true; }
  // By the response model of the Bayesian procedure, with the criterion that its prior expects: "different" where
  // difference / noise, plus normal noise of SD 1, is above it.
  Answer unbiased_answer(const Intervals& presented, const Trial& trial, const Protocol& protocol, double noise,
                         RandomStream& stream) const override;
  std::string unbiased_words(const Protocol& protocol) const override;
  // A JND by the slope of d' on the difference; with a procedure the threshold of its tracks.
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override;
  TaskEstimates estimate(const Protocol& protocol, const Series& series,
                         std::span<const AnsweredTrial> trials) const override;
  std::string methods(const Protocol&) const override { return {}; }
};

}  // namespace jnd
