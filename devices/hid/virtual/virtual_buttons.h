// A button box: an ordinary gamepad with eight buttons, which sends a report whenever one of them changes.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "devices/hid/virtual/virtual_device.h"

namespace jnd {

class VirtualButtons final : public VirtualDevice {
 public:
  VirtualButtons(std::string serial, InputReport port);

  HidDescription description() const override;
  std::int64_t period_ns() const noexcept override { return 1'000'000; }
  void step(std::int64_t timer_ns, bool frozen) override;
  void receive(std::span<const std::uint8_t> /*report*/, std::int64_t /*timer_ns*/) override {}
  bool obey(const DeviceOrder& order) override;
  void jump(std::int64_t /*by_ns*/) override {}
  void plugged(bool /*is_plugged*/) override {}
  std::string status() const override;

 private:
  std::string serial_;
  InputReport port_;
  std::uint8_t buttons_ = 0;
  std::uint8_t told_ = 0;  // in the last report
  std::int64_t sent_ = 0;
};

}  // namespace jnd
