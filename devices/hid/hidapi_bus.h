// HID devices of this machine, through hidapi on the kernel's hidraw devices.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "devices/hid/hid_bus.h"

namespace jnd {

// Several may exist: hidapi's global calls (list, open, close) take turns in the whole process. What a handle reads and
// writes does not wait for them.
class HidapiBus final : public HidBus {
 public:
  // Throws DeviceError where hidapi cannot begin.
  HidapiBus();
  std::vector<HidInfo> list() override;
  std::unique_ptr<HidHandle> open(const std::string& path) override;
};

}  // namespace jnd
