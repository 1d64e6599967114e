// Early keys and keys that are held down do not answer a prompt.
#include "runner/keys/held_keys.h"
#include "tests/catch.h"
#include "tests/units.h"

namespace jnd {
namespace {

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
  CHECK(held.hear(key(' ', 1000)) == Heard::held);  // the first repetition, where a keyboard waits longest
  for (int at = 1030; at < 3000; at += 30) CHECK(held.hear(key(' ', at)) == Heard::held);
  CHECK(held.maybe_down(3000 * kMs));
  CHECK_FALSE(held.maybe_down(3700 * kMs));
  CHECK(held.hear(key(' ', 3700)) == Heard::counts);  // let go, and pressed again
}

TEST_CASE("A key that came once may be down for longer than one that repeats") {
  HeldKeys held;
  (void)held.hear(key('s', 0));
  CHECK(held.maybe_down(1100 * kMs));
  CHECK_FALSE(held.maybe_down(1101 * kMs));
  held.prompt(10 * kMs);
  CHECK(held.hear(key('s', 1101)) == Heard::counts);
  CHECK(held.hear(key('s', 1200)) == Heard::counts);
  CHECK(held.maybe_down(1800 * kMs));
  CHECK_FALSE(held.maybe_down(1801 * kMs));
}

TEST_CASE("A chain that begins after the prompt counts, and is held for the next one") {
  HeldKeys held;
  held.prompt(0);
  CHECK(held.hear(key('s', 100)) == Heard::counts);
  CHECK(held.hear(key('s', 600)) == Heard::counts);
  held.prompt(610 * kMs);
  CHECK(held.hear(key('s', 640)) == Heard::held);
}

TEST_CASE("Another key, as of a second keyboard, does not hide that a key repeats") {
  HeldKeys held;
  (void)held.hear(key('s', 0));
  (void)held.hear(key('s', 500));
  held.prompt(510 * kMs);
  CHECK(held.hear(key('d', 520)) == Heard::counts);
  CHECK(held.hear(key('s', 530)) == Heard::held);
  CHECK(held.hear(key('d', 540)) == Heard::counts);
  CHECK(held.hear(key('s', 1130)) == Heard::held);
  CHECK(held.hear(key('s', 1731)) == Heard::counts);
}

TEST_CASE("A key that came once was let go when another one comes") {
  HeldKeys held;
  (void)held.hear(key('s', 0));
  held.prompt(10 * kMs);
  CHECK(held.hear(key(' ', 300)) == Heard::counts);
  CHECK_FALSE(held.hear(key('s', 600)) == Heard::held);
}

TEST_CASE("An early key's chain stays early") {
  HeldKeys held;
  held.prompt(1000 * kMs);
  CHECK(held.hear(key('s', 900)) == Heard::early);
  CHECK(held.hear(key('s', 1400)) == Heard::held);
}

}  // namespace
}  // namespace jnd
