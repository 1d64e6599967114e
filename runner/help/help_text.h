// `jnd --help` and `jnd COMMAND --help`.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "runner/help/command_page.h"

namespace jnd {

// The page of a command, or of a command that has commands of its own, as they stand under their headings. columns: of the
// terminal, that lines are broken at.
std::string help_text(const CommandPage& page, std::size_t columns);

struct EnvironmentVariable {
  std::string name, what;
};
// That the program reads, of those that a user may want to set.
const std::vector<EnvironmentVariable>& environment_variables();

// What stands below the program's own page: where to begin, the exit codes, the environment.
std::string program_closing(std::size_t columns);

// The exit codes, a line each: "0  done".
std::string exit_codes_text();

}  // namespace jnd
