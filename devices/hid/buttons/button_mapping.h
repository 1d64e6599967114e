// Which bits of which report of a gamepad, keypad or pedal mean "same", "different" and "stop": a JSON file that
// `jnd device learn-buttons` writes and `jnd run --buttons` reads.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "devices/hid/hid_bus.h"

namespace jnd {

enum class ButtonMeaning { same, different, stop };
inline constexpr std::size_t kButtonMeanings = 3;
std::string_view to_string(ButtonMeaning meaning) noexcept;  // as in the file
std::string_view shouted(ButtonMeaning meaning) noexcept;    // "SAME", as people are told

// Bytes are counted from 0 in the report as it is read, so that of numbered reports byte 0 is the report's number.

// Pressed where (report[byte] & mask) == pressed.
struct ButtonBits {
  int byte = 0;
  std::uint8_t mask = 0, pressed = 0;
};

// Pressed where `code` is one of the bytes first..last: a key of a keyboard in boot format.
struct ButtonCode {
  int first = 0, last = 0;
  std::uint8_t code = 0;
};

struct MappedButton {
  ButtonMeaning meaning = ButtonMeaning::same;
  std::variant<ButtonBits, ButtonCode> where;
};

struct ButtonMapping {
  std::uint16_t vendor = 0, product = 0, usage_page = 0, usage = 0;
  std::optional<std::string> serial;  // none: any box of that make
  std::string name;
  std::optional<int> report_id;  // none: reports are not numbered
  int report_bytes = 0;          // of the report, its number included
  std::vector<MappedButton> buttons;
  int debounce_ms = 10;
  std::string sha256;  // of the file; empty where there is none

  bool is(const HidInfo& info) const;
};

// Whether the button is down in a report that is long enough; none where the report does not say, as of a keyboard with
// too many keys down.
std::optional<bool> is_pressed(const MappedButton& button, std::span<const std::uint8_t> report) noexcept;
// Whether b can count as pressed because a is.
bool confusable(const MappedButton& a, const MappedButton& b) noexcept;
// "byte 3, bit 0", for people.
std::string described(const MappedButton& button);

// Throws InputError with all that is wrong. file: for messages.
ButtonMapping parse_button_mapping(std::string_view bytes, const std::string& file);
ButtonMapping load_button_mapping(const std::filesystem::path& path);
// The file's text, which parses to the same mapping.
std::string to_json(const ButtonMapping& mapping);

}  // namespace jnd
