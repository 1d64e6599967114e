// The course of one session against the protocol's rules. Internal to verify_deep.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "data/log/session_log.h"
#include "data/study/problem.h"
#include "protocols/planning/plan.h"
#include "protocols/protocol.h"

namespace jnd {

// Called with the event that a rule does not allow, why, and what that gives away.
using TellCourse = std::function<void(const Event&, const std::string&, Reveals)>;

// Throws nlohmann::json::exception and StorageError where a body is not what its kind says; verify says so too.
void check_course(const Protocol& protocol, const Plan& plan, const std::vector<Event>& events,
                  const TellCourse& problem);

}  // namespace jnd
