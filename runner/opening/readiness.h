// Is everything fit for a session: looked at before the first trial, each time a session is begun or taken up again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/study/study.h"
#include "devices/machine/machine_checks.h"
#include "devices/rig.h"
#include "protocols/planning/plan.h"
#include "protocols/protocol.h"
#include "protocols/rigs/rig_description.h"

namespace jnd {

class ButtonBox;

struct ReadinessInput {
  const Protocol& protocol;
  const RigSpec& spec;
  const Plan& plan;
  const Study& study;
  std::filesystem::path study_path;
  std::string participant;
  SessionKind kind = SessionKind::pilot;
  Rig& rig;
  bool keyboard_is_terminal = false;
  bool fast = false;                   // a quick rehearsal: the machine's punctuality does not matter
  const ButtonBox* buttons = nullptr;  // that answer; null: the keyboard does
};

struct Readiness {
  Checks items;  // storage, tracker (where it is outside), devices, limits, calibration, loop,
                 // keyboard, study, plan, participant, clock
  // A real session is not begun with a finding that is bad, any other only where its data could be lost, or where its
  // participant is not to take part (again).
  bool blocked = false;
  // Blocked by nothing that an operator may set aside with a reason: never where data could be lost, nor for a
  // participant who has finished or is excluded.
  bool overridable = true;
};

// Takes about a second and a half: 1 s the loop's punctuality, a quarter the rig itself. In a quick rehearsal the
// devices and the loop are left out, and it takes no time. Gives no force: the rig presents a quarter of a second
// without cues, which needs no finger in the device, and its models are tested apart from it. Leaves no telemetry
// behind. Throws StorageError where the study cannot be read.
Readiness check_readiness(const ReadinessInput& input);

nlohmann::ordered_json readiness_body(const Readiness& readiness, const std::string& overridden_because);
// For the operator: what is not in order, marked BAD or warning, or one line that all is; and what the devices may do
// at most. Without colours; ends with an end of line.
std::string readiness_text(const Readiness& readiness);

}  // namespace jnd
