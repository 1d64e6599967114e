// A laboratory's own rig is started, asked what it is, held against a protocol, and ended: before anybody is invited.
#pragma once

#include <string>
#include <vector>

#include "devices/check.h"
#include "devices/external/external_settings.h"
#include "protocols/protocol.h"

namespace jnd {

struct AskedRig {
  Checks checks;                      // of its hello and its end
  std::vector<std::string> problems;  // why it cannot present what the protocol asks, each a sentence; empty: it can
  std::vector<std::string> cautions;  // what has to be known where it can
};

// protocol: null where there is none to hold it against; with one a rig without a hello is a problem. Throws Stopped.
AskedRig ask_external_rig(const ExternalSettings& settings, const Protocol* protocol);

// The same for the rig file at that path, which throws InputError where it cannot be read, or names no external rig.
AskedRig ask_rig_of(const std::string& rig_file, const Protocol& protocol);

}  // namespace jnd
