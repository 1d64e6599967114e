// The posterior of a task's response model: what the Bayesian procedure chooses from, and what all answers of a
// participant in a condition say together.
#pragma once

#include <span>
#include <vector>

#include "analysis/procedures/posterior.h"
#include "analysis/thresholds/adaptive_threshold.h"
#include "protocols/protocol.h"
#include "protocols/tasks/task.h"

namespace jnd {

// The response model of a series. Grid and prior that the protocol does not give are default_posterior() of the series'
// standard; the levels are the procedure's, or the ends of its clamp.
struct PosteriorModel {
  PosteriorConfiguration configuration;
  std::vector<double> distances;  // of each level of the configuration from the standard
};
// protocol: one with a procedure, of a task with a posterior_task().
PosteriorModel posterior_model(const Protocol& protocol, const Series& series);

// Whether grid and prior are all given, so that nothing follows from the standard.
bool names_whole_model(const PosteriorConfiguration& given) noexcept;

// Does a participant's threshold in a condition rest on the posterior of all answers there?
bool has_posterior_threshold(const Protocol& protocol) noexcept;

// One answer, as the configuration has levels and positive answers.
struct PosteriorAnswer {
  double level = 0;
  bool positive = false;
};
std::vector<PosteriorAnswer> posterior_answers(PosteriorTask task, std::span<const AnsweredTrial> trials);

struct PosteriorOfAnswers {
  AdaptiveThreshold threshold;
  PosteriorEstimate estimate, prior;
};
// The levels of the answers need not be those of the configuration, and their order changes rounding only.
PosteriorOfAnswers posterior_of_answers(const PosteriorConfiguration& configuration,
                                        std::span<const PosteriorAnswer> answers);

// Of a participant's trials of one condition and series.
PosteriorOfAnswers posterior_of_trials(const Protocol& protocol, const Series& series,
                                       std::span<const AnsweredTrial> trials);
// For a task's table: `factor` times the threshold and its interval; empty where there is none.
TaskEstimate posterior_estimate(const AdaptiveThreshold& threshold, double factor = 1);

}  // namespace jnd
