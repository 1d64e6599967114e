// Early keys and keys that are held down do not answer a prompt.
#include "runner/held_keys.h"
#include "tests/catch.h"

namespace jnd {
namespace {

constexpr std::int64_t kMs = 1'000'000;

Key key(char32_t character, std::int64_t at_ms) {
  return {KeyName::character, character, at_ms * kMs};
}

TEST_CASE("A key pressed before the prompt never counts, one pressed after it does") {
  HeldKeys held;
  held.prompt(1000 * kMs);
  CHECK(held.hear(key('s', 999)) == Heard::early);
  CHECK(held.hear(key('d', 1000)) == Heard::counts);
}

TEST_CASE("A key that is held down since before the prompt never counts, however long it repeats") {
  HeldKeys held;
  CHECK(held.hear(key(' ', 0)) == Heard::counts);
  held.prompt(300 * kMs);
  CHECK(held.hear(key(' ', 500)) == Heard::held);  // the keyboard's first repetition
  for (int at = 530; at < 3000; at += 30) CHECK(held.hear(key(' ', at)) == Heard::held);
  CHECK(held.maybe_down(3000 * kMs));
  CHECK_FALSE(held.maybe_down(3700 * kMs));
  CHECK(held.hear(key(' ', 3700)) == Heard::counts);  // let go, and pressed again
}

TEST_CASE("A chain that begins after the prompt counts, and is held for the next one") {
  HeldKeys held;
  held.prompt(0);
  CHECK(held.hear(key('s', 100)) == Heard::counts);
  CHECK(held.hear(key('s', 600)) == Heard::counts);
  held.prompt(610 * kMs);
  CHECK(held.hear(key('s', 640)) == Heard::held);
}

TEST_CASE("Another key ends a chain, and a pause of more than the gap does") {
  HeldKeys held;
  (void)held.hear(key('s', 0));
  held.prompt(10 * kMs);
  CHECK(held.hear(key('d', 20)) == Heard::counts);
  CHECK(held.hear(key('s', 30)) == Heard::counts);
  held.prompt(40 * kMs);
  CHECK(held.hear(key('s', 631)) == Heard::counts);
  held.prompt(640 * kMs);
  CHECK(held.hear(key('s', 1231)) == Heard::held);
}

TEST_CASE("An early key's chain stays early") {
  HeldKeys held;
  held.prompt(1000 * kMs);
  CHECK(held.hear(key('s', 900)) == Heard::early);
  CHECK(held.hear(key('s', 1400)) == Heard::held);
}

}  // namespace
}  // namespace jnd
