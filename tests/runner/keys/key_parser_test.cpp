// Bytes to keys, and keys that come early or are held.
#include "runner/keys/key_parser.h"

#include <string>
#include <vector>

#include <rapidcheck.h>

#include "runner/keys/held_keys.h"
#include "tests/catch.h"
#include "tests/units.h"

namespace jnd {
namespace {

// Bytes to keys: characters of every length, escape sequences as a whole, and nothing that comes in is ever a control
// character.

std::vector<Key> keys_of(const std::string& bytes) {
  KeyParser parser;
  std::vector<Key> keys;
  for (const char byte : bytes)
    if (const auto key = parser.feed(static_cast<unsigned char>(byte), 0)) keys.push_back(*key);
  if (const auto key = parser.quiet(KeyParser::kQuietGap_ns)) keys.push_back(*key);
  CHECK_FALSE(parser.waiting());
  return keys;
}

std::vector<KeyName> names_of(const std::string& bytes) {
  std::vector<KeyName> names;
  for (const Key& key : keys_of(bytes)) names.push_back(key.name);
  return names;
}

TEST_CASE("Characters of one to four bytes are keys") {
  const std::vector<Key> keys = keys_of("sé€𝄞");
  REQUIRE(keys.size() == 4);
  CHECK(keys[0].is(U's'));
  CHECK(keys[1].is(U'é'));
  CHECK(keys[2].is(U'€'));
  CHECK(keys[3].is(U'𝄞'));
}

TEST_CASE("A character that is cut short is no sequence, within which a key would mean nothing") {
  KeyParser parser;
  CHECK_FALSE(parser.feed(0xc3, 0));
  CHECK(parser.waiting());
  CHECK_FALSE(parser.within_sequence());
  const std::optional<Key> key = parser.feed('x', 1 * kMs);
  REQUIRE(key);
  CHECK(key->is(U'x'));
  CHECK_FALSE(parser.feed(0x1b, 2 * kMs));
  CHECK_FALSE(parser.feed('[', 2 * kMs));
  CHECK(parser.within_sequence());
}

TEST_CASE("Named keys, as xterm, the Linux console and a keypad send them") {
  using enum KeyName;
  CHECK(names_of("\r\n\t\x7f\b") == std::vector{enter, enter, tab, backspace, backspace});
  CHECK(names_of("\x1b[A\x1b[B\x1b[C\x1b[D") == std::vector{up, down, right, left});
  CHECK(names_of("\x1bOA\x1bOH\x1bOF\x1bOM") == std::vector{up, home, end, enter});
  CHECK(names_of("\x1b[H\x1b[F\x1b[1~\x1b[4~\x1b[7~\x1b[8~") == std::vector{home, end, home, end, home, end});
  CHECK(names_of("\x1b[3~\x1b[5~\x1b[6~") == std::vector{delete_, page_up, page_down});
  CHECK(names_of("\x1b[1;5A") == std::vector{up});                               // with Ctrl
  CHECK(names_of("\x1b[[A\x1b[15~\x1bOP") == std::vector{other, other, other});  // F1, F5, F1
  const std::vector<Key> keys = keys_of("\x1a");
  REQUIRE(keys.size() == 1);
  CHECK(keys[0].is(control));
  CHECK(keys[0].character == U'z');
}

TEST_CASE("An Escape byte is the Escape key only where it stands alone for a while") {
  KeyParser parser;
  CHECK_FALSE(parser.feed(0x1b, 10 * kMs));
  CHECK(parser.waiting());
  CHECK_FALSE(parser.quiet(10 * kMs + KeyParser::kQuietGap_ns - 1));
  const auto key = parser.quiet(10 * kMs + KeyParser::kQuietGap_ns);
  REQUIRE(key);
  CHECK(key->is(KeyName::escape));
  CHECK(key->time_ns == 10 * kMs);
  CHECK_FALSE(parser.quiet(1000 * kMs));

  // An arrow that a network has split is still one arrow, of the time of its first byte.
  CHECK_FALSE(parser.feed(0x1b, 2000 * kMs));
  CHECK_FALSE(parser.quiet(2050 * kMs));
  CHECK_FALSE(parser.feed('[', 2050 * kMs));
  CHECK(parser.within_sequence());
  CHECK_FALSE(parser.quiet(2100 * kMs));
  const auto arrow = parser.feed('A', 2100 * kMs);
  REQUIRE(arrow);
  CHECK(arrow->is(KeyName::up));
  CHECK(arrow->time_ns == 2000 * kMs);

  CHECK(names_of("\x1b\x1b[A") == std::vector{KeyName::escape, KeyName::up});
  CHECK(names_of("\x1bx") == std::vector{KeyName::other});  // Alt
}

TEST_CASE("What is no key is swallowed, and what follows is not") {
  CHECK(names_of("\x1b]0;a title\as").size() == 1);
  CHECK(names_of("\x1bP1$r0m\x1b\\s").size() == 1);
  CHECK(names_of("\x1b[?1;2cs") == std::vector{KeyName::other, KeyName::character});  // a terminal's answer
  CHECK(names_of("\x1b[12\rs") == std::vector{KeyName::enter, KeyName::character});   // broken off
  for (const std::string bad : {"\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xc2\x9b", "\xff\xfe", "\x80"})
    CHECK(keys_of(bad + "s").size() == 1);             // overlong, surrogate, beyond Unicode, a C1 control, no start
  const std::vector<Key> keys = keys_of("\xe2\x82s");  // cut short
  REQUIRE(keys.size() == 1);
  CHECK(keys[0].is(U's'));
}

TEST_CASE("Whatever comes in, no control character comes out, and a gap clears the state") {
  CHECK(rc::check([](const std::vector<unsigned char>& bytes) {
    KeyParser parser;
    std::int64_t now = 0;
    for (const unsigned char byte : bytes) {
      now += kMs;
      if (const auto key = parser.feed(byte, now)) {
        RC_ASSERT(key->time_ns <= now);
        if (key->name == KeyName::character) {
          RC_ASSERT(key->character >= 0x20U && key->character <= 0x10ffffU);
          RC_ASSERT(key->character < 0x7fU || key->character > 0x9fU);
          RC_ASSERT(key->character < 0xd800U || key->character > 0xdfffU);
        }
      }
    }
    (void)parser.quiet(now + KeyParser::kQuietGap_ns);
    RC_ASSERT(!parser.waiting());
    const auto key = parser.feed('s', now + 1);
    RC_ASSERT(key && key->is(U's'));
  }));
}

// Early keys and keys that are held down do not answer a prompt.

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
