// The program's standard streams, each of which may be closed, full or gone at any time.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace jnd {

// Before any file is opened: the number of a standard stream that is closed is taken, so that no study or report gets
// it. Reading from or writing to such a stream goes on to fail.
void keep_standard_streams() noexcept;

// Messages, on standard error. What cannot be written there is lost, and nothing else happens.
void write_message(std::string_view text) noexcept;
template <typename... Args>
void print_message(fmt::format_string<Args...> text, Args&&... values) {
  write_message(fmt::format(text, std::forward<Args>(values)...));
}
// Each line behind "jnd: " and made safe for a terminal.
void write_marked_message(std::string_view message);

// Writes what is still to be written to standard output. Empty where all that was ever printed has been taken,
// otherwise why not: "No space left on device".
std::string output_trouble() noexcept;

}  // namespace jnd
