// A rig of devices on fingers: owns them, and presents through the control loop, on a thread of its own where the clock
// is real.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "devices/loop/control_loop.h"
#include "devices/loop/render_thread.h"
#include "devices/mckibben/mckibben_device.h"
#include "devices/rig.h"

namespace jnd {

// What a rig owns and drives. Members are destroyed last to first: what others refer to comes first.
struct RigParts {
  std::vector<std::unique_ptr<RigLink>> links;          // to real devices
  std::vector<std::unique_ptr<FingerFlexion>> motions;  // what moves models of joints
  std::vector<std::unique_ptr<FingertipDevice>> devices;
  std::vector<LoopDevice> channels;  // what each device acts on
  std::unique_ptr<Tracker> tracker;
  LoopScene scene;
  // The loop's thread, where others must not begin before it: it locks the process's memory, which holds up for a tenth
  // of a second every thread that touches new pages meanwhile. Null: the rig makes it.
  std::unique_ptr<RenderThread> thread;
};

struct RigOptions {
  std::size_t telemetry_ticks = 0;  // room of the telemetry ring, device-ticks; 0: no telemetry
  std::size_t live_ticks = 0;       // of the ring for a technician's eyes (Rig::live); 0: there is none
  // Without a value the loop runs on the calling thread, as it does on a simulated clock.
  std::optional<RealtimePolicy> realtime;
};

class FingertipRig final : public Rig {
 public:
  // The clock must outlive the rig. Throws DeviceError where real-time scheduling is required and not to be had.
  FingertipRig(RigInfo info, RigParts parts, Clock& clock, const RigOptions& options = {});
  ~FingertipRig() override;
  FingertipRig(const FingertipRig&) = delete;
  FingertipRig& operator=(const FingertipRig&) = delete;

  const RigInfo& info() const noexcept override { return info_; }
  // While the latch is set nothing is presented: the result is an emergency stop of no length.
  Presentation present(const PresentRequest& request) override;
  void neutral() noexcept override;
  TelemetryRing* telemetry() noexcept override { return telemetry_.get(); }
  TelemetryRing* live() noexcept override { return live_.get(); }
  void watch(const std::function<void(const LoopSnapshot&)>& look) override { look_ = look; }
  std::string missing() override { return missing_with(parts_.tracker->missing()); }
  std::string missing_sealed() override { return missing_with(parts_.tracker->missing_sealed()); }
  RigConnections connections() const override;
  RealtimeReport realtime() const override;

 private:
  std::string missing_with(const std::string& of_tracker) const;

  RigInfo info_;
  RigParts parts_;
  std::unique_ptr<TelemetryRing> telemetry_, live_;
  std::unique_ptr<LatestSnapshot> snapshot_;  // where a loop on a thread of its own can be watched
  std::function<void(const LoopSnapshot&)> look_;
  ControlLoop loop_;
  std::unique_ptr<RenderThread> thread_;
};

}  // namespace jnd
