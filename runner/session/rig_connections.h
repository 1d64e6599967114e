// What a session does about the connections of its rig: it keeps them in the log, and waits where something is missing.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "devices/rig.h"
#include "runner/session/session_parts.h"

namespace jnd {

// rig.connections; nothing for a rig of models. when: as for connections_body().
void note_connections(const SessionParts& parts, const SessionRecorder& recorder, std::string_view when);

// rig.calibration for each device that carries a calibration: its certificate, from the first of the folders that has
// it, so that it can be recomputed from the study alone.
void note_calibrations(const SessionParts& parts, const SessionRecorder& recorder,
                       const std::vector<std::filesystem::path>& folders);

// Whether an attempt that this fault ended uses up one of the trial's attempts. Not where a device is unplugged, or the
// tracker gone, just now: the session waits for it. A device that comes and goes within the attempt, or
// that stops itself, does use it up: otherwise it could go on for ever.
bool counts_as_attempt(const SessionParts& parts, Fault fault);

// What is missing of the rig, as it may be said; the log keeps all of it.
std::string missing_of(Rig& rig, bool sealed);

// Before anything is presented: returns when nothing is missing. A person is told what is, and may end the session; the
// devices are at rest. Without a person it waits kLongestWait_s. Throws SessionEnds: the session can be resumed.
inline constexpr double kLongestWait_s = 30;
void await_rig(const SessionParts& parts, const SessionRecorder& recorder, int after_trial);

// when: "opened", "fault", "missing" (something is, and is waited for), "back", "closed". A number that is none, such
// as the uncertainty of a clock that was never compared, is null.
nlohmann::ordered_json connections_body(const RigConnections& connections, std::string_view when);

}  // namespace jnd
