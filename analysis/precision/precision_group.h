// The group's part of analysis/precision/precision.h; used by precision.cpp only.
#pragma once

#include <functional>

#include "analysis/precision/precision.h"

namespace jnd {

// Simulates result.question.experiments studies; fills result.group and result.contrasts.
void set_group_precision(Precision& result, const std::function<void(int)>& progress);

}  // namespace jnd
