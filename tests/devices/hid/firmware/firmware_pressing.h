// A device that presses, for the tests of what may happen to it.
#pragma once

#include <cmath>

#include "tests/catch.h"
#include "tests/devices/hid/firmware/firmware_fixtures.h"

namespace jnd::testing {

// A device that has pressed for so many milliseconds, a command each.
struct Pressing {
  explicit Pressing(int milliseconds = 300) {
    REQUIRE(board.power_up());
    board.step();
    for (int i = 0; i < milliseconds; ++i) {
      board.give(pressing(++sequence));
      telemetry = *board.step();
    }
  }
  Board board;
  std::uint32_t sequence = 0;
  jnd_telemetry telemetry{};
};

inline double torque_of(const Board& board) {
  double sum = 0;
  for (const float torque : board.given.torque_n_m) sum += std::abs(torque);
  return sum;
}

}  // namespace jnd::testing
