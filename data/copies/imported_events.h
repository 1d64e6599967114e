// Events of a study's own chain when its sessions come into a new study.
#pragma once

#include <string_view>

namespace jnd {

// Whether such an event goes on to hold and is appended to the new chain too: exclusions, notes, unblindings and what
// later programs add. Only a study's creation and the closings of its sessions are written anew.
bool is_imported(std::string_view kind) noexcept;

}  // namespace jnd
