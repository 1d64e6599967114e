// What verify and its like may say about a study whose plan is sealed.
#pragma once

#include <string>
#include <vector>

#include "data/study/problem.h"
#include "data/study/study.h"

namespace jnd {

// plan_sealed(); a study too damaged to know counts as sealed.
bool is_sealed(const Study& study);
// The problems in words where nothing is sealed. Otherwise those that give something of the plan away say only where
// they are.
std::vector<std::string> unsealed_problems(const std::vector<Problem>& problems, const Study& study);
// As of a study whose plan is sealed, where it was not looked up whether it is.
std::vector<std::string> sealed_problems(const std::vector<Problem>& problems);

}  // namespace jnd
