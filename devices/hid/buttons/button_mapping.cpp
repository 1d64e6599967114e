#include "devices/hid/buttons/button_mapping.h"

#include <algorithm>
#include <bit>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/numerics/words.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/json_text.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

constexpr auto kWords = words<ButtonMeaning>(
    {{"same", ButtonMeaning::same}, {"different", ButtonMeaning::different}, {"stop", ButtonMeaning::stop}});
constexpr auto kShouted = words<ButtonMeaning>(
    {{"SAME", ButtonMeaning::same}, {"DIFFERENT", ButtonMeaning::different}, {"STOP", ButtonMeaning::stop}});
// A keyboard says so in every place of its array where more keys are down than it can tell (HID usage tables, 0x07).
constexpr std::uint8_t kErrorRollOver = 0x01;

}  // namespace

std::string_view to_string(ButtonMeaning meaning) noexcept {
  return word_of(kWords, meaning);
}

std::string_view shouted(ButtonMeaning meaning) noexcept {
  return word_of(kShouted, meaning);
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

// Reads and writes the JSON form of a button mapping.

namespace {

constexpr int kMostReportBytes = 4096;
constexpr int kMostDebounce_ms = 200;

struct Reading {
  std::string file;
  std::vector<Diagnostic> diagnostics{};
};

// "0x046d", as lsusb and usage tables write such numbers.
std::uint16_t hexadecimal(JsonReader& reader, std::string_view key) {
  const std::string text = reader.text(key, {.max_length = 40, .may_be_empty = true});
  unsigned value = 0;
  const bool prefixed = text.starts_with("0x");
  const char* const end = text.data() + text.size();
  if (prefixed) {
    const auto [stop, failed] = std::from_chars(text.data() + 2, end, value, 16);
    if (failed == std::errc() && stop == end && value <= 0xffff) return static_cast<std::uint16_t>(value);
  }
  const JsonNode* node = reader.node().find(key);
  if (node != nullptr && node->kind == JsonNode::Kind::string)
    reader.error(key, fmt::format("{} is no number of four hexadecimal digits", in_quotes(text)),
                 "write it as \"0x046d\"");
  return 0;
}

std::optional<int> report_id(JsonReader& reader, Reading& reading) {
  const JsonNode* node = reader.member("report_id");
  if (node == nullptr) {
    reader.error("report_id", "is missing", "give the report's number, or null where reports have none");
    return std::nullopt;
  }
  if (node->kind == JsonNode::Kind::null) return std::nullopt;
  return integer_of(*node, {.min = 1, .max = 255}, reading.diagnostics, reading.file);
}

ButtonBits read_bits(JsonReader& reader, int report_bytes) {
  ButtonBits bits;
  bits.byte = reader.integer("byte", {.min = 0, .max = report_bytes - 1});
  bits.mask = static_cast<std::uint8_t>(reader.integer("mask", {.min = 1, .max = 255}));
  bits.pressed = static_cast<std::uint8_t>(reader.integer("pressed", {.min = 0, .max = 255}));
  if (bits.mask != 0 && (bits.pressed & ~bits.mask) != 0)
    reader.error("pressed", fmt::format("{} has bits that the mask {} leaves out", bits.pressed, bits.mask),
                 fmt::format("{} of it is left", bits.pressed & bits.mask));
  return bits;
}

ButtonCode read_code(JsonReader& reader, int report_bytes, Reading& reading) {
  ButtonCode code;
  const JsonNode* range = reader.array("any_of_bytes", 2, 2);
  // 0 is no key, 1 to 3 are errors of the keyboard.
  code.code = static_cast<std::uint8_t>(reader.integer("code", {.min = 4, .max = 255}));
  if (range == nullptr) return code;
  const IntegerLimits limits{.min = 0, .max = report_bytes - 1};
  const std::optional<int> first = integer_of(range->items[0], limits, reading.diagnostics, reading.file);
  const std::optional<int> last = integer_of(range->items[1], limits, reading.diagnostics, reading.file);
  if (first && last && *first > *last) {
    reader.error(*range, "ends before it begins", fmt::format("[{}, {}]", *last, *first));
    return code;
  }
  code.first = first.value_or(0);
  code.last = last.value_or(code.first);
  return code;
}

void read_buttons(const JsonNode& list, Reading& reading, ButtonMapping& mapping) {
  for (const JsonNode& item : list.items) {
    JsonReader reader(item, reading.diagnostics, reading.file);
    MappedButton button;
    button.meaning = reader.one_of("meaning", kWords);
    if (item.find("any_of_bytes") != nullptr || item.find("code") != nullptr)
      button.where = read_code(reader, mapping.report_bytes, reading);
    else
      button.where = read_bits(reader, mapping.report_bytes);
    reader.finish();
    if (!is_sound(reading.diagnostics, item.path)) continue;
    for (const MappedButton& other : mapping.buttons) {
      if (other.meaning == button.meaning)
        reader.error("meaning", fmt::format("\"{}\" is given twice", to_string(button.meaning)), "keep one of them");
      else if (confusable(other, button) || confusable(button, other))
        reader.error(item,
                     fmt::format("{} cannot be told from {}", to_string(button.meaning), to_string(other.meaning)),
                     "learn the buttons again, with two different ones");
    }
    mapping.buttons.push_back(button);
  }
  for (const ButtonMeaning wanted : {ButtonMeaning::same, ButtonMeaning::different}) {
    const bool there = std::any_of(mapping.buttons.begin(), mapping.buttons.end(),
                                   [&](const MappedButton& button) { return button.meaning == wanted; });
    if (!there && is_sound(reading.diagnostics, list.path))
      reading.diagnostics.push_back(diagnostic_at(list, reading.file,
                                                  fmt::format("no button means \"{}\"", to_string(wanted)),
                                                  "a participant answers with both"));
  }
}

}  // namespace

ButtonMapping parse_button_mapping(std::string_view bytes, const std::string& file) {
  Reading reading{.file = file};
  const JsonNode root = parse_json(bytes, file);
  ButtonMapping mapping;
  mapping.sha256 = sha256_hex(bytes);
  JsonReader reader(root, reading.diagnostics, file);
  reader.ignore("$schema");
  reader.integer("format", {.min = 1, .max = 1});
  mapping.vendor = hexadecimal(reader, "vendor");
  mapping.product = hexadecimal(reader, "product");
  mapping.usage_page = hexadecimal(reader, "usage_page");
  mapping.usage = hexadecimal(reader, "usage");
  mapping.serial = reader.optional_text("serial", {.max_length = 200});
  mapping.name = reader.text("name", {.max_length = 200});
  mapping.report_id = report_id(reader, reading);
  mapping.report_bytes = reader.integer("report_bytes", {.min = 1, .max = kMostReportBytes});
  mapping.debounce_ms = reader.integer_or("debounce_ms", 10, {.min = 0, .max = kMostDebounce_ms, .unit = "ms"});
  const JsonNode* buttons = reader.array("buttons", 2, kButtonMeanings);
  reader.finish();
  if (mapping.report_bytes == 0) mapping.report_bytes = kMostReportBytes;  // reported above: once is enough
  if (buttons != nullptr) read_buttons(*buttons, reading, mapping);
  if (!reading.diagnostics.empty()) throw InputError(std::move(reading.diagnostics));
  return mapping;
}

ButtonMapping load_button_mapping(const std::filesystem::path& path) {
  return parse_button_mapping(read_input_file(path), path.string());
}

std::string to_json(const ButtonMapping& mapping) {
  const auto hex = [](std::uint16_t value) { return fmt::format("0x{:04x}", value); };
  nlohmann::ordered_json json = {{"format", 1},
                                 {"vendor", hex(mapping.vendor)},
                                 {"product", hex(mapping.product)},
                                 {"usage_page", hex(mapping.usage_page)},
                                 {"usage", hex(mapping.usage)}};
  if (mapping.serial) json["serial"] = *mapping.serial;
  json["name"] = mapping.name;
  json["report_id"] = nullptr;
  if (mapping.report_id) json["report_id"] = *mapping.report_id;
  json["report_bytes"] = mapping.report_bytes;
  json["buttons"] = nlohmann::ordered_json::array();
  for (const MappedButton& button : mapping.buttons) {
    nlohmann::ordered_json entry = {{"meaning", to_string(button.meaning)}};
    if (const auto* bits = std::get_if<ButtonBits>(&button.where)) {
      entry.update({{"byte", bits->byte}, {"mask", bits->mask}, {"pressed", bits->pressed}});
    } else if (const auto* code = std::get_if<ButtonCode>(&button.where)) {
      entry["any_of_bytes"] = {code->first, code->last};
      entry["code"] = code->code;
    }
    json["buttons"].push_back(std::move(entry));
  }
  json["debounce_ms"] = mapping.debounce_ms;
  return json_text(json, 2) + "\n";
}

}  // namespace jnd
