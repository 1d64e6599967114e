#include "runner/keys/key_parser.h"

#include <algorithm>

namespace jnd {

namespace {

constexpr unsigned char kEscape = 0x1b, kBell = 0x07, kDelete = 0x7f;
constexpr int kLargestParameter = 9999;

bool is_control(char32_t character) noexcept {
  return character < 0x20 || (character >= 0x7f && character < 0xa0);
}

KeyName name_of_letter(unsigned char final_byte) noexcept {
  switch (final_byte) {
    case 'A':
      return KeyName::up;
    case 'B':
      return KeyName::down;
    case 'C':
      return KeyName::right;
    case 'D':
      return KeyName::left;
    case 'H':
      return KeyName::home;
    case 'F':
      return KeyName::end;
    case 'M':  // of a keypad in application mode
      return KeyName::enter;
    default:
      return KeyName::other;
  }
}

KeyName name_of_number(int parameter) noexcept {
  switch (parameter) {
    case 1:
    case 7:
      return KeyName::home;
    case 3:
      return KeyName::delete_;
    case 4:
    case 8:
      return KeyName::end;
    case 5:
      return KeyName::page_up;
    case 6:
      return KeyName::page_down;
    default:
      return KeyName::other;
  }
}

}  // namespace

Key KeyParser::finish(KeyName name, char32_t character) noexcept {
  state_ = State::ground;
  return {name, character, began_ns_};
}

std::optional<Key> KeyParser::feed(unsigned char byte, std::int64_t time_ns) noexcept {
  latest_ns_ = time_ns;
  switch (state_) {
    case State::ground:
      return on_ground(byte, time_ns);
    case State::utf8:
      return in_utf8(byte, time_ns);
    case State::escape:
      return after_escape(byte, time_ns);
    case State::control_sequence:
      if (byte < 0x20) return on_ground(byte, time_ns);  // broken off
      return in_control_sequence(byte);
    case State::console_key:
    case State::single_shift:
      if (byte < 0x20) return on_ground(byte, time_ns);
      return finish(state_ == State::single_shift ? name_of_letter(byte) : KeyName::other);
    case State::string:
      if (byte == kBell) state_ = State::ground;
      if (byte == kEscape) state_ = State::string_end;
      return std::nullopt;
    case State::string_end:
      if (byte == '\\') {
        state_ = State::ground;
        return std::nullopt;
      }
      return after_escape(byte, time_ns);
  }
  return std::nullopt;
}

std::optional<Key> KeyParser::quiet(std::int64_t now_ns) noexcept {
  if (!waiting() || now_ns - latest_ns_ < kQuietGap_ns) return std::nullopt;
  const bool alone = state_ == State::escape;
  state_ = State::ground;
  if (alone) return Key{KeyName::escape, 0, began_ns_};
  return std::nullopt;
}

std::optional<Key> KeyParser::on_ground(unsigned char byte, std::int64_t time_ns) noexcept {
  state_ = State::ground;
  began_ns_ = time_ns;
  if (byte == kEscape) {
    state_ = State::escape;
    return std::nullopt;
  }
  if (byte == '\r' || byte == '\n') return finish(KeyName::enter);
  if (byte == '\t') return finish(KeyName::tab);
  if (byte == kDelete || byte == '\b') return finish(KeyName::backspace);
  if (byte >= 1 && byte <= 26) return finish(KeyName::control, static_cast<char32_t>('a' + byte - 1));
  if (byte < 0x20) return finish(KeyName::other);
  if (byte < 0x80) return finish(KeyName::character, byte);
  // The first byte of a longer character; bytes that cannot be one are dropped.
  if (byte >= 0xc2 && byte <= 0xdf) {
    character_ = byte & 0x1f;
    more_ = 1;
    least_ = 0x80;
  } else if (byte >= 0xe0 && byte <= 0xef) {
    character_ = byte & 0x0f;
    more_ = 2;
    least_ = 0x800;
  } else if (byte >= 0xf0 && byte <= 0xf4) {
    character_ = byte & 0x07;
    more_ = 3;
    least_ = 0x10000;
  } else {
    return std::nullopt;
  }
  state_ = State::utf8;
  return std::nullopt;
}

std::optional<Key> KeyParser::in_utf8(unsigned char byte, std::int64_t time_ns) noexcept {
  if ((byte & 0xc0) != 0x80) return on_ground(byte, time_ns);  // the character is cut short
  character_ = (character_ << 6) | (byte & 0x3f);
  if (--more_ > 0) return std::nullopt;
  const bool surrogate = character_ >= 0xd800 && character_ <= 0xdfff;
  if (character_ < least_ || character_ > 0x10ffff || surrogate || is_control(character_)) {
    state_ = State::ground;
    return std::nullopt;
  }
  return finish(KeyName::character, character_);
}

std::optional<Key> KeyParser::after_escape(unsigned char byte, std::int64_t time_ns) noexcept {
  switch (byte) {
    case kEscape: {  // the first stood alone
      const Key key{KeyName::escape, 0, began_ns_};
      began_ns_ = time_ns;
      state_ = State::escape;
      return key;
    }
    case '[':
      state_ = State::control_sequence;
      parameter_ = 0;
      first_parameter_ = true;
      return std::nullopt;
    case 'O':
      state_ = State::single_shift;
      return std::nullopt;
    case ']':  // strings, such as a terminal's answers
    case 'P':
    case 'X':
    case '^':
    case '_':
      state_ = State::string;
      return std::nullopt;
    default:
      return finish(KeyName::other);
  }
}

std::optional<Key> KeyParser::in_control_sequence(unsigned char byte) noexcept {
  if (byte == '[' && first_parameter_ && parameter_ == 0) {
    state_ = State::console_key;
    return std::nullopt;
  }
  if (byte >= '0' && byte <= '9') {
    if (first_parameter_) parameter_ = std::min(parameter_ * 10 + (byte - '0'), kLargestParameter);
    return std::nullopt;
  }
  if (byte < 0x40) {  // separators, private marks, intermediates
    first_parameter_ = false;
    return std::nullopt;
  }
  if (byte >= 0x7f) return finish(KeyName::other);
  return finish(byte == '~' ? name_of_number(parameter_) : name_of_letter(byte));
}

}  // namespace jnd
