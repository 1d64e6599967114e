// Keys and lines from standard input. On a terminal, keys come one by one without Enter; the terminal is put back at
// the end, also after an exception.
#pragma once

#include <optional>
#include <string>

#include <termios.h>

namespace jnd {

// Thread rule: one thread.
class Keyboard {
 public:
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  // The next key, or none after timeout_s. Line ends count as '\n' on a terminal and are skipped elsewhere.
  std::optional<char> key(double timeout_s);
  // A line, without its end; none at the end of input. Shows what is typed.
  std::optional<std::string> line();
  // Forgets keys that were pressed before now; on a terminal only, since a pipe's writer cannot wait.
  void forget_early_keys() const noexcept;
  bool at_end() const noexcept { return at_end_; }

 private:
  void raw(bool on) noexcept;

  bool terminal_;
  bool at_end_ = false;
  termios saved_{};
};

}  // namespace jnd
