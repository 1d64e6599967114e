// rig.connections: how the connections to devices and tracker are, and were.
#pragma once

#include <string_view>

#include <nlohmann/json.hpp>

#include "devices/rig.h"

namespace jnd {

// when: "opened", "fault", "missing" (something is, and is waited for), "back", "closed". A number that is none, such
// as the uncertainty of a clock that was never compared, is null.
nlohmann::ordered_json connections_body(const RigConnections& connections, std::string_view when);

}  // namespace jnd
