// The words that a virtual device obeys, their times, and its clock.
#include <rapidcheck.h>

#include "devices/hid/virtual/device_loop.h"
#include "devices/hid/virtual/fault_script.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"

using namespace jnd;

TEST_CASE("every order is understood") {
  const struct {
    const char* text;
    OrderKind kind;
    double amount;
    int button;
    bool on;
  } cases[] = {{"unplug", OrderKind::unplug, 0, 0, true},
               {"unplug 300", OrderKind::unplug, 300, 0, true},
               {"  freeze\t12.5 ", OrderKind::freeze, 12.5, 0, true},
               {"drop 7", OrderKind::drop, 7, 0, true},
               {"damage 1", OrderKind::damage, 1, 0, true},
               {"wrong-version", OrderKind::wrong_version, 0, 0, true},
               {"wrong-version off", OrderKind::wrong_version, 0, 0, false},
               {"stuck-sensor on", OrderKind::stuck_sensor, 0, 0, true},
               {"nan-sensor", OrderKind::nan_sensor, 0, 0, true},
               {"hot", OrderKind::hot, 0, 0, true},
               {"low-battery off", OrderKind::low_battery, 0, 0, false},
               {"stop-button off\r", OrderKind::stop_button, 0, 0, false},
               {"button 8 off", OrderKind::button, 0, 8, false},
               {"button 1", OrderKind::button, 0, 1, true},
               {"press 2", OrderKind::press, 80, 2, true},
               {"press 2 30", OrderKind::press, 30, 2, true},
               {"lose off", OrderKind::lose, 0, 0, false},
               {"slow-clock -50", OrderKind::slow_clock, -50, 0, true},
               {"offset 1.5", OrderKind::offset, 1.5, 0, true},
               {"status", OrderKind::status, 0, 0, true},
               {"quit", OrderKind::quit, 0, 0, true}};
  for (const auto& each : cases) {
    INFO(each.text);
    const DeviceOrder order = parse_order(each.text);
    CHECK(order.kind == each.kind);
    CHECK(order.amount == each.amount);
    CHECK(order.button == each.button);
    CHECK(order.on == each.on);
  }
}

TEST_CASE("what is no order is refused, with the form that would be one") {
  for (const char* text :
       {"",           "  ",        "unplug x",   "unplug -1",  "unplug 1 2",  "freeze",    "freeze nan",
        "freeze inf", "drop",      "drop 1.5",   "drop -1",    "drop 0x10",   "hot maybe", "hot on off",
        "button",     "button 0",  "button 9",   "button 1.5", "button 1 up", "press",     "press 1 -3",
        "slow-clock", "offset -1", "status now", "Quit",       "unplug300",   "freeze 1e9"}) {
    INFO(text);
    CHECK_THROWS_AS(parse_order(text), InputError);
  }
  CHECK_THROWS_WITH(parse_order("button 9"), Catch::Contains("button B [on|off]"));
  CHECK_THROWS_WITH(parse_order("unplugged"), Catch::Contains("wrong-version"));
}

TEST_CASE("noise is refused or understood, and nothing else happens") {
  CHECK(rc::check("any text", [](const std::string& text) {
    try {
      const DeviceOrder order = parse_order(text);
      RC_ASSERT(std::isfinite(order.amount));
      RC_ASSERT(order.button >= 0 && order.button <= 8);
    } catch (const InputError&) {
    }
    try {
      FaultScript script;
      script.add_lines(text);
    } catch (const InputError&) {
    }
  }));
}

TEST_CASE("timed orders come at their time, in the order of their times") {
  const TimedOrder timed = parse_timed_order(" 2.5 unplug 300");
  CHECK(timed.at_ns == 2'500'000'000);
  CHECK(timed.order.kind == OrderKind::unplug);
  CHECK(timed.order.amount == 300);
  for (const char* text : {"unplug 300", "-1 unplug", "x unplug", "2.5", "nan quit", "2.5unplug"}) {
    INFO(text);
    CHECK_THROWS_AS(parse_timed_order(text), InputError);
  }

  CHECK(rc::check("whatever order they were added in", [](const std::vector<std::uint16_t>& times) {
    FaultScript script;
    for (std::size_t i = 0; i < times.size(); ++i)
      script.add({.at_ns = times[i] / 16, .order = {.kind = OrderKind::drop, .amount = static_cast<double>(i)}});
    std::vector<std::size_t> expected(times.size());
    for (std::size_t i = 0; i < times.size(); ++i) expected[i] = i;
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::size_t a, std::size_t b) { return times[a] / 16 < times[b] / 16; });
    for (const std::size_t next : expected) {
      const std::int64_t at_ns = times[next] / 16;
      RC_ASSERT(script.next_ns() == at_ns);
      RC_ASSERT(!script.take(at_ns - 1));
      const auto order = script.take(at_ns);
      RC_ASSERT(order.has_value());
      RC_ASSERT(order->amount == static_cast<double>(next));
    }
    RC_ASSERT(!script.next_ns());
    RC_ASSERT(!script.take(1'000'000'000));
  }));
}

TEST_CASE("a script is read line by line, and a mistake names its line") {
  FaultScript script;
  script.add_lines("# a test\n\n1 press 2\n0.5 unplug 100  # early\n3 quit");
  CHECK(script.take(4'000'000'000)->kind == OrderKind::unplug);
  CHECK(script.take(4'000'000'000)->kind == OrderKind::press);
  CHECK(script.take(4'000'000'000)->kind == OrderKind::quit);
  CHECK_FALSE(script.take(4'000'000'000));
  CHECK_THROWS_WITH(script.add_lines("1 quit\n\n2 jump\n"), Catch::Contains("line 3") && Catch::Contains("jump"));
}

TEST_CASE("a slow clock loses its parts per million, without a step") {
  DeviceClock clock(5'000'000'000);
  CHECK(clock.timer_ns(5'000'000'000) == 0);
  CHECK(clock.timer_ns(6'000'000'000) == 1'000'000'000);
  clock.slow(100, 6'000'000'000);
  CHECK(clock.timer_ns(6'000'000'000) == 1'000'000'000);
  CHECK(clock.timer_ns(16'000'000'000) == 10'999'000'000);
  clock.slow(-100, 16'000'000'000);
  CHECK(clock.timer_ns(16'000'000'000) == 10'999'000'000);
  CHECK(clock.timer_ns(26'000'000'000) == 21'000'000'000);
  CHECK(rc::check("real and timer time are each other's inverse", [] {
    DeviceClock some(*rc::gen::inRange<std::int64_t>(0, 1'000'000'000'000));
    some.slow(*rc::gen::inRange(-1000, 1000), *rc::gen::inRange<std::int64_t>(0, 1'000'000'000'000));
    const std::int64_t real = *rc::gen::inRange<std::int64_t>(0, 10'000'000'000'000);
    RC_ASSERT(std::abs(some.real_ns(some.timer_ns(real)) - real) <= 2);
  }));
}
