#include "protocols/planning/track_threshold.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/posterior_model.h"

namespace jnd {
namespace {

AdaptiveThreshold by_answers(std::span<const AdaptiveTrack> tracks, const Protocol& protocol) {
  std::vector<PosteriorAnswer> answers;
  for (const AdaptiveTrack& track : tracks) {
    for (std::size_t i = 0; i < track.levels.size(); ++i) answers.push_back({track.levels[i], track.correct[i]});
    for (int i = 0; i < track.catch_trials; ++i) answers.push_back({0, i < track.false_alarms});
  }
  return posterior_of_answers(posterior_model(protocol, protocol.series.front()).configuration, answers).threshold;
}

// Beside the task's own outcomes.
bool tracks_have_threshold(const Protocol& protocol) {
  return !levels_given(protocol) && task_of(protocol.task.kind).evidence(protocol) != Evidence::tracks &&
         threshold_source(protocol) != ThresholdSource::answers;
}

// A threshold, and its share of the reference, with the middle 95 % of its posterior where it has one.
TaskEstimates estimates_of(const AdaptiveThreshold& threshold, double reference) {
  return {std::string(to_string(threshold.status)),
          {posterior_estimate(threshold), posterior_estimate(threshold, 1 / reference)},
          threshold.tracks};
}

}  // namespace

ThresholdSource threshold_source(const Protocol& protocol) noexcept {
  if (has_posterior_threshold(protocol)) return ThresholdSource::answers;
  return protocol.design.procedure->kind == AdaptiveProcedure::Kind::staircase ? ThresholdSource::reversals
                                                                               : ThresholdSource::quest;
}

AdaptiveThreshold track_threshold(const AdaptiveTrack& track, const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  switch (threshold_source(protocol)) {
    case ThresholdSource::reversals:
      return staircase_threshold(track.levels, track.reversals, procedure.averaged_reversals, procedure.clamp);
    case ThresholdSource::quest: {
      AdaptiveThreshold found =
          quest_threshold(track.quest->mean, track.quest->sd, static_cast<int>(track.levels.size()), procedure.clamp);
      found.prior_weight = std::pow(track.quest->sd / procedure.quest.t_guess_sd, 2);
      return found;
    }
    case ThresholdSource::answers:
      break;
  }
  return by_answers({&track, 1}, protocol);
}

std::optional<double> adaptive_target(const AdaptiveProcedure& procedure) {
  switch (procedure.kind) {
    case AdaptiveProcedure::Kind::staircase:
      return staircase_target(procedure.staircase);
    case AdaptiveProcedure::Kind::quest:
      return procedure.quest.p_threshold;
    case AdaptiveProcedure::Kind::posterior:
      break;
  }
  return std::nullopt;
}

AdaptiveThreshold condition_threshold(std::span<const AdaptiveTrack> tracks, const Protocol& protocol) {
  const ThresholdSource source = threshold_source(protocol);
  if (source == ThresholdSource::answers) return by_answers(tracks, protocol);
  std::vector<AdaptiveThreshold> each;
  for (const AdaptiveTrack& track : tracks) each.push_back(track_threshold(track, protocol));
  return source == ThresholdSource::reversals ? combined_staircases(each, protocol.analysis.unfinished_tracks)
                                              : combined_quests(each);
}

std::vector<TaskOutcome> measured_outcomes(const Protocol& protocol) {
  const Task& task = task_of(protocol.task.kind);
  std::vector<TaskOutcome> outcomes = task.outcomes(protocol);
  if (!tracks_have_threshold(protocol)) return outcomes;
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  const bool reversals = threshold_source(protocol) == ThresholdSource::reversals;
  if (procedure.sides.front() == 0) {
    const double target = adaptive_target(procedure).value_or(kNaN);
    outcomes.push_back(
        {kTrackThreshold, std::abs(target - 0.5) < 1e-9 ? "PSE by reversals" : "level by reversals",
         std::string(to_string(protocol.stimulus.unit)),
         fmt::format("comparison that is said to have more in {:.1f} %: mean of the last {} reversals of "
                     "each track",
                     100 * target, procedure.averaged_reversals),
         false});
    return outcomes;
  }
  outcomes.push_back(
      {kTrackThreshold, reversals ? "threshold by reversals" : "threshold by QUEST",
       std::string(to_string(protocol.stimulus.unit)),
       fmt::format("difference from the standard at {:.1f} % correct: {}",
                   100 * adaptive_target(procedure).value_or(kNaN),
                   reversals ? fmt::format("mean of the last {} reversals of each track", procedure.averaged_reversals)
                             : std::string("ten to the posterior mean of its logarithm")),
       true});
  return outcomes;
}

TaskEstimates measured_estimates(const Protocol& protocol, const Series& series, std::span<const AnsweredTrial> trials,
                                 std::span<const AdaptiveTrack> tracks) {
  const Task& task = task_of(protocol.task.kind);
  const auto of_tracks = [&] { return tracks.empty() ? AdaptiveThreshold{} : condition_threshold(tracks, protocol); };
  if (task.evidence(protocol) == Evidence::tracks) return estimates_of(of_tracks(), protocol.stimulus.reference);
  TaskEstimates estimates = task.estimate(protocol, series, trials);
  if (!tracks_have_threshold(protocol)) return estimates;
  const AdaptiveThreshold threshold = of_tracks();
  estimates.values.push_back(threshold.status == AdaptiveStatus::ok
                                 ? TaskEstimate{.value = threshold.threshold, .prior_weight = threshold.prior_weight}
                                 : TaskEstimate{});
  estimates.tracks = threshold.tracks;
  return estimates;
}

}  // namespace jnd
