// A real device on the bench: driven tick by tick by the thread that calls, through the governor, and watched report by
// report. For tests and calibrations; a study's link has threads of its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "devices/clock.h"
#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/hid_bus.h"
#include "devices/hid/report_counter.h"
#include "devices/loop/governor.h"
#include "protocols/rigs/device_description.h"

namespace jnd {

inline constexpr double kMicro = 1e-6, kMilli = 1e-3;

// What the pages of a 3RRS device say, as the governor and the checks read it. most_force_n: a lower cap for the bench.
DeviceSpec spec_of(const jnd_limits& limits, const jnd_geometry& geometry, double most_force_n);

// It was interrupted. The device is at rest.
class BenchInterrupted : public std::runtime_error {
 public:
  BenchInterrupted() : std::runtime_error("interrupted; the device was told to rest") {}
};

struct BenchSample {
  std::int64_t arrival_ns = 0;  // on the clock of the bench, to a tick
  jnd_telemetry telemetry{};
};

// Handle, clock and latch must outlive the link. Thread rule: the handle's thread.
//
// Every tick throws DeviceError where the device is gone or takes no commands, and BenchInterrupted once `interrupted`
// is set. However it ends, the device is told to rest.
class BenchLink {
 public:
  static constexpr std::int64_t kTick_ns = 1'000'000;

  BenchLink(HidHandle& handle, Clock& clock, const DeviceSpec& spec, const std::atomic<bool>& interrupted);
  ~BenchLink();
  BenchLink(const BenchLink&) = delete;
  BenchLink& operator=(const BenchLink&) = delete;

  // Called with each telemetry as it comes; empty: not watched.
  void watch(std::function<void(const BenchSample&)> look) { look_ = std::move(look); }

  // One tick of 1 ms: wait for it, read all that came, govern, send. While a fault holds the governor nothing is sent,
  // and the device's own watchdog stops it.
  const GovernorOutput& tick(const DeviceCommand& asked);
  // A tick in which nothing is sent.
  void silence();
  // A tick in which this is sent, past the governor: a damaged report, or one of mode rest.
  void send_raw(std::span<const std::uint8_t> report);

  // A command of mode rest, and ticks of silence until the device says that it rests, at most `patience_ms`. False
  // where it does not. The governor is inactive then.
  bool rest(int patience_ms = 1000);
  // Rest, then the governor active, its soft start over, without force. False where the device does not rest, has a
  // fault, or stops itself.
  bool make_ready();

  // A push of the finger along the device's own direction, as of a contact of 1000 N/m.
  static DeviceCommand push(double force_n);
  // The next command's report, numbered; for send_raw.
  jnd_command next_command(const DeviceCommand& asked);
  jnd_command rest_command();

  const jnd_telemetry& telemetry() const noexcept { return newest_.telemetry; }
  bool heard() const noexcept { return counter_.taken() > 0; }
  const ReportCounter& counter() const noexcept { return counter_; }
  std::int64_t damaged() const noexcept { return damaged_; }  // reports that were none of the protocol's
  Fault fault() const noexcept { return governor_.fault(); }
  // Why make_ready() or a push failed: "did not become active: stopped, faults: watchdog", "ended by stale_reading".
  std::string trouble() const;
  const DeviceSpec& spec() const noexcept { return spec_; }
  std::int64_t now_ns() const noexcept { return clock_.now_ns(); }

 private:
  void wait();
  void hear();
  void look_for_faults() noexcept;
  void write(std::span<const std::uint8_t> report);
  void write(const jnd_command& command);

  HidHandle& handle_;
  Clock& clock_;
  DeviceSpec spec_;
  const std::atomic<bool>& interrupted_;
  std::function<void(const BenchSample&)> look_;
  Governor governor_;
  GovernorOutput out_;
  BenchSample newest_;
  ReportCounter counter_;
  std::int64_t damaged_ = 0;
  std::int64_t next_tick_ns_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace jnd
