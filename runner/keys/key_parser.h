// From the bytes of a terminal to the keys that were pressed.
//
// Decodes UTF-8 and the escape sequences that terminals send (ECMA-48 control sequences and strings, xterm's and the
// Linux console's function keys). Bytes that are no key are swallowed, a sequence as a whole: an arrow is never taken
// for Escape, nor for letters. Pure: no I/O, no clock, and a state of a few bytes whatever comes in.
#pragma once

#include <cstdint>
#include <optional>

namespace jnd {

enum class KeyName : std::uint8_t {
  character,  // Key::character
  enter,
  tab,
  backspace,
  escape,
  up,
  down,
  left,
  right,
  home,
  end,
  page_up,
  page_down,
  delete_,
  control,  // Ctrl with the letter Key::character
  other     // a key that means nothing here, also Alt with a character
};

struct Key {
  KeyName name = KeyName::character;
  char32_t character = 0;    // never a control character, a surrogate or beyond Unicode
  std::int64_t time_ns = 0;  // when its first byte was read

  bool is(char32_t wanted) const noexcept { return name == KeyName::character && character == wanted; }
  bool is(KeyName wanted) const noexcept { return name == wanted; }
  bool same_key(const Key& other) const noexcept { return name == other.name && character == other.character; }
};

class KeyParser {
 public:
  // After an Escape byte the rest of a sequence comes at once; this much later it was the Escape key. Long enough for a
  // sequence that a slow network has split.
  static constexpr std::int64_t kQuietGap_ns = 100'000'000;

  // The next byte and when it was read; the key that it completes, if any. Call quiet() first.
  std::optional<Key> feed(unsigned char byte, std::int64_t time_ns) noexcept;
  // Nothing more has come until now_ns: the Escape key where it stands alone; any other unfinished sequence is dropped.
  // None where nothing waits, or the gap has not passed yet.
  std::optional<Key> quiet(std::int64_t now_ns) noexcept;
  // Some bytes of an unfinished key are in: call quiet() once the gap has passed.
  bool waiting() const noexcept { return state_ != State::ground; }
  // Within a control sequence, whose bytes are no characters. A character that is cut short is none: what follows it is
  // a key.
  bool within_sequence() const noexcept {
    return state_ != State::ground && state_ != State::escape && state_ != State::utf8;
  }

 private:
  enum class State : std::uint8_t {
    ground,
    utf8,
    escape,
    control_sequence,
    console_key,
    single_shift,
    string,
    string_end
  };

  std::optional<Key> on_ground(unsigned char byte, std::int64_t time_ns) noexcept;
  std::optional<Key> in_utf8(unsigned char byte, std::int64_t time_ns) noexcept;
  std::optional<Key> after_escape(unsigned char byte, std::int64_t time_ns) noexcept;
  std::optional<Key> in_control_sequence(unsigned char byte) noexcept;
  Key finish(KeyName name, char32_t character = 0) noexcept;

  State state_ = State::ground;
  std::int64_t began_ns_ = 0, latest_ns_ = 0;  // first and latest byte of what is unfinished
  char32_t character_ = 0, least_ = 0;  // of a UTF-8 character: bits so far, and the least code point of its length
  int more_ = 0;                        // bytes still to come
  int parameter_ = 0;                   // first parameter of a control sequence, saturating
  bool first_parameter_ = true;
};

}  // namespace jnd
