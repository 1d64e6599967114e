#include "runner/session/course_recorder.h"

#include "data/log/replay.h"

namespace jnd {

CourseRecorder::CourseRecorder(const SessionParts& parts, Course& course) noexcept
    : SessionRecorder(parts), course_(course), person_(parts.person) {}

void CourseRecorder::record(const CourseEvent& event, const nlohmann::ordered_json& body,
                            const std::vector<TelemetryBlob>& telemetry) const {
  append(kind_of(event), body, telemetry);
  course_.apply(event);
}

void CourseRecorder::record_mark(const CourseEvent& event, const nlohmann::ordered_json& body) const {
  mark(kind_of(event), body);
  if (person_) course_.apply(event);
}

}  // namespace jnd
