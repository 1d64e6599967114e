// Which bytes of what was heard are the button, and what that makes as a mapping.
#include <set>

#include <fmt/format.h>

#include "devices/hid/buttons/button_learner.h"

namespace jnd {

namespace {

constexpr std::uint16_t kGenericDesktop = 0x01, kKeyboard = 0x06, kKeypad = 0x07;

// Two directions of a hat share bits: they differ in all that either changes, not only in those that each does. Bits of
// their own stay apart, so that both can be seen to be down.
void widen(ButtonBits& bits, std::uint8_t held_value, std::uint8_t mask) {
  if ((bits.mask & mask) == 0) return;
  bits.mask |= mask;
  bits.pressed = held_value & bits.mask;
}

}  // namespace

std::string ButtonLearner::objection(const Found& found) const {
  for (const Found& other : learnt_) {
    if (other.report_id != found.report_id)
      return fmt::format("{} comes in report {}, {} in report {}: take buttons of the same kind.",
                         shouted(found.button.meaning), found.report_id, shouted(other.button.meaning),
                         other.report_id);
    Found a = found, b = other;
    auto *bits_a = std::get_if<ButtonBits>(&a.button.where), *bits_b = std::get_if<ButtonBits>(&b.button.where);
    if (bits_a != nullptr && bits_b != nullptr && bits_a->byte == bits_b->byte) {
      const std::uint8_t mask_a = bits_a->mask;
      widen(*bits_a, a.held_value, bits_b->mask);
      widen(*bits_b, b.held_value, mask_a);
    }
    if (confusable(a.button, b.button) || confusable(b.button, a.button))
      return fmt::format("That was {} again: take another button for {}.", shouted(other.button.meaning),
                         shouted(found.button.meaning));
  }
  return {};
}

bool ButtonLearner::keyboard_array(const Stream& stream, std::size_t byte) const {
  const std::size_t begin = setup_.numbered ? 1 : 0;
  return setup_.info.usage_page == kGenericDesktop &&
         (setup_.info.usage == kKeyboard || setup_.info.usage == kKeypad) && stream.latest.size() == begin + 8 &&
         byte >= begin + 2;
}

std::optional<ButtonLearner::Found> ButtonLearner::candidate(int report_id, const Stream& stream,
                                                             std::size_t byte) const {
  const std::uint8_t steady = stream.steady(byte);
  const auto differ = [&](const Bytes& a, const Bytes& b) { return ((a[byte] ^ b[byte]) & steady) != 0; };
  if (!differ(stream.held, stream.released) || differ(stream.held, stream.held_again) ||
      differ(stream.released, stream.released_again) || (!stream.rest.empty() && differ(stream.rest, stream.released)))
    return std::nullopt;
  std::set<int> values;
  for (std::size_t value = 0; value < 256; ++value)
    if (stream.seen[byte].test(value)) values.insert(static_cast<int>(value) & steady);
  if (values.size() != 2) return std::nullopt;
  Found found;
  found.button.meaning = wanted();
  found.report_id = report_id;
  found.report_bytes = stream.latest.size();
  found.held_value = stream.held[byte];
  if (keyboard_array(stream, byte) && steady == 0xff && stream.released[byte] == 0 && stream.held[byte] >= 4) {
    const int first = setup_.numbered ? 3 : 2;
    found.button.where = ButtonCode{first, first + 5, stream.held[byte]};
    return found;
  }
  ButtonBits bits;
  bits.byte = static_cast<int>(byte);
  bits.mask = static_cast<std::uint8_t>((stream.held[byte] ^ stream.released[byte]) & steady);
  bits.pressed = static_cast<std::uint8_t>(stream.held[byte] & bits.mask);
  found.button.where = bits;
  return found;
}

std::vector<ButtonLearner::Found> ButtonLearner::candidates() const {
  std::vector<Found> found;
  for (const auto& [id, stream] : streams_) {
    const std::size_t size = stream.latest.size();
    if (stream.held.size() != size || stream.released.size() != size || stream.held_again.size() != size ||
        stream.released_again.size() != size)
      continue;
    for (std::size_t byte = 0; byte < size; ++byte)
      if (const std::optional<Found> one = candidate(id, stream, byte)) found.push_back(*one);
  }
  return found;
}

ButtonMapping ButtonLearner::mapping() const {
  ButtonMapping mapping;
  mapping.vendor = setup_.info.vendor;
  mapping.product = setup_.info.product;
  mapping.usage_page = setup_.info.usage_page;
  mapping.usage = setup_.info.usage;
  if (!setup_.info.serial.empty()) mapping.serial = setup_.info.serial;
  mapping.name = setup_.info.product_name.empty() ? "button box" : setup_.info.product_name;
  if (setup_.numbered) mapping.report_id = learnt_.front().report_id;
  mapping.report_bytes = static_cast<int>(learnt_.front().report_bytes);
  mapping.debounce_ms = setup_.debounce_ms;
  for (const Found& found : learnt_) {
    MappedButton button = found.button;
    if (auto* bits = std::get_if<ButtonBits>(&button.where))
      for (const Found& other : learnt_)
        if (const auto* others = std::get_if<ButtonBits>(&other.button.where); others && others->byte == bits->byte)
          widen(*bits, found.held_value, others->mask);
    mapping.buttons.push_back(button);
  }
  return mapping;
}

// Short items of a report descriptor (HID 1.11, 6.2.2.2): a byte of tag, type and size, then its data.
bool numbers_reports(std::span<const std::uint8_t> report_descriptor) noexcept {
  constexpr std::uint8_t kLongItem = 0xfe, kReportId = 0x84;
  std::size_t at = 0;
  while (at < report_descriptor.size()) {
    const std::uint8_t head = report_descriptor[at];
    if (head == kLongItem) {
      if (at + 1 >= report_descriptor.size()) return false;
      at += 3U + report_descriptor[at + 1];
      continue;
    }
    if ((head & 0xfcU) == kReportId) return true;
    const unsigned size = head & 3U;
    at += 1U + (size == 3 ? 4U : size);
  }
  return false;
}

}  // namespace jnd
