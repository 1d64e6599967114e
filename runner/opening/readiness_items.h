// What a session's readiness is made of, item by item: each looks at one thing and judges it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "data/study/study.h"
#include "devices/machine/machine_checks.h"
#include "devices/rig.h"
#include "protocols/planning/plan.h"
#include "protocols/protocol.h"
#include "protocols/rigs/rig_description.h"
#include "protocols/vocabulary.h"

namespace jnd {

// Names of the items that no reason sets aside.
inline constexpr const char* kStorageItem = "study folder";
inline constexpr const char* kParticipantItem = "participant";
// The item whose finding is said even where all is in order.
inline constexpr const char* kLimitsItem = "limits";

// Most that one session's telemetry takes on the disk, for every tick that it can have.
double telemetry_bytes(const Protocol& protocol, const Plan& plan, const RigSpec& spec) noexcept;
Check check_session_storage(const std::filesystem::path& study, double needed_bytes, SessionKind kind);

// The models that the descriptions stand for, and the rig itself: a quarter of a second without cues.
Check check_devices(const RigSpec& spec, Rig& rig);
// What the descriptions allow at most; a warning where they are not the shipped ones.
Check check_description(const RigSpec& spec);
Check check_calibration(const RigSpec& spec, std::int64_t utc_ns);
// The stream of the fingers' poses, where it comes from outside the program: for every finger, often enough, and fresh.
// Takes up to a second and a half.
Check check_tracker(Rig& rig);
// How punctually this machine wakes a thread that is scheduled as the rig's is; 1 s.
Check check_loop_jitter(RealtimePolicy policy);
Check check_keyboard(bool is_terminal);
// The participant's own plan, and what the cohort's size does to the balance of orders.
Check check_plan_balance(const Protocol& protocol, const Plan& plan);
// The study's events so far: every hash, and that no end is missing.
Check check_study(const Study& study);
// Whether this participant may take part (again): not excluded, this session not finished, the number not taken.
Check check_participant(const std::vector<SessionInfo>& sessions, const std::string& participant, SessionKind kind,
                        const Plan& plan, int planned_sessions);
// The wall clock: not before this program was written, nor before what the study already holds.
Check check_clock(const std::vector<SessionInfo>& sessions, std::int64_t utc_ns);

}  // namespace jnd
