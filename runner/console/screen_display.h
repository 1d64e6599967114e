// The console as a full screen: ncurses on the alternate screen, drawn by the session's thread only.
#pragma once

#include <memory>

#include "runner/console/console_display.h"

namespace jnd {

// None where the terminal cannot move its cursor. Until begin() and after end() lines are printed.
std::unique_ptr<Display> make_screen_display();

}  // namespace jnd
