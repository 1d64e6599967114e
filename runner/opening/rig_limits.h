// What a rig may do at most, and whether its description is a shipped one, in words.
#pragma once

#include <string>

#include "protocols/rigs/rig_description.h"

namespace jnd {

std::string limits_text(const DeviceSpec& device);  // "4.7 N, 2000 N/m"
std::string limits_text(const RigSpec& rig);        // "rrs3 at most 4.7 N, 2000 N/m; mckibben at most ..."

// Whether each of the files is, to the byte, one that was shipped with this program, wherever it was read from.
bool is_shipped(const RigSpec& rig) noexcept;
// "not the shipped rrs3", or "not a shipped device" where none of that name is; empty where it is shipped.
std::string not_shipped_text(const RigSpec& rig);

}  // namespace jnd
