// Puts the terminal back, however the program ends. Only SIGKILL leaves it as it is: there the shell's `reset` helps.
#pragma once

#include <string_view>

#include <termios.h>

namespace jnd {

// From here on a crash or another signal that ends the program (SIGSEGV, SIGABRT, SIGQUIT, SIGPIPE, SIGUSR1, ...),
// std::terminate and exit put the terminal back to `settings` first. Handlers are installed once. SIGTSTP is ignored as
// long as a session has the terminal, since a session must not be frozen while a device is on a finger.
void guard_terminal(const termios& settings) noexcept;
void forget_terminal() noexcept;
// What leaves the full screen and shows the cursor again; empty: nothing is needed. Copied, at most 255 bytes.
void guard_screen(std::string_view leave) noexcept;
// Writes that and sets the terminal's settings. Safe in a signal handler; does nothing where nothing is guarded.
void restore_terminal() noexcept;
// How often the terminal may have lost its settings or what stood on it, and needs both anew: the program was stopped
// (SIGSTOP) and went on, or the window was resized. It may have its old size again when it is looked at.
int terminal_losses() noexcept;

}  // namespace jnd
