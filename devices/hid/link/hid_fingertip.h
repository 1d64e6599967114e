// A fingertip device over USB HID, as the control loop sees it.
#pragma once

#include <cstdint>

#include "devices/fingertip_device.h"
#include "devices/hid/link/fingertip_link.h"
#include "protocols/vocabulary.h"

namespace jnd {

// Thread rule: the control loop's thread; neutral also by the thread that owns the rig while no loop runs. Nothing
// waits.
class HidFingertip final : public FingertipDevice {
 public:
  // The link must outlive it.
  HidFingertip(FingertipLink& link, RenderingMode mode) noexcept : link_(link), mode_(mode) {}

  // lost: not connected. Reconnections do not count within an engagement: who was unplugged stays lost.
  DeviceStatus engage(std::int64_t now_ns) noexcept override;
  // The newest telemetry, whose age is the loop's to judge. lost: also where its commands do not arrive. stopped: the
  // device stopped itself since engage, or does not become active.
  DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept override;
  // A command with a number that is none is not sent: the device gets mode rest.
  DeviceStatus write(const DeviceCommand& command, std::int64_t now_ns) noexcept override;
  void neutral() noexcept override;

 private:
  bool lost() const noexcept { return connection_ == 0 || link_.connection() != connection_; }

  FingertipLink& link_;
  RenderingMode mode_;
  std::uint32_t connection_ = 0, engagement_ = 0;
  std::int64_t engaged_ns_ = 0;
  bool was_active_ = false;  // in this engagement
};

}  // namespace jnd
