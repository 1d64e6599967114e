#include "devices/rigs/fingertip_rig.h"

#include <chrono>
#include <utility>

namespace jnd {

namespace {
constexpr std::chrono::milliseconds kLookEvery{50};
}

FingertipRig::FingertipRig(RigInfo info, RigParts parts, Clock& clock, const RigOptions& options)
    : info_(std::move(info)),
      parts_(std::move(parts)),
      telemetry_(options.telemetry_ticks > 0 ? std::make_unique<TelemetryRing>(options.telemetry_ticks) : nullptr),
      live_(options.live_ticks > 0 ? std::make_unique<TelemetryRing>(options.live_ticks) : nullptr),
      snapshot_(options.realtime ? std::make_unique<LatestSnapshot>() : nullptr),
      loop_(parts_.channels, *parts_.tracker, clock, parts_.scene, {telemetry_.get(), live_.get(), snapshot_.get()}),
      thread_(std::move(parts_.thread)) {
  if (!thread_ && options.realtime) thread_ = std::make_unique<RenderThread>(*options.realtime);
  for (const auto& link : parts_.links) link->stop_with(&stop);
}

FingertipRig::~FingertipRig() {
  for (const auto& link : parts_.links) link->stop_with(nullptr);
}

Presentation FingertipRig::present(const PresentRequest& request) {
  if (!thread_) return loop_.run(request, stop);
  Presentation presentation;
  PresentRequest without_questions = request;  // which are asked on this thread
  without_questions.enough = {};
  const auto job = [&] { presentation = loop_.run(without_questions, stop); };
  if (!look_ && !request.enough) {
    thread_->run(job);
    return presentation;
  }
  snapshot_->put({});  // not what the last presentation left
  bool touched = false;
  thread_->run(job, kLookEvery, [&] {
    const LoopSnapshot snapshot = snapshot_->look();
    if (snapshot.ticks > 0 && look_) look_(snapshot);
    touched = touched || snapshot.contact;
    if (touched && request.enough && request.enough()) loop_.end_interval();
  });
  return presentation;
}

void FingertipRig::neutral() noexcept {
  for (const auto& device : parts_.devices) device->neutral();
}

std::string FingertipRig::missing_with(const std::string& of_tracker) const {
  std::string all;
  const auto add = [&all](const std::string& one) {
    if (!one.empty()) all += (all.empty() ? "" : "; ") + one;
  };
  for (const auto& link : parts_.links) add(link->missing());
  add(of_tracker);
  return all;
}

RigConnections FingertipRig::connections() const {
  RigConnections all;
  for (const auto& link : parts_.links) all.devices.push_back(link->report());
  all.tracker = parts_.tracker->report();
  return all;
}

RealtimeReport FingertipRig::realtime() const {
  return thread_ ? thread_->report() : RealtimeReport{};
}

}  // namespace jnd
