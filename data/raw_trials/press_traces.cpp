#include "data/raw_trials/press_traces.h"

#include <algorithm>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <nlohmann/json.hpp>

#include "data/log/event_body.h"
#include "data/log/telemetry.h"
#include "data/log/trial_body.h"
#include "data/study/study_impl.h"
#include "data/study/trial_rows.h"
#include "protocols/input/json_text.h"

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

// The answered main trials of a session whose ticks were kept; to be followed by what they are asked for.
constexpr const char* kTrialsWithTicks =
    "SELECT t.seq, e.body FROM trials t JOIN event e ON e.session = t.session AND e.seq = t.seq "
    "WHERE t.session = ? AND t.practice = 0 AND EXISTS (SELECT 1 FROM telemetry k WHERE k.session = t.session AND "
    "k.seq = t.seq) ";

PressedTrial pressed(const Study::Impl& impl, const SessionInfo& session, SQLite::Statement& query) {
  const std::int64_t seq = query.getColumn(0).getInt64();
  const TrialRecord record = trial_record_from(json_from(query.getColumn(1).getString()));
  PressedTrial trial{session.participant, record.trial.index, record.trial.condition, {}};
  for (const TelemetryBlob& blob : impl.telemetry(session.id, seq))
    trial.intervals.push_back(press_trace(blob, record));
  return trial;
}

const SessionInfo* first_with_ticks(const Study::Impl& impl, const std::vector<SessionInfo>& sessions) {
  SQLite::Statement kept(impl.database(), "SELECT EXISTS (SELECT 1 FROM telemetry WHERE session = ?)");
  for (const SessionInfo& session : sessions) {
    kept.bind(1, session.id);
    const bool any = kept.executeStep() && kept.getColumn(0).getInt() != 0;
    kept.reset();
    if (any) return &session;
  }
  return nullptr;
}

}  // namespace

std::vector<PressedTrial> pressed_trials(const Study& study, const Protocol& protocol,
                                         const std::vector<SessionInfo>& sessions) {
  std::vector<PressedTrial> trials;
  if (!is_of_ticks(protocol)) return trials;
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  with_storage_errors(impl.path, [&] {
    const SessionInfo* const first = first_with_ticks(impl, sessions);
    if (first == nullptr) return;
    SQLite::Statement query(impl.database(),
                            std::string(kTrialsWithTicks) + "AND t.condition = ? ORDER BY COALESCE(t.same, 0), t.seq");
    TrialBodyReader reader(protocol.stimulus.unit);
    for (const Condition& condition : protocol.conditions) {
      query.bind(1, first->id);
      query.bind(2, condition.name);
      while (query.executeStep()) {
        if (!exclusion_reason(protocol.analysis.exclude, reader.read(query.getColumn(1).getString())).empty()) continue;
        trials.push_back(pressed(impl, *first, query));
        break;
      }
      query.reset();
    }
  });
  return trials;
}

std::optional<PressedTrial> pressed_trial(const Study& study, const Protocol& protocol,
                                          const std::vector<SessionInfo>& sessions, const std::string& participant,
                                          int trial) {
  std::optional<PressedTrial> found;
  if (!is_of_ticks(protocol)) return found;
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  with_storage_errors(impl.path, [&] {
    SQLite::Statement query(impl.database(), std::string(kTrialsWithTicks) + "AND t.trial = ? ORDER BY t.seq LIMIT 1");
    for (const SessionInfo& session : sessions) {
      if (session.participant != participant) continue;
      query.bind(1, session.id);
      query.bind(2, trial);
      if (query.executeStep()) found = pressed(impl, session, query);
      query.reset();
      if (found) return;
    }
  });
  return found;
}

}  // namespace jnd
