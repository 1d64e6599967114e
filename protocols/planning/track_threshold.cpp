#include "protocols/planning/track_threshold.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
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

bool tracks_have_threshold(const Protocol& protocol) {
  return protocol.design.procedure && !task_of(protocol.task.kind).has_own_results() &&
         threshold_source(protocol) != ThresholdSource::answers;
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
         to_string(protocol.stimulus.unit),
         fmt::format("comparison that is said to have more in {:.1f} %: mean of the last {} reversals of "
                     "each track",
                     100 * target, procedure.averaged_reversals),
         4, false});
    return outcomes;
  }
  outcomes.push_back(
      {kTrackThreshold, reversals ? "threshold by reversals" : "threshold by QUEST", to_string(protocol.stimulus.unit),
       fmt::format("difference from the standard at {:.1f} % correct: {}",
                   100 * adaptive_target(procedure).value_or(kNaN),
                   reversals ? fmt::format("mean of the last {} reversals of each track", procedure.averaged_reversals)
                             : std::string("ten to the posterior mean of its logarithm")),
       4, true});
  return outcomes;
}

TaskEstimates measured_estimates(const Protocol& protocol, const Series& series, std::span<const AnsweredTrial> trials,
                                 std::span<const AdaptiveTrack> tracks) {
  TaskEstimates estimates = task_of(protocol.task.kind).estimate(protocol, series, trials);
  if (!tracks_have_threshold(protocol)) return estimates;
  const AdaptiveThreshold threshold = tracks.empty() ? AdaptiveThreshold{} : condition_threshold(tracks, protocol);
  estimates.values.push_back(threshold.status == AdaptiveStatus::ok
                                 ? TaskEstimate{.value = threshold.threshold, .prior_weight = threshold.prior_weight}
                                 : TaskEstimate{});
  estimates.tracks = threshold.tracks;
  return estimates;
}

}  // namespace jnd
