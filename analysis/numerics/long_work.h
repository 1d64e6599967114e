// Who wants to know how far long work is: a program sets it once, and who works long tells it.
#pragma once

#include <functional>

namespace jnd {

// Called from time to time, by one thread at a time, with what is done and of how much.
using WorkProgress = std::function<void(int done, int of)>;

// Of this process. Thread rule: set before work begins.
inline WorkProgress& work_progress() {
  static WorkProgress progress;
  return progress;
}

}  // namespace jnd
