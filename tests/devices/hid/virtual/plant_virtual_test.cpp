// The virtual fingertip device without a kernel, and the words it obeys.
#include <fstream>

#include <nlohmann/json.hpp>
#include <rapidcheck.h>

#include "devices/device_error.h"
#include "devices/hid/virtual/device_loop.h"
#include "devices/hid/virtual/fault_script.h"
#include "devices/hid/virtual/virtual_fingertip.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/hid/virtual/plant_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

// The virtual fingertip device without a kernel: what it sends, what it does when told to misbehave, what it says of
// it.

namespace {

// A fingertip device, and a host that presses it with 700 N/m, 4 mm deep.
struct Bench {
  explicit Bench(const FingertipOptions& options = {}, const std::filesystem::path& log_file = {})
      : log(log_file.empty() ? EventLog() : EventLog(log_file)), device(options, cable.end(), log) {}
  void run(int milliseconds, bool frozen = false) {
    for (int i = 0; i < milliseconds; ++i) device.step(timer_ns += kMs, frozen);
  }
  void press(int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) {
      device.receive(report_of(press_command(++sequence, 700, 0.004)), timer_ns);
      run(1);
    }
  }
  void rest() { device.receive(report_of(jnd_command{}), timer_ns); }
  void ask(std::uint8_t page, std::uint32_t token) {
    jnd_request request{};
    request.page = page;
    request.token = token;
    Report bytes{};
    jnd_encode_request(&request, bytes.data());
    device.receive(bytes, timer_ns);
  }
  nlohmann::json status() const { return nlohmann::json::parse("{" + device.status() + "}"); }

  Cable cable;
  EventLog log;
  VirtualFingertip device;
  std::int64_t timer_ns = 0;
  std::uint32_t sequence = 0;
};

}  // namespace

TEST_CASE("a pressed device gives the force, and its watchdog takes it away") {
  const TemporaryFolder folder;
  Bench bench({}, folder.path / "log");
  bench.press(500);
  CHECK(bench.status()["state"] == "active");
  CHECK(bench.status()["force_n"].get<double>() == Approx(2.8).epsilon(1e-3));
  CHECK(bench.status()["push_n"].get<double>() == Approx(2.8).epsilon(1e-3));
  bench.run(18);
  CHECK(bench.status()["state"] == "active");
  bench.run(1);
  CHECK(bench.status()["state"] == "stopped");
  CHECK(bench.status()["faults"] == nlohmann::json::array({"watchdog"}));
  CHECK(bench.status()["push_n"].get<double>() == 0);
  CHECK(bench.status()["let_go_s"].get<double>() > 0);
  bench.run(40);
  CHECK(bench.status()["force_n"].get<double>() < 0.001);
  bench.rest();
  bench.run(1);
  CHECK(bench.status()["state"] == "rest");

  std::ifstream file(folder.path / "log");
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(nlohmann::json::parse(line));
  REQUIRE(lines.size() == 5);
  CHECK(lines[0]["event"] == "state");
  CHECK(lines[0]["to"] == "active");
  CHECK(lines[1]["event"] == "push");
  CHECK(lines[2]["to"] == "stopped");
  CHECK(lines[2]["faults"] == nlohmann::json::array({"watchdog"}));
  CHECK(lines[3]["event"] == "let_go");
  CHECK(lines[3]["since_command_ms"].get<double>() == 20);
  CHECK(lines[4]["to"] == "rest");
  for (std::size_t i = 1; i < lines.size(); ++i)
    CHECK(lines[i]["time_s"].get<double>() >= lines[i - 1]["time_s"].get<double>());
}

TEST_CASE("dropped reports are missing, damaged ones are no reports, and both are counted") {
  Bench bench;
  bench.run(10);
  CHECK(bench.device.obey(parse_order("drop 3")));
  bench.run(10);
  auto told = bench.cable.telemetry();
  REQUIRE(told.size() == 17);
  CHECK(told[10].sequence - told[9].sequence == 4);
  CHECK(told.back().sequence == 20);
  CHECK(bench.device.obey(parse_order("damage 2")));
  bench.run(10);
  CHECK(bench.cable.reports.size() == 27);
  CHECK(bench.cable.telemetry().size() == 25);
  CHECK(bench.status()["sent"] == 27);
  CHECK(bench.status()["dropped"] == 3);
  CHECK(bench.status()["damaged"] == 2);
  // Without a listener nothing is sent, and the numbers go on.
  bench.cable.open = false;
  bench.run(5);
  bench.cable.open = true;
  bench.run(1);
  CHECK(bench.cable.telemetry().back().sequence == 36);
  CHECK(bench.cable.telemetry().back().time_us == 36'000);
}

TEST_CASE("a device of another version says so on the one page that every host can read") {
  Bench bench;
  CHECK(bench.device.obey(parse_order("wrong-version")));
  bench.ask(JND_PAGE_IDENTITY, 5);
  bench.ask(JND_PAGE_LIMITS, 6);
  bench.run(3);
  CHECK(bench.cable.telemetry().empty());
  REQUIRE(bench.cable.answers().size() == 1);
  jnd_identity identity{};
  REQUIRE(jnd_decode_identity(bench.cable.answers()[0].data, &identity));
  CHECK(identity.lowest_version == 9);
  CHECK(identity.highest_version == 9);
  jnd_telemetry telemetry{};
  for (const auto& report : bench.cable.reports)
    if (report[0] == JND_REPORT_TELEMETRY)
      CHECK(jnd_decode_telemetry(report.data(), report.size(), &telemetry) == JND_DECODE_VERSION);
  CHECK(bench.device.obey(parse_order("wrong-version off")));
  bench.ask(JND_PAGE_LIMITS, 7);
  CHECK(bench.cable.answers().size() == 2);
}

TEST_CASE("each fault of the board stops a device that presses") {
  const struct {
    const char* words;
    const char* fault;
  } cases[] = {{"nan-sensor", "sensor"}, {"hot", "temperature"}, {"low-battery", "battery"}, {"stop-button", "button"}};
  for (const auto& each : cases) {
    INFO(each.words);
    Bench bench;
    bench.press(300);
    CHECK(bench.status()["state"] == "active");
    CHECK(bench.device.obey(parse_order(each.words)));
    bench.press(1);
    CHECK(bench.status()["state"] == "stopped");
    CHECK(bench.status()["faults"] == nlohmann::json::array({each.fault}));
    CHECK(bench.status()["push_n"].get<double>() == 0);
    CHECK(bench.device.obey(parse_order((std::string(each.words) + " off").c_str())));
    bench.run(1);
    bench.rest();
    bench.run(1);
    CHECK(bench.status()["state"] == "rest");
    CHECK(bench.status()["faults"].empty());
  }
}

TEST_CASE("a stuck sensor stays where it was while the force goes on") {
  Bench bench;
  bench.press(300);
  CHECK(bench.device.obey(parse_order("stuck-sensor")));
  bench.rest();
  bench.run(100);
  CHECK(bench.status()["force_n"].get<double>() < 0.001);
  CHECK(bench.cable.telemetry().back().force_un == Approx(2'800'000).epsilon(1e-3));
  CHECK(bench.device.obey(parse_order("stuck-sensor off")));
  bench.run(1);
  CHECK(bench.cable.telemetry().back().force_un < 1000);
}

TEST_CASE("a frozen processor leaves the torques on, and the watchdog acts when it goes on") {
  Bench bench;
  bench.press(300);
  const std::size_t before = bench.cable.reports.size();
  bench.run(200, true);
  CHECK(bench.cable.reports.size() == before);
  CHECK(bench.status()["force_n"].get<double>() == Approx(2.8).epsilon(1e-3));
  bench.run(1);
  CHECK(bench.status()["state"] == "stopped");
  CHECK(bench.status()["push_n"].get<double>() == 0);
}

TEST_CASE("a device with its own supply runs on without a cable; one that is bus-powered begins anew") {
  Bench own;
  own.press(300);
  own.device.plugged(false);
  own.cable.open = false;
  own.run(30);
  CHECK(own.status()["state"] == "stopped");
  own.cable.open = true;
  own.device.plugged(true);
  own.run(1);
  CHECK(own.cable.telemetry().back().sequence == 331);

  Bench bus({.bus_powered = true});
  bus.press(300);
  bus.device.plugged(false);
  CHECK(bus.status()["push_n"].get<double>() == 0);
  bus.run(60);
  CHECK(bus.status()["force_n"].get<double>() < 0.001);
  bus.device.plugged(true);
  bus.run(2);
  CHECK(bus.cable.telemetry().back().sequence == 2);
  CHECK(bus.cable.telemetry().back().time_us == 2000);
  CHECK(bus.cable.telemetry().back().state == JND_STATE_REST);
  bus.sequence = 0;
  bus.press(300);
  CHECK(bus.status()["force_n"].get<double>() == Approx(2.8).epsilon(1e-3));
}

TEST_CASE("a slower device steps and tells less often, and says so") {
  Bench bench({.rate_hz = 250});
  bench.press(400);
  CHECK(bench.cable.telemetry().size() == 100);
  CHECK(bench.status()["force_n"].get<double>() == Approx(2.8).epsilon(1e-3));
  bench.ask(JND_PAGE_IDENTITY, 1);
  jnd_identity identity{};
  REQUIRE(jnd_decode_identity(bench.cable.answers().at(0).data, &identity));
  CHECK(identity.loop_rate_hz == 250);
  CHECK_THROWS_AS(Bench({.rate_hz = 300}), InputError);
  CHECK_THROWS_AS(Bench({.serial = "far too long a serial"}), InputError);
  CHECK_THROWS_AS(Bench({.pulp_n_per_m = 100}), InputError);
}

TEST_CASE("the clock jumps ahead, buttons are told, and words of other devices are not obeyed") {
  Bench bench;
  bench.run(5);
  bench.device.jump(2'000'000'000);
  CHECK(bench.device.obey(parse_order("button 3")));
  bench.run(1);
  CHECK(bench.cable.telemetry().back().time_us == 2'006'000);
  CHECK(bench.cable.telemetry().back().buttons == 4);
  CHECK(bench.device.obey(parse_order("button 3 off")));
  bench.run(1);
  CHECK(bench.cable.telemetry().back().buttons == 0);
  CHECK_FALSE(bench.device.obey(parse_order("lose")));
}

TEST_CASE("what is stored in a device survives its power, and a program that keeps its memory") {
  const TemporaryFolder folder;
  const FingertipOptions options{.memory = folder.path / "memory"};
  jnd_certificate written{};
  const std::string id = "0123456789abcdef";
  std::copy(id.begin(), id.end(), std::begin(written.calibration_id));
  written.date = 20260301;
  jnd_request request{};
  request.operation = JND_WRITE_PAGE;
  request.page = JND_PAGE_CERTIFICATE;
  jnd_encode_certificate(&written, request.data);
  Report bytes{};
  jnd_encode_request(&request, bytes.data());
  {
    Bench bench(options);
    bench.device.receive(bytes, 0);
    REQUIRE(bench.cable.answers().size() == 1);
    CHECK(bench.cable.answers()[0].result == JND_PAGE_OK);
  }
  Bench bench(options);
  bench.ask(JND_PAGE_IDENTITY, 1);
  jnd_identity identity{};
  REQUIRE(jnd_decode_identity(bench.cable.answers().at(0).data, &identity));
  CHECK(std::string(identity.calibration_id, 16) == id);
  CHECK(identity.calibration_date == 20260301);
  CHECK_THROWS_AS(EventLog(folder.path / "no" / "such" / "folder"), DeviceError);
}

// The words that a virtual device obeys, their times, and its clock.

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
