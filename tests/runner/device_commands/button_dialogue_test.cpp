// The dialogue that learns buttons, on a made-up bus.
#include "runner/device_commands/button_dialogue.h"

#include <atomic>

#include "devices/clock.h"
#include "devices/device_error.h"
#include "tests/catch.h"
#include "tests/devices/hid/buttons/made_up_box.h"

namespace jnd {
namespace {

using test::MadeUpBus;
using test::pedal_info;

LearnerSetup pedal() {
  LearnerSetup setup;
  setup.info = pedal_info();
  return setup;
}

TEST_CASE("Two pedals are learnt in a dialogue, and the mapping is of that make") {
  MadeUpBus bus;
  bus.plug(pedal_info());
  std::vector<std::string> said;
  const auto mapping = learn_buttons(
      bus, pedal(),
      [&](const std::string& words) {
        said.push_back(words);
        const std::uint8_t which = words.find("SAME") != std::string::npos ? 1 : 2;
        if (words.find("hold it") != std::string::npos) bus.send({which});
        if (words == "Let go.") bus.send({0});
      },
      [] { return false; });
  REQUIRE(mapping);
  CHECK(mapping->is(pedal_info()));
  CHECK(mapping->name == "Foot pedal");
  REQUIRE(mapping->buttons.size() == 2);
  CHECK(described(mapping->buttons[0]) == "byte 0, bit 0");
  CHECK(described(mapping->buttons[1]) == "byte 0, bit 1");
  const std::vector<std::string> expected = {"Take your hands and feet off the box for a moment.",
                                             "Press SAME and hold it.",
                                             "Let go.",
                                             "Once more: press SAME and hold it.",
                                             "Let go.",
                                             "SAME: byte 0, bit 0.",
                                             "Press DIFFERENT and hold it.",
                                             "Let go.",
                                             "Once more: press DIFFERENT and hold it.",
                                             "Let go.",
                                             "DIFFERENT: byte 0, bit 1."};
  CHECK(said == expected);
}

TEST_CASE("A dialogue that is interrupted learns nothing") {
  MadeUpBus bus;
  bus.plug(pedal_info());
  bool interrupted = false;
  const auto mapping = learn_buttons(
      bus, pedal(), [&](const std::string& words) { interrupted = interrupted || words.find("hold it") != words.npos; },
      [&] { return interrupted; });
  CHECK_FALSE(mapping);
}

TEST_CASE("A box that is unplugged, or not there, ends the dialogue with words") {
  MadeUpBus bus;
  REQUIRE_THROWS_AS(learn_buttons(
                        bus, pedal(), [](const std::string&) {}, [] { return false; }),
                    DeviceError);
  bus.plug(pedal_info());
  REQUIRE_THROWS_WITH(learn_buttons(
                          bus, pedal(), [&](const std::string&) { bus.unplug(); }, [] { return false; }),
                      Catch::Contains("05f3:00ff PI Engineering Foot pedal") &&
                          Catch::Contains("is no longer there (pulled out): plug it in and begin again"));
}

TEST_CASE("A device with several collections is listed once, as what has buttons") {
  MadeUpBus bus;
  HidInfo volume = pedal_info(), pad = pedal_info(), other = pedal_info();
  pad.usage_page = 1;
  pad.usage = 5;
  other.path = "/dev/made-up-2";
  for (const HidInfo& info : {volume, pad, other}) bus.plug(info);
  const std::vector<HidInfo> devices = devices_with_buttons(bus);
  REQUIRE(devices.size() == 2);
  CHECK(devices[0].usage == 5);
  CHECK(described(devices[0]).find(", gamepad, /dev/made-up-pedal") != std::string::npos);
  CHECK(described(devices[1]).find(", usage 0x0c/0x03, /dev/made-up-2") != std::string::npos);
}

}  // namespace
}  // namespace jnd
