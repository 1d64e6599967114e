// Writes what changes a session's course: what is in the log, and nothing else, is what the session goes on from.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "protocols/course/course.h"
#include "runner/session/session_parts.h"

namespace jnd {

class CourseRecorder : public SessionRecorder {
 public:
  // Both must outlive it.
  CourseRecorder(const SessionParts& parts, Course& course) noexcept;

  const Course& course() const noexcept { return course_; }
  // The event is committed, and then followed. Throws as append().
  void record(const CourseEvent& event, const nlohmann::ordered_json& body,
              const std::vector<TelemetryBlob>& telemetry = {}) const;
  // The same as a mark; for people only.
  void record_mark(const CourseEvent& event, const nlohmann::ordered_json& body) const;

 private:
  Course& course_;
  bool person_;
};

}  // namespace jnd
