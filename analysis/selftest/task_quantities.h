// The self-test of tasks other than same-different, a part of selftest() for each wing.
#pragma once

#include <vector>

#include "analysis/selftest/selftest.h"

namespace jnd {

std::vector<SelftestQuantity> choice_quantities();
std::vector<SelftestQuantity> ratings_quantities();

}  // namespace jnd
