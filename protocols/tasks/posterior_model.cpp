#include "protocols/tasks/posterior_model.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/decimal_order.h"
#include "analysis/procedures/posterior.h"

namespace jnd {
namespace {

// Of a list of levels as a configuration has them, so that an answer finds the place of its own.
std::vector<double> levels_of(std::span<const PosteriorAnswer> answers) {
  std::vector<double> levels;
  for (const PosteriorAnswer& answer : answers) levels.push_back(answer.level);
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

bool is_highest_at_end(const PosteriorProcedure& posterior) {
  std::vector<double> masses;
  posterior.ln_s_masses(masses);
  const auto highest = std::max_element(masses.begin(), masses.end());
  return highest == masses.begin() || highest + 1 == masses.end();
}

void set_levels(PosteriorModel& model, const AdaptiveProcedure& procedure) {
  std::vector<double> distances = procedure.posterior.levels;
  if (distances.empty()) distances.assign(procedure.clamp.begin(), procedure.clamp.end());
  PosteriorConfiguration& c = model.configuration;
  if (c.task == PosteriorTask::same_different) {
    c.levels = {0};
    c.levels.insert(c.levels.end(), distances.begin(), distances.end());
    model.distances = c.levels;
    return;
  }
  for (const int side : procedure.sides) {
    for (const double distance : distances) {
      c.levels.push_back(plain_sum(c.standard, side * distance));
      model.distances.push_back(distance);
    }
    if (side > 0) continue;  // those below the standard ascend too
    std::reverse(c.levels.begin(), c.levels.end());
    std::reverse(model.distances.begin(), model.distances.end());
  }
}

}  // namespace

PosteriorModel posterior_model(const Protocol& protocol, const Series& series) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  const PosteriorConfiguration& given = procedure.posterior;
  PosteriorModel model;
  PosteriorConfiguration& c = model.configuration;
  c = default_posterior(task_of(protocol.task.kind).posterior_task().value(), series.standard);
  c.utility = given.utility;
  if (!given.ln_s.empty()) c.ln_s = given.ln_s;
  if (!given.shift.empty()) c.shift = given.shift;
  if (!given.lapse.empty()) c.lapse = given.lapse;
  // Of other procedures nothing of it was read.
  const bool was_read = has_posterior_threshold(protocol);
  if (was_read && given.ln_s_prior.sd > 0) c.ln_s_prior = given.ln_s_prior;
  if (was_read && given.shift_prior.sd > 0) c.shift_prior = given.shift_prior;
  if (!given.lapse_weights.empty()) c.lapse_weights = given.lapse_weights;
  set_levels(model, procedure);
  return model;
}

bool names_whole_model(const PosteriorConfiguration& given) noexcept {
  return !given.ln_s.empty() && !given.shift.empty() && given.ln_s_prior.sd > 0 && given.shift_prior.sd > 0;
}

bool has_posterior_threshold(const Protocol& protocol) noexcept {
  const auto& procedure = protocol.design.procedure;
  return procedure && (procedure->kind == AdaptiveProcedure::Kind::posterior || procedure->joint_likelihood);
}

std::vector<PosteriorAnswer> posterior_answers(PosteriorTask task, std::span<const AnsweredTrial> trials) {
  std::vector<PosteriorAnswer> answers;
  for (const AnsweredTrial& trial : trials) {
    if (task == PosteriorTask::which) {
      const double level = trial.stimuli[0] == trial.standard ? trial.stimuli[1] : trial.stimuli[0];
      answers.push_back({level, trial.correct() == (level > trial.standard)});
    } else {
      // Of one interval the distance of the signal from the noise.
      const double other = trial.stimuli.size() > 1 ? trial.stimuli[1] : trial.standard;
      answers.push_back({plain_distance(trial.stimuli[0], other), trial.correct() == (trial.stimuli[0] != other)});
    }
  }
  return answers;
}

PosteriorOfAnswers posterior_of_answers(const PosteriorConfiguration& configuration,
                                        std::span<const PosteriorAnswer> answers) {
  PosteriorConfiguration c = configuration;
  c.utility = PosteriorUtility::variance;  // nothing is chosen
  c.levels = levels_of(answers);
  PosteriorProcedure posterior(c);
  const PosteriorEstimate prior = posterior.estimate();
  for (const PosteriorAnswer& answer : answers) {
    const auto place = std::lower_bound(c.levels.begin(), c.levels.end(), answer.level) - c.levels.begin();
    posterior.update(static_cast<std::size_t>(place), answer.positive);
  }
  PosteriorEstimate estimate = posterior.estimate();
  // What rounding leaves of the 0 of answers that are alike on both sides.
  if (std::abs(estimate.mean_shift) < 1e-12 * estimate.sd_shift) estimate.mean_shift = 0;
  const LogPosterior of_ln_s{estimate.mean_ln_s,
                             estimate.sd_ln_s,
                             posterior.ln_s_quantile(0.025),
                             posterior.ln_s_quantile(0.975),
                             prior.sd_ln_s,
                             is_highest_at_end(posterior),
                             posterior.trials()};
  return {posterior_threshold(of_ln_s), estimate, prior};
}

PosteriorOfAnswers posterior_of_trials(const Protocol& protocol, const Series& series,
                                       std::span<const AnsweredTrial> trials) {
  const PosteriorConfiguration c = posterior_model(protocol, series).configuration;
  return posterior_of_answers(c, posterior_answers(c.task, trials));
}

TaskEstimate posterior_estimate(const AdaptiveThreshold& threshold, double factor) {
  if (threshold.status != AdaptiveStatus::ok) return {};
  return {factor * threshold.threshold, factor * threshold.low, factor * threshold.high, threshold.prior_weight};
}

}  // namespace jnd
