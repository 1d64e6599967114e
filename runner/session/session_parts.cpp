#include "runner/session/session_parts.h"

#include <algorithm>

#include "data/log/event_body.h"
#include "data/log/storage_error.h"

namespace jnd {

namespace {

Stamp stamp_now(const SessionParts& parts) {
  return {parts.clock.utc_ns(), parts.clock.now_ns()};
}

double seconds_since(const SessionParts& parts, std::int64_t began_ns) {
  return static_cast<double>(parts.clock.now_ns() - began_ns) * 1e-9;
}

}  // namespace

void SessionRecorder::append(std::string_view kind, const nlohmann::ordered_json& body,
                             const std::vector<TelemetryBlob>& telemetry) const {
  const Stamp stamp = stamp_now(parts_);  // of what happened, however long the disk takes to hold it
  try {
    parts_.log.append(kind, body, stamp, telemetry);
    return;
  } catch (const StorageTrouble& trouble) {
    parts_.rig.neutral();
    if (!parts_.view.storage_trouble(trouble.what())) throw;
  }
  for (;;) {
    try {
      parts_.log.append(kind, body, stamp, telemetry);
      break;
    } catch (const StorageTrouble& trouble) {
      if (!parts_.view.storage_trouble(trouble.what())) throw;
    }
  }
  // What happened is in the log, after the event that had to wait.
  append(event_kind::kPaused, {{"cause", "storage"}, {"reason", "the log could not be written"}});
  append(event_kind::kContinued, {{"paused_s", seconds_since(parts_, stamp.monotonic_ns)}});
}

void SessionRecorder::mark(std::string_view kind, const nlohmann::ordered_json& body) const {
  if (!parts_.person) return;
  for (;;) {
    try {
      parts_.log.mark(kind, body, stamp_now(parts_));
      return;
    } catch (const StorageTrouble& trouble) {
      if (!parts_.view.storage_trouble(trouble.what())) throw;
    }
  }
}

void SessionRecorder::note(const std::string& text, int after_trial) const {
  append(event_kind::kNote, {{"text", text}, {"by", "operator"}, {"after_trial", after_trial}});
}

bool fulfilled(const SessionParts& parts, const SessionRecorder& recorder, int after_trial,
               const OperatorRequest& request) {
  switch (request.kind) {
    case Request::note:
      recorder.note(request.text, after_trial);
      return true;
    case Request::pause:
      // One by Ctrl-C is handled before the next asking, and its stop of the rig is taken back.
      if (!parts.interrupts.pause) pause_session(parts, recorder, "key", request.text, after_trial);
      return true;
    case Request::stopped:
      return true;  // handled before the next asking
    case Request::end_for_now:
      throw SessionEnds{false, "operator", request.text};
    case Request::end_for_good:
      throw SessionEnds{true, "operator", request.text};
    default:
      return false;
  }
}

namespace {

// Set by a person; those of the program and of signals are taken back by what set them.
bool stopped_by_person(const SessionParts& parts) {
  const StopSource source = parts.rig.stop.source();
  return parts.person && (source == StopSource::key || source == StopSource::button);
}

void handle_stop(const SessionParts& parts, const SessionRecorder& recorder, int after_trial) {
  if (stopped_by_person(parts))
    recover_from_stop(parts, recorder, std::string(to_string(parts.rig.stop.source())), after_trial);
}

void handle_signals(const SessionParts& parts, const SessionRecorder& recorder, int after_trial) {
  if (parts.interrupts.end) throw SessionEnds{false, "signal", {}};
  if (!parts.interrupts.pause) return;
  // Ctrl-C has latched the rig's stop too: the pause takes its place.
  parts.rig.stop.clear_if(StopSource::signal);
  pause_session(parts, recorder, "ctrl-c", {}, after_trial);
}

}  // namespace

void pause_session(const SessionParts& parts, const SessionRecorder& recorder, const std::string& cause,
                   const std::string& reason, int after_trial) {
  parts.rig.neutral();
  const std::int64_t began = parts.clock.now_ns();
  recorder.append(event_kind::kPaused, {{"cause", cause}, {"reason", reason}, {"after_trial", after_trial}});
  for (;;) {
    const OperatorRequest request = parts.view.paused(cause);
    if (parts.interrupts.end) throw SessionEnds{false, "signal", {}};
    if (request.kind == Request::stopped) break;  // the stop takes the pause's place
    if (request.kind == Request::pause || !fulfilled(parts, recorder, after_trial, request)) break;
  }
  forget_pause();
  // A Ctrl-C during the pause asked for what was already there; its stop goes with it.
  if (!parts.interrupts.end) parts.rig.stop.clear_if(StopSource::signal);
  recorder.append(event_kind::kContinued, {{"paused_s", seconds_since(parts, began)}});
}

void handle_interrupts(const SessionParts& parts, const SessionRecorder& recorder, int after_trial) {
  handle_signals(parts, recorder, after_trial);
  handle_stop(parts, recorder, after_trial);
}

void recover_from_stop(const SessionParts& parts, const SessionRecorder& recorder, const std::string& stopped_by,
                       int after_trial) {
  OperatorRequest request;
  do {
    handle_signals(parts, recorder, after_trial);
    request = parts.view.recover(stopped_by);
  } while (fulfilled(parts, recorder, after_trial, request));
  parts.rig.stop.clear();
  recorder.append(
      event_kind::kStopCleared,
      {{"stopped_by", stopped_by}, {"reason", request.text.empty() ? "cleared by the operator" : request.text}});
}

bool wait_until(const SessionParts& parts, std::int64_t deadline_ns, OperatorHeard heard) {
  const std::int64_t began_ns = parts.clock.now_ns();
  const auto seconds = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-9; };
  for (std::int64_t now_ns = began_ns; now_ns < deadline_ns; now_ns = parts.clock.now_ns()) {
    if (parts.interrupts.pause || parts.interrupts.end || parts.rig.stop.latched()) return false;
    const double left_s = seconds(deadline_ns - now_ns), total_s = seconds(deadline_ns - began_ns);
    if (heard == OperatorHeard::between_trials && !parts.view.waiting(left_s, total_s)) return false;
    if (heard == OperatorHeard::in_gap && !parts.view.gap(left_s, total_s)) return false;
    parts.clock.sleep_until_ns(std::min(deadline_ns, now_ns + kLook_ns));
  }
  return true;
}

void wait_out(const SessionParts& parts, const SessionRecorder& recorder, std::int64_t deadline_ns, int after_trial) {
  while (!wait_until(parts, deadline_ns)) {
    handle_interrupts(parts, recorder, after_trial);
    if (parts.rig.stop.latched()) return;
  }
}

}  // namespace jnd
