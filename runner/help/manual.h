// `jnd man`: a manual page a command, in the language of man (roff).
#pragma once

#include <string>

#include "runner/help/command_page.h"

namespace jnd {

// "jnd-device-test.1".
std::string manual_file(const CommandPage& page);
// program: the page of the program itself, which the others point to.
std::string manual_page(const CommandPage& page, const CommandPage& program);

}  // namespace jnd
