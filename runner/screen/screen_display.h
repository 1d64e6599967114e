// The console as a full screen: ncurses on the alternate screen, drawn by the session's thread only.
#pragma once

#include <functional>
#include <memory>

#include "devices/clock.h"
#include "runner/console/console_display.h"
#include "runner/screen/screen_painter.h"

namespace jnd {

// None where the terminal cannot move its cursor. Until begin() and after end() lines are printed.
std::unique_ptr<Display> make_screen_display();
// On another painter, which is made when the session begins; none: lines are printed. clock: of the times on the screen.
std::unique_ptr<Display> make_screen_display(std::function<std::unique_ptr<Painter>()> painter,
                                             std::unique_ptr<Clock> clock);

}  // namespace jnd
