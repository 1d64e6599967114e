// What several tasks need to turn answers into estimates.
#pragma once

#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/choice/choice_task.h"
#include "analysis/choice/two_interval.h"
#include "protocols/tasks/task.h"

namespace jnd {

// Infinite values and ends stay; a number that is none is no value.
TaskEstimate task_estimate(std::optional<double> value, std::optional<ChoiceBounds> interval = std::nullopt);
inline std::optional<double> defined(double value) noexcept {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

// The same times a number above 0.
TaskEstimate scaled(TaskEstimate estimate, double by) noexcept;

// The share of correct answers, with its exact 95 % interval (Clopper and Pearson 1934).
TaskEstimate share_correct(std::span<const AnsweredTrial> trials);

// How often the correct answer was given at each distance from the standard.
struct ChoiceCount {
  double difference = 0;  // > 0
  int n = 0, correct = 0;
};
std::vector<ChoiceCount> counts_by_difference(std::span<const AnsweredTrial> trials);

// The JND of a task whose chance of a correct answer is P(d'): the difference at d' = 1, with d' = difference / JND at
// every difference, by maximum likelihood with the profile interval. status: "ok"; "ceiling", every answer correct: 0;
// "no_sensitivity", the likelihood is highest where no difference is noticeable: infinite.
struct ChoiceJnd {
  std::string status;
  double jnd = 0, low = 0, high = 0;
};
ChoiceJnd choice_jnd(ChoiceTask task, std::span<const ChoiceCount> counts);

// Share of correct answers over the differences, with the fitted curve.
TaskCurve choice_curve(ChoiceTask task, std::span<const AnsweredTrial> trials);

// Outcomes and estimates that oddity and ABX share: the JND, d' of all trials, the share of correct answers.
std::vector<TaskOutcome> choice_outcomes(const Protocol& protocol);
TaskOutcome share_of_correct();
TaskEstimates choice_estimates(ChoiceTask task, const Series& series, std::span<const AnsweredTrial> trials);

// `steps` values from low to high, both among them.
std::vector<double> evenly(double low, double high, int steps);

}  // namespace jnd
