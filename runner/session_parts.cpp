#include "runner/session_parts.h"

#include "data/event_body.h"
#include "data/storage_error.h"

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

void pause_session(const SessionParts& parts, const SessionRecorder& recorder, const std::string& cause,
                   const std::string& reason, int after_trial) {
  parts.rig.neutral();
  const std::int64_t began = parts.clock.now_ns();
  recorder.append(event_kind::kPaused, {{"cause", cause}, {"reason", reason}, {"after_trial", after_trial}});
  for (;;) {
    const OperatorWish wish = parts.view.paused(cause);
    if (parts.interrupts.end) throw SessionEnds{false, "signal", {}};
    if (wish.wish == Wish::end_for_now || wish.wish == Wish::end_for_good)
      throw SessionEnds{wish.wish == Wish::end_for_good, "operator", wish.text};
    if (wish.wish == Wish::note)
      recorder.note(wish.text, after_trial);
    else
      break;
  }
  forget_pause();
  // A Ctrl-C during the pause asked for what was already there; its stop goes with it.
  if (!parts.interrupts.end) parts.rig.stop.clear_if(StopSource::signal);
  recorder.append(event_kind::kContinued, {{"paused_s", seconds_since(parts, began)}});
}

void heed_interrupts(const SessionParts& parts, const SessionRecorder& recorder, int after_trial) {
  if (parts.interrupts.end) throw SessionEnds{false, "signal", {}};
  if (!parts.interrupts.pause) return;
  // Ctrl-C has latched the rig's stop too: the pause takes its place.
  parts.rig.stop.clear_if(StopSource::signal);
  pause_session(parts, recorder, "ctrl-c", {}, after_trial);
}

void recover_from_stop(const SessionParts& parts, const SessionRecorder& recorder, const std::string& stopped_by,
                       int after_trial) {
  const OperatorWish wish = settle(parts, recorder, after_trial, [&] { return parts.view.recover(stopped_by); });
  parts.rig.stop.clear();
  recorder.append(event_kind::kStopCleared,
                  {{"stopped_by", stopped_by}, {"reason", wish.text.empty() ? "cleared by the operator" : wish.text}});
}

}  // namespace jnd
