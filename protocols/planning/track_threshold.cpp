#include "protocols/planning/track_threshold.h"

#include <vector>

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
    case ThresholdSource::quest:
      return quest_threshold(track.quest->mean, track.quest->sd, static_cast<int>(track.levels.size()),
                             procedure.clamp);
    case ThresholdSource::answers:
      break;
  }
  return by_answers({&track, 1}, protocol);
}

AdaptiveThreshold condition_threshold(std::span<const AdaptiveTrack> tracks, const Protocol& protocol) {
  const ThresholdSource source = threshold_source(protocol);
  if (source == ThresholdSource::answers) return by_answers(tracks, protocol);
  std::vector<AdaptiveThreshold> each;
  for (const AdaptiveTrack& track : tracks) each.push_back(track_threshold(track, protocol));
  return source == ThresholdSource::reversals ? combined_staircases(each) : combined_quests(each);
}

}  // namespace jnd
