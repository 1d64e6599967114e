// `jnd device test external`: is a laboratory's bridge right? Every line of it is measured on the rig.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "devices/check.h"
#include "devices/external/external_settings.h"
#include "devices/external/rig_messages.h"

namespace jnd {

struct Conformance {
  std::optional<RigHello> hello;  // none where it said none
  Checks checks;
};

// Starts the rig and looks at its hello alone: for `jnd doctor`. Throws ProbeInterrupted.
Conformance check_rig_hello(const ExternalSettings& settings, const std::atomic<bool>& interrupted);

// The whole test: starts the rig several times, and presents its lowest and highest values. may_present: whether what it
// renders may be presented (a real rig moves); where not, what needs it is not judged. Throws ProbeInterrupted.
Conformance check_conformance(const ExternalSettings& settings, const std::atomic<bool>& interrupted,
                              const std::function<bool(const RigHello&)>& may_present);

}  // namespace jnd
