#include "devices/hid/buttons/button_mapping.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

namespace jnd {

namespace {

constexpr std::array<std::string_view, kButtonMeanings> kWords = {"same", "different", "stop"};
constexpr std::array<std::string_view, kButtonMeanings> kShouted = {"SAME", "DIFFERENT", "STOP"};
// A keyboard says so in every place of its array where more keys are down than it can tell (HID usage tables, 0x07).
constexpr std::uint8_t kErrorRollOver = 0x01;

}  // namespace

std::string_view to_string(ButtonMeaning meaning) noexcept {
  return kWords[static_cast<std::size_t>(meaning)];
}

std::string_view shouted(ButtonMeaning meaning) noexcept {
  return kShouted[static_cast<std::size_t>(meaning)];
}

bool ButtonMapping::is(const HidInfo& info) const {
  return info.vendor == vendor && info.product == product && info.usage_page == usage_page && info.usage == usage &&
         (!serial || info.serial == *serial);
}

std::optional<bool> is_pressed(const MappedButton& button, std::span<const std::uint8_t> report) noexcept {
  if (const auto* bits = std::get_if<ButtonBits>(&button.where))
    return (report[static_cast<std::size_t>(bits->byte)] & bits->mask) == bits->pressed;
  const auto* code = std::get_if<ButtonCode>(&button.where);
  const auto keys = report.subspan(static_cast<std::size_t>(code->first),
                                   static_cast<std::size_t>(code->last) - static_cast<std::size_t>(code->first) + 1);
  if (std::all_of(keys.begin(), keys.end(), [](std::uint8_t key) { return key == kErrorRollOver; }))
    return std::nullopt;
  return std::find(keys.begin(), keys.end(), code->code) != keys.end();
}

bool confusable(const MappedButton& a, const MappedButton& b) noexcept {
  const auto* bits_a = std::get_if<ButtonBits>(&a.where);
  const auto* bits_b = std::get_if<ButtonBits>(&b.where);
  const auto* code_a = std::get_if<ButtonCode>(&a.where);
  const auto* code_b = std::get_if<ButtonCode>(&b.where);
  if (bits_a != nullptr && bits_b != nullptr) {
    if (bits_a->byte != bits_b->byte) return false;
    const bool part = (bits_b->mask & ~bits_a->mask) == 0;
    return part && (bits_a->pressed & bits_b->mask) == bits_b->pressed;
  }
  if (code_a != nullptr && code_b != nullptr)
    return code_a->code == code_b->code && code_a->first <= code_b->last && code_b->first <= code_a->last;
  const ButtonBits* bits = bits_a != nullptr ? bits_a : bits_b;
  const ButtonCode* code = code_a != nullptr ? code_a : code_b;
  return bits->byte >= code->first && bits->byte <= code->last;
}

std::string described(const MappedButton& button) {
  if (const auto* code = std::get_if<ButtonCode>(&button.where)) return fmt::format("key code {}", code->code);
  const auto* bits = std::get_if<ButtonBits>(&button.where);
  if (std::popcount(bits->mask) == 1)
    return fmt::format("byte {}, bit {}{}", bits->byte, std::countr_zero(bits->mask),
                       bits->pressed == 0 ? " (0 where pressed)" : "");
  return fmt::format("byte {}, value 0x{:02x} of 0x{:02x}", bits->byte, bits->pressed, bits->mask);
}

}  // namespace jnd
