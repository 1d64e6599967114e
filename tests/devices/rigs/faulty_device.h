// A device, and a tracker, that go wrong in every way that a real one does, from a tick on or for some ticks.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "analysis/numerics/special_values.h"
#include "devices/emergency_stop.h"
#include "devices/fingertip_device.h"
#include "devices/tracker.h"

namespace jnd::testing {

enum class DeviceFault { none, drop, delay, freeze, not_a_number, stuck_sensor, disconnect, late_reading };
enum class TrackerFault { none, silent, frozen, not_a_number, jumps };

// Passes everything on to the device it wraps, except while its fault lasts; remembers what it was told.
class FaultyDevice final : public FingertipDevice {
 public:
  FaultyDevice(FingertipDevice& inner, DeviceFault fault, std::int64_t from_tick, std::int64_t ticks) noexcept
      : inner_(inner), fault_(fault), from_(from_tick), until_(from_tick + ticks) {}

  DeviceStatus engage(std::int64_t now_ns) noexcept override { return inner_.engage(now_ns); }

  DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept override {
    ++tick;
    if (fails(DeviceFault::disconnect)) return DeviceStatus::lost;
    DeviceReading fresh;
    const DeviceStatus status = inner_.read(now_ns, fresh);
    if (fails(DeviceFault::freeze)) {
      reading = last_;
      reading.time_ns = now_ns;  // it goes on claiming to be alive
      return status;
    }
    if (fails(DeviceFault::late_reading)) {
      reading = last_;
      return status;
    }
    reading = last_ = fresh;
    if (fails(DeviceFault::not_a_number)) {
      reading.force_n = tick % 2 == 0 ? std::nan("") : kInf;
    } else if (fails(DeviceFault::stuck_sensor)) {
      if (!stuck_) stuck_n_ = fresh.force_n;
      stuck_ = true;
      reading.force_n = stuck_n_;
    }
    return status;
  }

  DeviceStatus write(const DeviceCommand& command, std::int64_t now_ns) noexcept override {
    told = command;
    largest_n = std::max(largest_n, command.force_n);
    if (!(command.force_n <= 1e9)) told_nonsense = true;
    if (command.force_n != 0 || command.vibration_g != 0) last_action_ns = now_ns;
    if (fails(DeviceFault::disconnect)) return DeviceStatus::lost;
    if (fails(DeviceFault::drop) || fails(DeviceFault::freeze)) return DeviceStatus::ok;  // without a word
    if (fails(DeviceFault::delay)) {
      const DeviceStatus status = inner_.write(delayed_[place_], now_ns);
      delayed_[place_] = command;
      place_ = (place_ + 1) % delayed_.size();
      return status;
    }
    return inner_.write(command, now_ns);
  }

  void neutral() noexcept override {
    told = DeviceCommand{};
    ++neutrals;
    inner_.neutral();
  }

  std::int64_t tick = -1;
  DeviceCommand told;
  double largest_n = 0;
  bool told_nonsense = false;
  std::int64_t last_action_ns = -1;
  int neutrals = 0;

 private:
  bool fails(DeviceFault fault) const noexcept { return fault_ == fault && tick >= from_ && tick < until_; }

  FingertipDevice& inner_;
  DeviceFault fault_;
  std::int64_t from_, until_;
  DeviceReading last_;
  bool stuck_ = false;
  double stuck_n_ = 0;
  std::array<DeviceCommand, 30> delayed_{};
  std::size_t place_ = 0;
};

class FaultyTracker final : public Tracker {
 public:
  FaultyTracker(Tracker& inner, TrackerFault fault, std::int64_t from_ns, std::int64_t for_ns) noexcept
      : inner_(inner), fault_(fault), from_ns_(from_ns), for_ns_(for_ns) {}

  void begin(const PresentRequest& request, std::int64_t start_ns) override {
    start_ns_ = start_ns;
    inner_.begin(request, start_ns);
  }
  bool read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept override {
    const std::int64_t since = now_ns - start_ns_ - from_ns_;
    const bool failing = since >= 0 && since < for_ns_;
    if (failing && fault_ == TrackerFault::silent) return false;
    const std::int64_t old_time_ns = pose.time_ns;
    const bool fresh = inner_.read(finger, now_ns, pose);
    if (!failing) return fresh;
    if (fault_ == TrackerFault::frozen) pose.time_ns = old_time_ns;
    if (fault_ == TrackerFault::not_a_number) pose.position_m.y() = pose.flexion_rad = std::nan("");
    if (fault_ == TrackerFault::jumps && since / 1'000'000 % 2 == 0) {
      pose.position_m *= 0.1;
      pose.flexion_rad += 0.3;
    }
    return fresh;
  }

 private:
  Tracker& inner_;
  TrackerFault fault_;
  std::int64_t from_ns_, for_ns_, start_ns_ = 0;
};

}  // namespace jnd::testing
