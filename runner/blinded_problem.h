// What verify may say about a study whose plan is sealed.
#pragma once

#include <string>
#include <vector>

#include "data/study.h"

namespace jnd {

// The problems as they are where nothing is sealed. Otherwise those that tell of a condition, series, stiffness or the
// seed say only where they are. A study too damaged to know counts as sealed.
std::vector<std::string> unsealed_problems(std::vector<std::string> problems, const Study& study);

}  // namespace jnd
