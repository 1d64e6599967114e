// The console on whatever there is: a screen, or lines.
#pragma once

#include <memory>

#include "runner/console/console.h"

namespace jnd {

// keyboard: null for a live demonstration, without key presses; then lines are printed. What is passed by
// reference or pointer must outlive the console. A terminal that cannot show a screen gets lines.
std::unique_ptr<Console> make_console(const ConsoleOptions& options, const Protocol& protocol, Keyboard* keyboard,
                                      Clock& clock, const Interrupts& interrupts);

}  // namespace jnd
