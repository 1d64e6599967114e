#include "data/task_results/participant_tracks.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "data/log/replay.h"
#include "data/log/storage_error.h"
#include "protocols/planning/allotment.h"

namespace jnd {
namespace {

// Of one session.
std::vector<AdaptiveTrack> tracks_of(const std::vector<Event>& events, const Protocol& protocol,
                                     const std::string& participant) {
  AdaptiveRun run(protocol);
  for (const TrialRecord& record : replay(events).completed) {
    try {
      run.answered(record.trial, record.answer);
    } catch (const std::out_of_range&) {
      throw StorageError(
          fmt::format("participant {}: trial {} belongs to track {} of condition {}, which the protocol "
                      "does not have; run jnd verify",
                      participant, record.trial.index, record.trial.track, record.trial.condition));
    }
  }
  return run.tracks();
}

}  // namespace

std::vector<AdaptiveTrack> participant_tracks(const std::vector<std::vector<Event>>& sessions, const Protocol& protocol,
                                              const std::string& participant, std::optional<int> group) {
  std::vector<AdaptiveTrack> tracks;
  for (const std::vector<Event>& events : sessions) {
    int before = 0;  // tracks of a condition in the sessions before
    for (const AdaptiveTrack& track : tracks) before = std::max(before, track.track);
    for (AdaptiveTrack& track : tracks_of(events, protocol, participant)) {
      if (!has_condition(protocol, group, track.condition)) continue;
      track.track += before;
      tracks.push_back(std::move(track));
    }
  }
  std::stable_sort(tracks.begin(), tracks.end(), [](const AdaptiveTrack& a, const AdaptiveTrack& b) {
    return std::tie(a.condition, a.series) < std::tie(b.condition, b.series);
  });
  return tracks;
}

std::vector<AdaptiveTrack> participant_tracks(const Study& study, const Protocol& protocol,
                                              std::span<const SessionInfo> sessions) {
  std::vector<std::vector<Event>> events;
  for (const SessionInfo& session : sessions) events.push_back(study.events(session.id));
  return participant_tracks(events, protocol, sessions.front().participant,
                            group_named(protocol, sessions.front().group));
}

std::span<const SessionInfo> sessions_of_next(std::span<const SessionInfo> sessions) noexcept {
  std::size_t count = 0;
  while (count < sessions.size() && sessions[count].participant == sessions.front().participant) ++count;
  return sessions.first(count);
}

}  // namespace jnd
