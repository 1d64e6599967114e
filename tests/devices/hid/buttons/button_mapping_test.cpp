// The file of a button mapping: what it says is what was learnt, and every mistake in it is found at once.
#include "devices/hid/buttons/button_mapping.h"

#include <algorithm>

#include <rapidcheck.h>

#include "protocols/input/input_error.h"
#include "tests/catch.h"

namespace jnd {
namespace {

const std::string kPedal = R"({
  "format": 1, "vendor": "0x05f3", "product": "0x00ff", "usage_page": "0x000c", "usage": "0x0003",
  "name": "Foot pedal", "report_id": null, "report_bytes": 1,
  "buttons": [
    {"meaning": "same", "byte": 0, "mask": 1, "pressed": 1},
    {"meaning": "different", "byte": 0, "mask": 2, "pressed": 2}
  ],
  "debounce_ms": 10
})";

std::string changed(const std::string& from, const std::string& to) {
  std::string text = kPedal;
  const auto place = text.find(from);
  REQUIRE(place != std::string::npos);
  return text.replace(place, from.size(), to);
}

std::vector<Diagnostic> mistakes(const std::string& text) {
  try {
    parse_button_mapping(text, "box.json");
  } catch (const InputError& error) {
    return error.diagnostics();
  }
  return {};
}

std::vector<std::string> paths(const std::string& text) {
  std::vector<std::string> found;
  for (const Diagnostic& diagnostic : mistakes(text)) found.push_back(diagnostic.path);
  return found;
}

using Paths = std::vector<std::string>;

TEST_CASE("A mapping is read as it is written") {
  const ButtonMapping mapping = parse_button_mapping(kPedal, "box.json");
  CHECK(mapping.vendor == 0x05f3);
  CHECK(mapping.product == 0x00ff);
  CHECK(mapping.usage_page == 0x0c);
  CHECK(mapping.usage == 0x03);
  CHECK_FALSE(mapping.serial);
  CHECK(mapping.name == "Foot pedal");
  CHECK_FALSE(mapping.report_id);
  CHECK(mapping.report_bytes == 1);
  CHECK(mapping.debounce_ms == 10);
  CHECK(mapping.sha256.size() == 64);
  REQUIRE(mapping.buttons.size() == 2);
  CHECK(mapping.buttons[1].meaning == ButtonMeaning::different);
  CHECK(std::get<ButtonBits>(mapping.buttons[1].where).mask == 2);
}

TEST_CASE("Whatever mapping is written is read back the same") {
  REQUIRE(rc::check("round trip", [] {
    ButtonMapping mapping;
    mapping.vendor = *rc::gen::arbitrary<std::uint16_t>();
    mapping.product = *rc::gen::arbitrary<std::uint16_t>();
    mapping.usage_page = *rc::gen::arbitrary<std::uint16_t>();
    mapping.usage = *rc::gen::arbitrary<std::uint16_t>();
    mapping.name = "box \"1\"";
    if (*rc::gen::arbitrary<bool>()) mapping.serial = "A\\1";
    if (*rc::gen::arbitrary<bool>()) mapping.report_id = *rc::gen::inRange(1, 256);
    mapping.report_bytes = *rc::gen::inRange(9, 65);
    mapping.debounce_ms = *rc::gen::inRange(0, 201);
    const bool coded = *rc::gen::arbitrary<bool>();
    const int most = *rc::gen::inRange(2, 4);
    for (int i = 0; i < most; ++i) {
      MappedButton button{static_cast<ButtonMeaning>(i), ButtonCode{2, 7, static_cast<std::uint8_t>(30 + i)}};
      if (!coded) {
        const auto mask = *rc::gen::inRange<int>(1, 256);
        button.where = ButtonBits{i, static_cast<std::uint8_t>(mask),
                                  static_cast<std::uint8_t>(mask & *rc::gen::inRange<int>(0, 256))};
      }
      mapping.buttons.push_back(button);
    }
    const std::string text = to_json(mapping);
    const ButtonMapping read = parse_button_mapping(text, "box.json");
    RC_ASSERT(to_json(read) == text);
    RC_ASSERT(read.vendor == mapping.vendor);
    RC_ASSERT(read.usage == mapping.usage);
    RC_ASSERT(read.serial == mapping.serial);
    RC_ASSERT(read.report_id == mapping.report_id);
    RC_ASSERT(read.report_bytes == mapping.report_bytes);
    RC_ASSERT(read.debounce_ms == mapping.debounce_ms);
    RC_ASSERT(read.buttons.size() == mapping.buttons.size());
    for (std::size_t i = 0; i < read.buttons.size(); ++i) {
      RC_ASSERT(read.buttons[i].meaning == mapping.buttons[i].meaning);
      RC_ASSERT(described(read.buttons[i]) == described(mapping.buttons[i]));
    }
  }));
}

TEST_CASE("All mistakes of a mapping are reported at once, each with its place") {
  const std::string text = R"({
  "format": 2, "vendor": "046d", "product": "0x12345", "usage_page": "0x0001", "usage": 5,
  "report_id": 0, "report_bytes": 4, "colour": "red",
  "buttons": [
    {"meaning": "yes", "byte": 0, "mask": 1, "pressed": 1},
    {"meaning": "different", "byte": 4, "mask": 0, "pressed": 300}
  ]
})";
  CHECK(paths(text) == Paths{"$.format", "$.vendor", "$.product", "$.usage", "$.name", "$.report_id", "$.colour",
                             "$.buttons[0].meaning", "$.buttons[1].byte", "$.buttons[1].mask", "$.buttons[1].pressed"});
  for (const Diagnostic& diagnostic : mistakes(text)) CHECK(diagnostic.line > 0);
}

TEST_CASE("A mapping needs both answers, each once and told from the other") {
  CHECK(paths(changed("\"different\"", "\"same\"")) == Paths{"$.buttons[1].meaning"});
  CHECK(paths(changed("\"same\"", "\"stop\"")) == Paths{"$.buttons"});
  CHECK(paths(changed("\"mask\": 2, \"pressed\": 2", "\"mask\": 1, \"pressed\": 1")) == Paths{"$.buttons[1]"});
  // Where all of a hat's bits are looked at for one answer and one of them for the other.
  CHECK(paths(changed("\"mask\": 2, \"pressed\": 2", "\"mask\": 15, \"pressed\": 1")) == Paths{"$.buttons[1]"});
  CHECK(paths(changed("\"mask\": 2, \"pressed\": 2", "\"mask\": 2, \"pressed\": 3")) == Paths{"$.buttons[1].pressed"});
  CHECK(paths(changed("\"report_id\": null, ", "")) == Paths{"$.report_id"});
  CHECK(paths(changed("\"byte\": 0, \"mask\": 2, \"pressed\": 2", "\"any_of_bytes\": [7, 2], \"code\": 30")) ==
        Paths{"$.buttons[1].any_of_bytes[0]", "$.buttons[1].any_of_bytes[1]"});
  CHECK(paths(changed("\"byte\": 0, \"mask\": 2, \"pressed\": 2", "\"any_of_bytes\": [0], \"code\": 3")) ==
        Paths{"$.buttons[1].any_of_bytes", "$.buttons[1].code"});
  CHECK(mistakes(kPedal).empty());
}

TEST_CASE("A key code counts in any of its bytes, and a keyboard that has lost count says nothing") {
  const MappedButton key{ButtonMeaning::same, ButtonCode{2, 7, 30}};
  const std::vector<std::uint8_t> alone = {0, 0, 30, 0, 0, 0, 0, 0}, behind = {0, 0, 4, 5, 30, 0, 0, 0},
                                  modifiers = {30, 0, 4, 0, 0, 0, 0, 0}, too_many = {0, 0, 1, 1, 1, 1, 1, 1};
  CHECK(is_pressed(key, alone) == true);
  CHECK(is_pressed(key, behind) == true);
  CHECK(is_pressed(key, modifiers) == false);
  CHECK_FALSE(is_pressed(key, too_many));
}

TEST_CASE("A mapping is for one make, and where it names a serial number for one box") {
  ButtonMapping mapping = parse_button_mapping(kPedal, "box.json");
  HidInfo info;
  info.vendor = 0x05f3;
  info.product = 0x00ff;
  info.usage_page = 0x0c;
  info.usage = 0x03;
  info.serial = "7";
  CHECK(mapping.is(info));
  mapping.serial = "8";
  CHECK_FALSE(mapping.is(info));
  mapping.serial = "7";
  CHECK(mapping.is(info));
  info.usage = 0x04;
  CHECK_FALSE(mapping.is(info));
}

}  // namespace
}  // namespace jnd
