// What long work has to do with who waits for it: a request from outside, such as Ctrl-C, that it should end, and how
// far it is. Who has something to undo looks at the request in its loops, at least a few times a second.
#pragma once

#include <atomic>
#include <exception>
#include <functional>

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

// Called from time to time, by one thread at a time, with what is done and of how much. Of this process. Thread rule: set
// before work begins.
inline std::function<void(int done, int of)>& work_progress() {
  static std::function<void(int done, int of)> progress;
  return progress;
}

}  // namespace jnd
