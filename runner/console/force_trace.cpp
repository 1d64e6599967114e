#include "runner/console/force_trace.h"

#include <algorithm>
#include <utility>

#include "runner/words/words.h"

namespace jnd {

namespace {

constexpr std::int64_t kEvery_ns = 10'000'000;  // between two samples that are kept
constexpr auto kKept_ns = static_cast<std::int64_t>(ForceTrace::kKept_s * 1e9);

}  // namespace

ForceTrace::ForceTrace(const std::vector<std::string>& names, bool in_metres) : in_metres_(in_metres) {
  for (const std::string& name : names) devices_.push_back({.name = name, .samples = {}});
}

void ForceTrace::take(TelemetryRing& ring) {
  taken_.clear();
  ring.drain(taken_);
  ring.take_dropped();
  for (const TickRecord& tick : taken_) {
    if (tick.channel < 0 || static_cast<std::size_t>(tick.channel) >= devices_.size()) continue;
    Device& device = devices_[static_cast<std::size_t>(tick.channel)];
    const bool begins = std::exchange(device.begins, false);
    if (begins) device.deepest = device.peak_n = 0;
    device.deepest = std::max(device.deepest, tick.penetration);
    device.peak_n = std::max(device.peak_n, tick.measured_n);
    if (!begins && tick.time_ns - device.samples.back().time_ns < kEvery_ns) continue;
    device.samples.push_back({tick.time_ns, tick.penetration, tick.asked_n, tick.measured_n, begins});
    now_ns_ = std::max(now_ns_, tick.time_ns);
  }
  for (Device& device : devices_)
    while (!device.samples.empty() && device.samples.front().time_ns < now_ns_ - kKept_ns) device.samples.pop_front();
}

void ForceTrace::presentation_over() noexcept {
  for (Device& device : devices_) device.begins = true;
}

std::string peak_text(const ForceTrace::Device& device, bool in_metres) {
  constexpr double kMillimetres = 1000;
  return in_metres ? tr("peak {:.2f} N, {:.1f} mm deep", device.peak_n, device.deepest * kMillimetres)
                   : tr("peak {:.2f} N, {:.3f} rad deep", device.peak_n, device.deepest);
}

}  // namespace jnd
