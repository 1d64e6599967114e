#include "runner/screen/make_console.h"

#include <utility>

#include <unistd.h>

#include "runner/console/console_lines.h"
#include "runner/console/session_console.h"
#include "runner/keys/interrupt.h"
#include "runner/keys/keyboard.h"
#include "runner/screen/screen_display.h"
#include "runner/terminal/terminal.h"

namespace jnd {

std::unique_ptr<Console> make_console(const ConsoleOptions& options, const Protocol& protocol, Keyboard* keyboard,
                                      Clock& clock, const Interrupts& interrupts) {
  std::unique_ptr<Display> display;
  const bool terminal = keyboard != nullptr && keyboard->is_terminal();
  if (terminal && is_terminal(STDOUT_FILENO) && !options.plain) display = make_screen_display();
  if (!display) display = std::make_unique<LineDisplay>(terminal);
  outlive_readers();  // after the keyboard, which takes such a signal for a crash
  return std::make_unique<SessionConsole>(options, protocol, keyboard, clock, interrupts, std::move(display));
}

}  // namespace jnd
