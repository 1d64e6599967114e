// Quick rehearsals: a person's thinking takes real time, waiting and stimuli take none.
#pragma once

#include <memory>
#include <utility>

#include "devices/clock.h"
#include "devices/rig.h"

namespace jnd {

class FastClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override { return steady_.now_ns() + skipped_ns_; }
  std::int64_t utc_ns() const noexcept override { return steady_.utc_ns() + skipped_ns_; }
  void sleep_until_ns(std::int64_t deadline) noexcept override {
    const std::int64_t wait = deadline - now_ns();
    if (wait > 0) skipped_ns_ += wait;
  }

 private:
  SteadyClock steady_;
  std::int64_t skipped_ns_ = 0;
};

// A rig whose loop runs on a simulated clock of its own, inside a session on a FastClock: a busy machine cannot make it
// late, and the session's clock moves on by what the presentation took.
class FastRig final : public Rig {
 public:
  // rig: built on `device_clock`, which must outlive it, as must session_clock.
  FastRig(std::unique_ptr<Rig> rig, SimulatedClock& device_clock, Clock& session_clock) noexcept
      : rig_(std::move(rig)), device_clock_(device_clock), session_clock_(session_clock) {}
  const RigInfo& info() const noexcept override { return rig_->info(); }
  Presentation present(const PresentRequest& request) override {
    const std::int64_t began = device_clock_.now_ns();
    if (stop.latched())
      rig_->stop.latch(stop.source());
    else
      rig_->stop.clear();
    Presentation presentation = rig_->present(request);
    session_clock_.sleep_until_ns(session_clock_.now_ns() + device_clock_.now_ns() - began);
    return presentation;
  }
  void neutral() noexcept override { rig_->neutral(); }
  TelemetryRing* telemetry() noexcept override { return rig_->telemetry(); }
  TelemetryRing* live() noexcept override { return rig_->live(); }
  Trace take_trace() override { return rig_->take_trace(); }
  RigButtons* buttons() noexcept override { return rig_->buttons(); }
  RealtimeReport realtime() const override { return rig_->realtime(); }

 private:
  std::unique_ptr<Rig> rig_;
  SimulatedClock& device_clock_;
  Clock& session_clock_;
};

}  // namespace jnd
