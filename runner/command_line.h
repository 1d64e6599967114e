// The program's commands, as a function: main() and the tests call it.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace jnd {

// Adds every command to the app, which is new. Where arguments are read with it, chosen becomes the command that they
// name, not yet run; both must live as long as the app is used.
void build_program(CLI::App& app, std::function<int()>& chosen);

// Returns the exit code: 0 done, 1 a check found a problem, 2 usage, 3 invalid input, 4 device, 5 storage,
// 130 interrupted and resumable. Prints results to stdout and messages to stderr; never throws.
int run_command_line(int argc, const char* const* argv);

}  // namespace jnd
