// `jnd --version`.
#pragma once

#include <string>

namespace jnd {

// "jnd 0.1.0" on the first line, for scripts; below it how it was built, and the libraries. Those that are linked
// when the program starts say their versions themselves; the others were read when it was compiled.
std::string version_text();

}  // namespace jnd
