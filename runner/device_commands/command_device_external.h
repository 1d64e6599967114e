// jnd device test external: the conformance test of a laboratory's own rig, and its output.
#pragma once

#include <string>

#include "devices/external/external_settings.h"

namespace jnd {

// Of the rig file or of the command, exactly one of which is given. Throws InputError and UsageError.
ExternalSettings external_settings_of(const std::string& rig_file, const std::string& command);

// yes: a real rig may present without being asked for. Returns the exit code.
int external_rig_test(const ExternalSettings& settings, bool json, bool yes);

}  // namespace jnd
