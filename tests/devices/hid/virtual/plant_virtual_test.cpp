// The virtual fingertip device without a kernel: what it sends, what it does when told to misbehave, what it says of
// it.
#include <fstream>

#include <nlohmann/json.hpp>

#include "devices/device_error.h"
#include "devices/hid/virtual/virtual_fingertip.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/hid/virtual/plant_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

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
