// Events of a log as what they change in a session, and back: kill the program anywhere, and a replay says where the
// session goes on.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/log/session_log.h"
#include "protocols/course/session_state.h"

namespace jnd {

// As which kind an event is logged.
std::string_view kind_of(const CourseEvent& event) noexcept;
// What an event of a log changes; none for those that change nothing about what is still to do (notes, pauses, faults).
// Throws StorageError and nlohmann::json::exception where the body is not its kind's.
std::optional<CourseEvent> course_event_from(std::string_view kind, const nlohmann::ordered_json& body);

// Throws StorageError, which names the event that cannot be read.
SessionState replay(const std::vector<Event>& events);

}  // namespace jnd
