#include "data/results/press_traces.h"

#include <algorithm>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <nlohmann/json.hpp>

#include "data/log/event_body.h"
#include "data/log/telemetry.h"
#include "data/study/study_impl.h"

namespace jnd {

namespace {

constexpr std::int64_t kPointEvery_ns = 5'000'000;

PressTrace press_trace(const TelemetryBlob& blob, const TrialRecord& record) {
  PressTrace trace;
  trace.interval = blob.interval;
  const auto place = static_cast<std::size_t>(blob.interval);
  if (place < record.trial.stimuli.size()) trace.stimulus = record.trial.stimuli[place];
  if (place < record.presentations.size() && !record.presentations[place].fingers.empty()) {
    const FingerPresentation& finger = record.presentations[place].fingers.front();
    trace.delivered = finger.stiffness;
    trace.limited = finger.saturated_share > 0;
  }
  std::int64_t next_ns = 0;
  for (const TickRecord& tick : decode_telemetry(blob.bytes).ticks) {
    if (tick.channel != 0 || tick.time_ns < next_ns) continue;
    next_ns = tick.time_ns + kPointEvery_ns;
    trace.points.push_back({tick.penetration, tick.measured_n, tick.asked_n});
  }
  return trace;
}

// Of a rig of the laboratory's own the blobs are something else.
bool is_of_ticks(const Protocol& protocol) {
  return protocol.rig.built_in();
}

}  // namespace

std::vector<PressedTrial> pressed_trials(const Study& study, const Protocol& protocol,
                                         const std::vector<SessionInfo>& sessions) {
  if (!is_of_ticks(protocol)) return {};
  std::vector<PressedTrial> trials;
  std::vector<std::pair<std::size_t, std::int64_t>> events;  // of `trials`
  const SessionInfo* first = nullptr;
  {
    const Study::Impl& impl = study.impl();
    const std::scoped_lock lock(impl.mutex);
    with_storage_errors(impl.path, [&] {
      SQLite::Statement kept(impl.database(), "SELECT EXISTS (SELECT 1 FROM telemetry WHERE session = ?)");
      for (const SessionInfo& session : sessions) {
        kept.bind(1, session.id);
        const bool any = kept.executeStep() && kept.getColumn(0).getInt() != 0;
        kept.reset();
        if (!any) continue;
        first = &session;
        break;
      }
      if (first == nullptr) return;
      SQLite::Statement query(
          impl.database(),
          "SELECT t.seq, e.body FROM trials t JOIN event e ON e.session = t.session AND e.seq = t.seq "
          "WHERE t.session = ? AND t.practice = 0 AND t.condition = ? AND EXISTS (SELECT 1 FROM "
          "telemetry k WHERE k.session = t.session AND k.seq = t.seq) ORDER BY COALESCE(t.same, 0), t.seq LIMIT 1");
      for (std::size_t condition = 0; condition < protocol.conditions.size(); ++condition) {
        query.bind(1, first->id);
        query.bind(2, protocol.conditions[condition].name);
        if (query.executeStep()) {
          const std::int64_t seq = query.getColumn(0).getInt64();
          const TrialRecord record = trial_record_from(nlohmann::ordered_json::parse(query.getColumn(1).getString()));
          PressedTrial trial{first->participant, record.trial.index, static_cast<int>(condition), {}};
          for (const TelemetryBlob& blob : impl.telemetry(first->id, seq))
            trial.intervals.push_back(press_trace(blob, record));
          trials.push_back(std::move(trial));
        }
        query.reset();
      }
    });
  }
  return trials;
}

}  // namespace jnd
