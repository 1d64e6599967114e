// The test of a real device, run on the firmware: a sound one passes every check, and each fault fails its own.
#include "devices/hid/bench/bench_checks.h"

#include <algorithm>

#include "devices/device_error.h"
#include "devices/hid/page_exchange.h"
#include "tests/catch.h"
#include "tests/devices/hid/bench/bench_firmware.h"

using namespace jnd;
using jnd::testing::BenchFirmware;
using jnd::testing::HidReport;

namespace {

const std::atomic<bool> kGoesOn{false};

HidInfo listed(const char* serial) {
  HidInfo info;
  info.serial = serial;
  return info;
}

struct Bench {
  BenchFirmware device;
  jnd_identity identity = device.config.identity;
  DeviceSpec spec = spec_of(device.config.limits, device.config.geometry, kTestForce_n);
  Checks checks;

  void run() {
    BenchLink link(device, device, spec, kGoesOn);
    check_stream(link, identity, 2, checks);
    check_round_trip(link, checks);
    check_watchdog(link, identity, checks);
    check_refusals(link, identity, checks);
    check_force(link, checks);
    check_vibration(link, checks);
    check_rest(link, checks);
  }
  // The names of what failed.
  std::string failed() const {
    std::string names;
    for (const Check& check : checks)
      if (!check.passed()) names += check.what + ";";
    return names;
  }
  const Check& named(const std::string& what) const {
    const auto found =
        std::find_if(checks.begin(), checks.end(), [&](const Check& check) { return check.what == what; });
    REQUIRE(found != checks.end());
    return *found;
  }
};

}  // namespace

TEST_CASE("a sound device passes every check, and rests afterwards") {
  Bench bench;
  check_description(listed("FT-0001"), bench.identity, bench.device.config.limits, bench.checks);
  bench.run();
  for (const Check& check : bench.checks) INFO(check.what << ": " << check.found);
  CHECK(bench.failed().empty());
  CHECK(bench.checks.size() == 22);
  for (const Check& check : bench.checks) {
    CHECK(check.verdict != Verdict::not_judged);
    CHECK_FALSE(check.found.empty());
    CHECK_FALSE(check.limit.empty());
  }
  CHECK(bench.named("force of 0.5 N").found == "0.500 N");
  CHECK(bench.named("rate of telemetry").found.find("1000.0 Hz") == 0);
  CHECK(bench.named("damaged commands refused").found == bench.named("damaged commands refused").limit);
  CHECK(bench.device.fingertip.state == JND_STATE_REST);
  // No command of the whole test asks for more than its cap.
  for (const auto& report : bench.device.written) {
    jnd_command command{};
    if (jnd_decode_command(report.data(), report.size(), &command) == JND_DECODE_OK && command.touching)
      REQUIRE(command.most_force_un <= 500'000);
  }
}

TEST_CASE("a device without a watchdog fails where it should have stopped") {
  Bench bench;
  bench.device.ignores_watchdog = true;
  bench.run();
  CHECK(bench.failed() == "no more commands;damaged commands only;one command repeated;");
  CHECK(bench.named("no more commands").found == "did not stop");
}

TEST_CASE("a late watchdog is found") {
  Bench bench;
  bench.device.config.identity.watchdog_ms = 60;  // what the page said was 20
  bench.device.start();
  bench.run();
  CHECK(bench.failed() == "no more commands;damaged commands only;one command repeated;");
  CHECK(bench.named("no more commands").found.find("stopped after 6") == 0);
}

TEST_CASE("a wrong force is found, one that meets nothing is only said") {
  Bench wrong;
  wrong.device.sensor_gain = 1.5;
  wrong.run();
  CHECK(wrong.failed() == "force of 0.5 N;largest force meanwhile;");
  Bench nothing;
  nothing.device.contact = false;
  nothing.run();
  CHECK(nothing.failed().empty());
  CHECK(nothing.named("force of 0.5 N").verdict == Verdict::not_judged);
}

TEST_CASE("lost and damaged telemetry are counted") {
  Bench bench;
  int reports = 0;
  bench.device.spoil = [&reports](HidReport& report) {
    if (report[0] == JND_REPORT_TELEMETRY && ++reports == 500) report[40] ^= 1U;
  };
  {
    BenchLink link(bench.device, bench.device, bench.spec, kGoesOn);
    REQUIRE(link.rest());
    bench.device.lose_telemetry = 3;
    check_stream(link, bench.identity, 2, bench.checks);
  }
  CHECK(bench.failed() == "reports missing, damaged;");
  // Three were lost before gaps were counted, or while they were: the damaged one is missing as well.
  CHECK(bench.named("reports missing, damaged").found.find(", 1 of ") != std::string::npos);
}

TEST_CASE("a wrong clock, and a rate that is not kept, are found") {
  Bench fast;
  fast.device.clock_rate = 1.01;
  {
    BenchLink link(fast.device, fast.device, fast.spec, kGoesOn);
    check_stream(link, fast.identity, 1, fast.checks);
  }
  CHECK(fast.failed() == "its clock;");
  Bench slow;
  slow.identity.loop_rate_hz = 2000;
  {
    BenchLink link(slow.device, slow.device, slow.spec, kGoesOn);
    check_stream(link, slow.identity, 1, slow.checks);
  }
  CHECK(slow.failed() == "rate of telemetry;");
}

TEST_CASE("a device that says nothing more, or is unplugged, ends the bench") {
  Bench bench;
  BenchLink link(bench.device, bench.device, bench.spec, kGoesOn);
  REQUIRE(link.make_ready());
  bench.device.frozen = true;
  Fault fault = Fault::none;
  for (int i = 0; i < 40 && fault == Fault::none; ++i) fault = link.tick(BenchLink::push(0.2)).fault;
  CHECK(fault == Fault::stale_reading);
  bench.device.frozen = false;
  CHECK(link.rest());
  bench.device.gone = true;
  CHECK_THROWS_AS(link.silence(), DeviceError);
}

TEST_CASE("an interruption leaves the device at rest") {
  Bench bench;
  std::atomic<bool> interrupted{false};
  {
    BenchLink link(bench.device, bench.device, bench.spec, interrupted);
    REQUIRE(link.make_ready());
    for (int i = 0; i < 300; ++i) (void)link.tick(BenchLink::push(0.4));
    CHECK(bench.device.fingertip.state == JND_STATE_ACTIVE);
    interrupted = true;
    CHECK_THROWS_AS(link.tick(BenchLink::push(0.4)), BenchInterrupted);
  }
  bench.device.sleep_until_ns(bench.device.now_ns() + 2'000'000);
  CHECK(bench.device.fingertip.state == JND_STATE_REST);
}

TEST_CASE("what the pages say is looked at") {
  Bench bench;
  bench.identity.watchdog_ms = 101;
  bench.identity.loop_rate_hz = 100;
  jnd_limits limits = bench.device.config.limits;
  limits.most_force_un = 400'000;
  check_description(listed("FT-0002"), bench.identity, limits, bench.checks);
  CHECK(bench.failed() == "serial number;watchdog;rate that it names;force that it gives at most;");
}

TEST_CASE("a tracker's poses: rate, gaps, what was seen") {
  // Two fingers, 125 poses a second each; the second is seen half of the time.
  class Tracker final : public HidHandle, public Clock {
   public:
    bool skip = false, backwards = false;
    std::int64_t now_ns() const noexcept override { return now_ns_; }
    std::int64_t utc_ns() const noexcept override { return now_ns_; }
    void sleep_until_ns(std::int64_t deadline) noexcept override { now_ns_ = std::max(now_ns_, deadline); }
    int read(std::span<std::uint8_t> bytes, int /*timeout_ms*/) noexcept override {
      if (told_ * 4'000'000 >= now_ns_) return kHidTimeOut;
      jnd_pose pose{};
      pose.finger = told_ % 2 == 0 ? JND_THUMB : JND_INDEX;
      pose.seen = told_ % 4 != 1;
      pose.sequence = static_cast<std::uint32_t>(told_ + (skip && told_ > 300 ? 7 : 0));
      pose.time_us = static_cast<std::uint64_t>(backwards && told_ == 200 ? 5 : told_ / 2 * 8000 + 8);
      if (pose.seen) pose.orientation[0] = 1 << 30;
      jnd_encode_pose(&pose, bytes.data());
      ++told_;
      return JND_REPORT_SIZE;
    }
    bool write(std::span<const std::uint8_t> /*bytes*/) noexcept override { return true; }
    std::string error() const override { return "none"; }

   private:
    std::int64_t now_ns_ = 0, told_ = 0;
  };
  const auto failed = [](Tracker& tracker) {
    Bench bench;
    check_poses(tracker, tracker, 2, kGoesOn, bench.checks);
    REQUIRE(bench.checks.size() == 4);
    CHECK(bench.checks[0].found == "125.0 a second, seen in 100.0 %");
    CHECK(bench.checks[1].found == "125.0 a second, seen in 50.0 %");
    return bench.failed();
  };
  Tracker sound;
  CHECK(failed(sound).empty());
  Tracker gaps;
  gaps.skip = true;
  CHECK(failed(gaps) == "reports missing, damaged;");
  Tracker wrong;
  wrong.backwards = true;
  CHECK(failed(wrong) == "its clock;");
}
