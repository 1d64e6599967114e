// Waits for what another thread or program does.
#pragma once

#include <chrono>
#include <thread>

namespace jnd {

// Looks each millisecond until the condition holds; true then. False after ten minutes: that guard ends a test that
// hangs, and no result depends on how fast the machine is.
template <typename Condition>
[[nodiscard]] bool wait_until(const Condition& condition) {
  const auto guard = std::chrono::steady_clock::now() + std::chrono::minutes(10);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > guard) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace jnd
