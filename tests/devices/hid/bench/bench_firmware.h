// The firmware behind a handle, on a clock of its own: a finger that does not give way, a sensor that may be wrong.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <functional>
#include <vector>

#include "devices/clock.h"
#include "devices/device_error.h"
#include "devices/hid/firmware/jnd_fingertip.h"
#include "devices/hid/firmware/jnd_fingertip_state.h"
#include "devices/hid/hid_bus.h"
#include "devices/rrs3/rrs3_kinematics.h"
#include "devices/rrs3/rrs3_statics.h"

namespace jnd::testing {

using HidReport = std::array<std::uint8_t, JND_REPORT_SIZE>;

// Handle and clock are one thing: time passes in a sleep or a wait for a report.
class BenchFirmware final : public HidHandle, public Clock {
 public:
  explicit BenchFirmware(const char* serial = "FT-0001", jnd_finger finger = JND_INDEX) {
    config = jnd_fingertip_default_config(serial, finger);
    const Rrs3Kinematics kinematics({.a_m = 0.006,
                                     .b_m = 0.010,
                                     .bh_m = 0.005,
                                     .bd_m = 0.017320508,
                                     .l1_m = 0.012,
                                     .l2_m = 0.020,
                                     .rest_z_m = -0.020});
    const auto at = kinematics.configuration({.pz_m = -0.020});
    rest_ = kinematics.joint_angles(*at);
    lever_ = *kinematics.differential(*at);
    start();
  }
  BenchFirmware(const BenchFirmware&) = delete;
  BenchFirmware& operator=(const BenchFirmware&) = delete;

  void start() {
    const jnd_hardware hardware = {this, time_us, read_sensors, actuate, send, load, store};
    sound = jnd_fingertip_init(&fingertip, &config, &hardware);
  }

  // Faults of the device, for tests.
  jnd_fingertip_config config{};
  bool sound = false;
  double sensor_gain = 1, sensor_offset_n = 0, load_n = 0;
  bool contact = true;  // something to press on
  bool frozen = false;  // steps no more
  bool gone = false;    // unplugged
  bool ignores_watchdog = false;
  int lose_telemetry = 0;  // the next so many reports
  int lose_answers = 0;
  int refuse_stores = 0;                  // the next so many writes into memory fail
  double clock_rate = 1;                  // of the device's clock
  std::function<void(HidReport&)> spoil;  // each report on its way to the host
  std::vector<std::vector<std::uint8_t>> written;

  jnd_fingertip fingertip{};

  // -- HidHandle
  int read(std::span<std::uint8_t> bytes, int timeout_ms) noexcept override {
    if (gone) return kHidGone;
    for (int waited = 0; queue_.empty() && waited < timeout_ms; ++waited) sleep_until_ns(now_ns_ + 1'000'000);
    if (queue_.empty()) return kHidTimeOut;
    std::memcpy(bytes.data(), queue_.front().data(), JND_REPORT_SIZE);
    queue_.pop_front();
    return JND_REPORT_SIZE;
  }
  bool write(std::span<const std::uint8_t> bytes) noexcept override {
    if (gone) return false;
    written.emplace_back(bytes.begin(), bytes.end());
    jnd_fingertip_receive(&fingertip, bytes.data(), bytes.size());
    return true;
  }
  std::string error() const override { return "No such device"; }

  // -- Clock
  std::int64_t now_ns() const noexcept override { return now_ns_; }
  std::int64_t utc_ns() const noexcept override { return now_ns_; }
  void sleep_until_ns(std::int64_t deadline) noexcept override {
    while (now_ns_ + 1'000'000 <= deadline) {
      now_ns_ += 1'000'000;
      if (!frozen) step();
    }
    now_ns_ = std::max(now_ns_, deadline);
  }

 private:
  void step() noexcept {
    // As if a good command had just come: the watchdog of a bad firmware.
    if (ignores_watchdog) fingertip.command_us = time_us(this);
    jnd_fingertip_step(&fingertip);
  }

  static BenchFirmware& self(void* context) { return *static_cast<BenchFirmware*>(context); }
  static std::uint64_t time_us(void* context) {
    return static_cast<std::uint64_t>(static_cast<double>(self(context).now_ns_) * 1e-3 * self(context).clock_rate);
  }
  static void read_sensors(void* context, jnd_sensors* sensors) {
    const BenchFirmware& me = self(context);
    *sensors = {};
    for (int i = 0; i < 3; ++i) sensors->joint_rad[i] = static_cast<float>(me.rest_[i]);
    Eigen::Vector3d torques;
    for (int i = 0; i < 3; ++i) torques[i] = me.actuation_.torque_n_m[i];
    const double pressed = me.contact ? force_along(me.lever_, torques, Eigen::Vector3d::UnitZ()) : 0;
    sensors->force_n = static_cast<float>(me.sensor_gain * (pressed + me.load_n) + me.sensor_offset_n);
    sensors->vibration_g = me.actuation_.vibration_g;
    sensors->temperature_c = 31.5F;
    sensors->battery_percent = 88;
    sensors->ok = true;
  }
  static void actuate(void* context, const jnd_actuation* actuation) { self(context).actuation_ = *actuation; }
  static bool send(void* context, const std::uint8_t report[64]) {
    BenchFirmware& me = self(context);
    if (report[0] == JND_REPORT_TELEMETRY && me.lose_telemetry > 0 && me.lose_telemetry-- > 0) return true;
    if (report[0] == JND_REPORT_PAGE && me.lose_answers > 0 && me.lose_answers-- > 0) return true;
    HidReport copy{};
    std::memcpy(copy.data(), report, copy.size());
    if (me.spoil) me.spoil(copy);
    constexpr std::size_t kQueue = 63;  // hidraw keeps the oldest
    if (me.queue_.size() < kQueue) me.queue_.push_back(copy);
    return true;
  }
  static bool load(void* context, void* bytes, std::size_t count) {
    const auto& memory = self(context).memory_;
    if (memory.size() != count) return false;
    std::memcpy(bytes, memory.data(), count);
    return true;
  }
  static bool store(void* context, const void* bytes, std::size_t count) {
    BenchFirmware& me = self(context);
    if (me.refuse_stores > 0 && me.refuse_stores-- > 0) return false;
    const auto* first = static_cast<const std::uint8_t*>(bytes);
    me.memory_.assign(first, first + count);
    return true;
  }

  Eigen::Vector3d rest_;
  Rrs3Differential lever_;
  std::int64_t now_ns_ = 0;
  jnd_actuation actuation_{};
  std::deque<HidReport> queue_;
  std::vector<std::uint8_t> memory_;
};

}  // namespace jnd::testing
