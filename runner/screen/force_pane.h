// Force and depth on the screen, where the operator may see them.
#pragma once

#include <vector>

#include "runner/console/force_trace.h"
#include "runner/screen/screen_parts.h"

namespace jnd {

// A line for each device, and where there is room for them the last seconds as curves. At most `room` rows.
std::vector<Row> force_rows(const Area& area, const ForceTrace& trace, int room);

}  // namespace jnd
