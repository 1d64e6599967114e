#include "devices/fingertip_rig.h"

#include <utility>

namespace jnd {

namespace {
std::vector<FingertipDevice*> pointers(const std::vector<std::unique_ptr<FingertipDevice>>& devices) {
  std::vector<FingertipDevice*> result;
  for (const auto& device : devices) result.push_back(device.get());
  return result;
}
}  // namespace

FingertipRig::FingertipRig(RigInfo info, std::vector<std::unique_ptr<FingertipDevice>> devices,
                           std::unique_ptr<Tracker> tracker, Clock& clock, const DeviceSpec& spec, const Sphere& sphere)
    : info_(std::move(info)),
      devices_(std::move(devices)),
      tracker_(std::move(tracker)),
      loop_(pointers(devices_), *tracker_, clock, spec, sphere) {}

Presentation FingertipRig::present(const PresentRequest& request) {
  return loop_.run(request, stop_requested);
}

void FingertipRig::neutral() noexcept {
  for (const auto& device : devices_) device->neutral();
}

}  // namespace jnd
