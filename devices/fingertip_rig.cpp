#include "devices/fingertip_rig.h"

#include <utility>

namespace jnd {

FingertipRig::FingertipRig(RigInfo info, RigParts parts, Clock& clock, const RigOptions& options)
    : info_(std::move(info)),
      parts_(std::move(parts)),
      telemetry_(options.telemetry_ticks > 0 ? std::make_unique<TelemetryRing>(options.telemetry_ticks) : nullptr),
      loop_(parts_.channels, *parts_.tracker, clock, parts_.scene, telemetry_.get()),
      thread_(options.realtime ? std::make_unique<RenderThread>(*options.realtime) : nullptr) {}

Presentation FingertipRig::present(const PresentRequest& request) {
  if (!thread_) return loop_.run(request, stop);
  Presentation presentation;
  thread_->run([&] { presentation = loop_.run(request, stop); });
  return presentation;
}

void FingertipRig::neutral() noexcept {
  for (const auto& device : parts_.devices) device->neutral();
}

RealtimeReport FingertipRig::realtime() const {
  return thread_ ? thread_->report() : RealtimeReport{};
}

}  // namespace jnd
