// What the commands that look after a study have in common.
#pragma once

#include "data/log/session_log.h"
#include "runner/terminal/json_output.h"

namespace jnd {

// This machine's clocks.
Stamp stamp_now();

}  // namespace jnd
