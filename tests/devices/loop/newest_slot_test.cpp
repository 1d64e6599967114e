// The newest value between two threads.
#include "devices/loop/newest_slot.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "tests/catch.h"

using jnd::NewestSlot;

TEST_CASE("the newest value is seen, and seen again until there is a newer one", "[newest_slot]") {
  NewestSlot<int> slot;
  CHECK(slot.look() == 0);
  slot.put(1);
  slot.put(2);
  CHECK(slot.look() == 2);
  CHECK(slot.look() == 2);
  slot.put(3);
  CHECK(slot.look() == 3);
}

TEST_CASE("values between two threads are whole, and never older than one seen before", "[newest_slot]") {
  struct Block {
    std::array<std::uint64_t, 24> words{};
  };
  NewestSlot<Block> slot;
  constexpr std::uint64_t kLast = 200'000;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      Block block;
      block.words.fill(i);
      slot.put(block);
    }
    done.store(true);
  });
  std::uint64_t last = 0;
  int torn = 0, older = 0;
  bool over = false;
  while (!over) {
    over = done.load();
    const Block block = slot.look();
    for (const std::uint64_t word : block.words)
      if (word != block.words[0]) ++torn;
    if (block.words[0] < last) ++older;
    last = block.words[0];
  }
  writer.join();
  CHECK(torn == 0);
  CHECK(older == 0);
  CHECK(last == kLast);
}
