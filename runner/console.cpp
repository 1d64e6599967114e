#include "runner/console.h"

#include <unistd.h>

#include "runner/console_lines.h"
#include "runner/interrupt.h"
#include "runner/screen_display.h"
#include "runner/session_console.h"
#include "runner/terminal.h"

namespace jnd {

std::unique_ptr<Console> make_console(const ConsoleOptions& options, const Protocol& protocol, Keyboard* keyboard,
                                      Clock& clock, const Interrupts& interrupts) {
  std::unique_ptr<Display> display;
  const bool terminal = keyboard != nullptr && keyboard->is_terminal();
  if (terminal && is_terminal(STDOUT_FILENO) && !options.plain) display = make_screen_display();
  if (!display) {
    outlive_readers();  // after the keyboard, which takes such a signal for a crash
    display = std::make_unique<LineDisplay>(terminal);
  }
  return std::make_unique<SessionConsole>(options, protocol, keyboard, clock, interrupts, std::move(display));
}

}  // namespace jnd
