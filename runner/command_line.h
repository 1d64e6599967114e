// The program's commands, as a function: main() and the tests call it.
#pragma once

namespace jnd {

// Returns the exit code: 0 done, 1 a check found a problem, 2 usage, 3 invalid input, 4 device, 5 storage,
// 130 interrupted and resumable. Prints results to stdout and messages to stderr; never throws.
int run_command_line(int argc, const char* const* argv);

}  // namespace jnd
