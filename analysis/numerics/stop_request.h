// A request from outside, such as Ctrl-C, that long work should end. Who has something to undo looks at it in its
// loops, at least a few times a second.
#pragma once

#include <atomic>
#include <exception>

namespace jnd {

// Of this process. Thread rule: any thread, and signal handlers.
inline std::atomic<bool>& stop_requested() noexcept {
  static std::atomic<bool> requested{false};
  return requested;
}

// Long work was asked to stop. On the way out everything half done is undone. The program exits with 130.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

inline void stop_if_requested() {
  if (stop_requested().load(std::memory_order_relaxed)) throw Stopped();
}

}  // namespace jnd
