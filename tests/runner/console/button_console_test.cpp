// Answers by buttons at the session's console: which count, when they were given, what the operator is told.
#include "devices/device_error.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/runner/button_fixture.h"

namespace jnd {
namespace {

using namespace test;

constexpr double kLong_s = 30;

TEST_CASE("A pedal answers, by the participant, with the time from the cue to the press") {
  for (const std::uint8_t pedal : {kSame, kDifferent}) {
    ButtonBench bench;
    bench.display.question = [&] {
      bench.wait_ms(200);
      bench.pedals(pedal);
      bench.pedals(kNone);
      bench.wait_ms(300);  // of being looked at later
    };
    const std::int64_t began_ns = bench.clock_of_machine.now_ns();
    const std::optional<Answer> answer = bench.ask(kLong_s);
    const double took_s = static_cast<double>(bench.clock_of_machine.now_ns() - began_ns) * 1e-9;
    REQUIRE(answer);
    CHECK(answer->said == (pedal == kSame ? kClassSame : kClassDifferent));
    CHECK(answer->entered_by == EnteredBy::participant);
    CHECK(answer->response_time_s >= 0.2);
    CHECK(answer->response_time_s < took_s - 0.2);  // of the press, not of its being noticed
  }
}

TEST_CASE("Keys go on answering beside the pedals, entered by the operator") {
  ButtonBench bench;
  bench.display.question = [&] { bench.keys.press("d"); };
  const std::optional<Answer> answer = bench.ask(kLong_s);
  REQUIRE(answer);
  CHECK(answer->said == kClassDifferent);
  CHECK(answer->entered_by == EnteredBy::operator_);
}

TEST_CASE("A pedal that is held since before the question is no answer until it is pressed anew") {
  ButtonBench bench;
  bench.display.before_question = [&] { bench.pedals(kSame); };
  bench.display.on_told = [&](const std::string& text) {
    if (text.find("down already") == std::string::npos) return;
    bench.wait_ms(100);
    bench.pedals(kNone);
    bench.wait_ms(100);
    bench.pedals(kDifferent);
  };
  const std::optional<Answer> answer = bench.ask(kLong_s);
  REQUIRE(answer);
  CHECK(answer->said == kClassDifferent);
  CHECK(answer->response_time_s >= 0.2);
  CHECK(bench.was_told("a button was down already: let go of it"));
}

TEST_CASE("A pedal pressed and let go before the question is no answer") {
  ButtonBench bench;
  bench.display.before_question = [&] {
    bench.pedals(kSame);
    bench.wait_ms(2 * pedal_mapping().debounce_ms);  // letting go sooner is bouncing
    bench.pedals(kNone);
  };
  CHECK_FALSE(bench.ask(0.5));
  CHECK(bench.display.told.empty());
}

TEST_CASE("Both pedals at once are no answer: the operator is told, and the question goes on") {
  ButtonBench bench;
  bench.display.question = [&] { bench.pedals(kBoth); };
  bench.display.on_told = [&](const std::string&) {
    bench.pedals(kNone);
    bench.wait_ms(100);
    bench.pedals(kSame);
  };
  const std::optional<Answer> answer = bench.ask(kLong_s);
  REQUIRE(answer);
  CHECK(answer->said == kClassSame);
  CHECK(bench.display.told ==
        std::vector<std::string>{"both buttons at once: no answer. Let go of both, then press one"});
}

TEST_CASE("The stop pedal latches at once, from the box's own thread, and ends the question without an answer") {
  ButtonBench bench;
  EmergencyStop stop;
  const StopOnButton stopping(&bench.box, stop);
  bench.display.question = [&] {
    bench.pedals(kStopPedal);
    CHECK(wait_until([&] { return stop.latched(); }));  // while the console asks for nothing
    CHECK(stop.source() == StopSource::button);
    bench.pedals(static_cast<std::uint8_t>(kStopPedal | kSame));
    bench.wait_ms(100);  // until the press would be an answer
  };
  CHECK_FALSE(bench.ask(kLong_s));
  CHECK(bench.was_told("STOP by the button"));
}

TEST_CASE("A stop pedal that is down when a rig is made latches it; one that was let go of does not") {
  ButtonBench bench;
  const auto latches = [&] {
    EmergencyStop stop;
    const StopOnButton stopping(&bench.box, stop);
    return stop.source() == StopSource::button;
  };
  CHECK_FALSE(latches());
  EmergencyStop former;
  { const StopOnButton stopping(&bench.box, former); }
  bench.pedals(kStopPedal);
  CHECK(wait_until(latches));
  CHECK_FALSE(former.latched());  // no longer the box's
  bench.pedals(kNone);
  CHECK(wait_until([&] { return !latches(); }));
}

TEST_CASE("A box that is unplugged is told of, keys answer meanwhile, and it is found again by itself") {
  ButtonBench bench;
  bench.display.question = [&] {
    bench.bus.send({kSame});
    bench.bus.unplug();
  };
  bench.display.on_told = [&](const std::string& text) {
    if (text.find("has gone") != std::string::npos) bench.keys.press("d");
  };
  // The unplugged pedal's report may have been heard before: an answer it stays.
  const std::optional<Answer> answer = bench.ask(kLong_s);
  REQUIRE(answer);
  if (answer->entered_by == EnteredBy::operator_) {
    CHECK(answer->said == kClassDifferent);
  } else {
    CHECK(answer->said == kClassSame);
  }
  CHECK(wait_until([&] { return !bench.box.there(); }));
  bench.bus.plug(pedal_info());
  bench.box.wait_until_there();
  bench.wait_ms(400);
  bench.display.on_told = nullptr;
  bench.display.question = [&] { bench.pedals(kDifferent); };
  const std::optional<Answer> again = bench.ask(kLong_s);
  REQUIRE(again);
  CHECK(again->said == kClassDifferent);
  CHECK(again->entered_by == EnteredBy::participant);
  CHECK(bench.was_told("the button box has gone: the keys answer"));
  CHECK(bench.was_told("the button box is there again"));
}

TEST_CASE("A box that sends other reports than those learnt is told of, once") {
  ButtonBench bench;
  bench.display.question = [&] {
    bench.bus.send({1, 0});
    bench.bus.send({0, 0});
  };
  CHECK_FALSE(bench.ask(0.5));
  CHECK(bench.was_told("reports of 2 bytes, where its buttons were learnt in reports of 1"));
  CHECK(bench.display.told.size() == 1);
}

TEST_CASE("Where the box is not there a session is refused, with what is connected and what to do") {
  MadeUpBus bus;
  HidInfo other = pedal_info();
  other.product = 0x1234;
  other.product_name = "Other pedal";
  bus.plug(other);
  ButtonBox box(bus, pedal_mapping());
  std::string message;
  try {
    box.wait_until_there();
  } catch (const DeviceError& error) {
    message = error.what();
  }
  CHECK(message.find("the button box \"Foot pedal\" (05f3:00ff) is not there") != std::string::npos);
  CHECK(message.find("05f3:1234 PI Engineering Other pedal") != std::string::npos);
  CHECK(message.find("jnd device learn-buttons --to FILE") != std::string::npos);
  // And one that this login may not open, with the reason.
  MadeUpBus locked;
  locked.plug(pedal_info());
  locked.refuse("permission denied: add yourself to plugdev");
  ButtonBox refused(locked, pedal_mapping());
  REQUIRE_THROWS_WITH(refused.wait_until_there(), Catch::Contains("is not there: permission denied"));
}

}  // namespace
}  // namespace jnd
