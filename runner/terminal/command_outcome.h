// The boundary of a command: what it throws becomes words and an exit code.
#pragma once

#include <functional>

namespace jnd {

// Runs the command and returns its exit code, or the one of what it throws, said on standard error. Where its results
// could not be printed in full, 0 becomes 5; where a signal came too late to stop it, 0 becomes 130, with words too.
int outcome_of(const std::function<int()>& command) noexcept;

}  // namespace jnd
