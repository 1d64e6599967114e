// A tracker of one or two fingers around the sphere of the published experiment: they close, press three times, open,
// rest, and begin again, always in the same way.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "devices/hid/virtual/virtual_device.h"
#include "devices/participants/simulated_hand.h"

namespace jnd {

struct TrackerOptions {
  std::string serial = "VT-0001";                            // 1 to 16 printable characters
  std::vector<jnd_finger> fingers = {JND_THUMB, JND_INDEX};  // one or two; the first rests at -x
  int rate_hz = 200;                                         // poses of each finger a second, 1 to 1000
};

// The motion, closed into a circle. Tracker frame: the world's of devices/tracker.h.
class RepeatedPresses {
 public:
  // Throws InputError for other than one or two fingers.
  explicit RepeatedPresses(int fingers);
  FingerPose pose(int finger, std::int64_t time_ns) noexcept;
  std::int64_t cycle_ns() const noexcept { return cycle_ns_; }

 private:
  SimulatedHand hand_;
  std::int64_t approach_ns_ = 0, pressed_ns_ = 0, cycle_ns_ = 0;
};

class VirtualTracker final : public VirtualDevice {
 public:
  // Throws InputError for impossible options.
  VirtualTracker(const TrackerOptions& options, const InputReport& port);

  HidDescription description() const override;
  std::int64_t period_ns() const noexcept override { return 1'000'000'000 / options_.rate_hz; }
  void step(std::int64_t timer_ns, bool frozen) override;
  void receive(std::span<const std::uint8_t> report, std::int64_t timer_ns) override;
  bool obey(const DeviceOrder& order) override;
  void jump(std::int64_t by_ns) override { ahead_ns_ += by_ns; }
  void plugged(bool /*is_plugged*/) override {}
  std::string status() const override;

 private:
  jnd_identity identity() const noexcept;

  TrackerOptions options_;
  RepeatedPresses motion_;
  ReportOutlet outlet_;
  std::uint32_t sequence_ = 0;
  std::int64_t ahead_ns_ = 0, steps_ = 0, requests_ = 0;
  bool lost_ = false;
};

}  // namespace jnd
