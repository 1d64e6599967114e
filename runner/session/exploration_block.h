// Free interaction: every condition's turn with its objects, each for its time.
#pragma once

#include <functional>

#include "data/log/event_body.h"
#include "runner/session/session_parts.h"

namespace jnd {

// Conducts Plan::explorations from the first that state has not. after_condition(condition, slots_done) is called when
// all objects of a block were explored or given up, after_block(slots_done, last) after it; slots_done counts the
// planned slots so far, however often they were repeated, and a session that goes on calls both for its earlier blocks
// too. An attempt that ends in a fault or an emergency stop comes again, until the protocol's most attempts are used
// up; a pause takes nothing from its time; what the operator ends early counts, with the time it really had. Throws
// SessionEnds, StorageError.
void run_explorations(const SessionParts& parts, const SessionRecorder& recorder, SessionState& state,
                      const std::function<void(int condition, int slots_done)>& after_condition,
                      const std::function<void(int slots_done, bool last)>& after_block);

}  // namespace jnd
