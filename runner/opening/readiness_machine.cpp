// Readiness of what a participant touches: devices, their calibration, the loop, and the operator's keyboard.
#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "devices/clock.h"
#include "devices/loop/telemetry_ring.h"
#include "devices/self_test/device_bench.h"
#include "protocols/protocol.h"
#include "runner/keys/interrupt.h"
#include "runner/opening/readiness_items.h"
#include "runner/opening/rig_limits.h"

namespace jnd {

namespace {

constexpr double kJitter_s = 1;
constexpr double kRigTest_s = 0.25;
constexpr std::int64_t kDay_ns = 86'400'000'000'000;
constexpr double kSoon_days = 7;

Check item(const char* name) {
  return {.what = name, .verdict = Verdict::ok};
}

void add(std::string& list, const std::string& entry) {
  list += (list.empty() ? "" : "; ") + entry;
}

// A ring that keeps nothing for as long as this lives.
class NoTelemetry {
 public:
  explicit NoTelemetry(TelemetryRing* ring) noexcept : ring_(ring), before_(ring != nullptr && ring->enabled()) {
    if (ring_ != nullptr) ring_->enable(false);
  }
  ~NoTelemetry() {
    if (ring_ != nullptr) ring_->enable(before_);
  }
  NoTelemetry(const NoTelemetry&) = delete;
  NoTelemetry& operator=(const NoTelemetry&) = delete;

 private:
  TelemetryRing* ring_;
  bool before_;
};

// Engaged, read and written at the loop's rate, without any cue, and to rest again.
void test_rig(Rig& rig, Check& check) {
  if (rig.stop.latched()) {
    check.verdict = Verdict::bad;
    add(check.found, fmt::format("the emergency stop is set ({})", to_string(rig.stop.source())));
    add(check.what_to_do, "clear it, and begin again");
    return;
  }
  PresentRequest request;
  request.stimulus.stiffness = 1;
  request.stimulus.cues = {.force = false, .vibration = false, .kinaesthetic = false};
  request.explore_s = request.no_contact_time_out_s = kRigTest_s;
  const NoTelemetry quiet(rig.telemetry());
  const Presentation given = rig.present(request);
  rig.neutral();
  if (given.fault == Fault::none || given.fault == Fault::no_contact) {
    add(check.found, fmt::format("the rig answers for {} ticks without a fault", given.ticks));
    return;
  }
  check.verdict = Verdict::bad;
  add(check.found, fmt::format("the rig stopped after {} ticks: {}", given.ticks, to_string(given.fault)));
  add(check.what_to_do, "check its cables, power and air (jnd doctor, jnd device test), and begin again");
}

}  // namespace

Check check_devices(const RigSpec& spec, Rig& rig) {
  Check check = item("devices");
  if (spec.devices.empty()) {  // a rig that is none of ours knows itself what it is made of
    const std::string missing = rig.missing();
    check.found = missing.empty() ? rig.info().name : missing;
    check.verdict = missing.empty() ? Verdict::ok : Verdict::bad;
    return check;
  }
  const Checks checks = self_test_of(spec);
  const auto passed = std::count_if(checks.begin(), checks.end(), [](const Check& one) { return one.passed(); });
  check.found = fmt::format("{}: {} of {} checks of its description passed", spec.name, passed, checks.size());
  for (const Check& one : checks) {
    if (one.passed()) continue;
    check.verdict = Verdict::bad;
    add(check.found, fmt::format("{}, {}: {}, not {}", one.device, one.what, one.found, one.limit));
  }
  if (check.verdict == Verdict::bad)
    check.what_to_do = fmt::format("do not use this rig (jnd device test {} says more)", spec.name);
  test_rig(rig, check);
  return check;
}

Check check_description(const RigSpec& spec) {
  Check check = item(kLimitsItem);
  if (spec.devices.empty()) {
    check.found = spec.name == kSpecimenRig ? "none, since no device gives a force"
                                            : "those of force are the rig's own, and nothing here keeps them";
    return check;
  }
  check.found = limits_text(spec);
  const std::string other = not_shipped_text(spec);
  if (other.empty()) return check;
  check.verdict = Verdict::warn;
  add(check.found, other);
  check.what_to_do = "go on only if this description is the one that you mean ($.rig.device of the protocol)";
  return check;
}

Check check_calibration(const RigSpec& spec, std::int64_t utc_ns) {
  Check check = item("calibration");
  for (const DeviceSpec& device : spec.devices) {
    if (!device.calibration) {
      add(check.found, fmt::format("{}: its description states none", device.name));
      continue;
    }
    const std::chrono::year_month_day day(device.calibration->date);
    const std::string date = fmt::format("{:04}-{:02}-{:02}", static_cast<int>(day.year()),
                                         static_cast<unsigned>(day.month()), static_cast<unsigned>(day.day()));
    const std::int64_t today = utc_ns / kDay_ns;
    const auto age = static_cast<double>(today - device.calibration->date.time_since_epoch().count());
    std::string found = fmt::format("{}: {}, {:.0f} days ago", device.name, date, age);
    if (device.calibration->valid_days) found += fmt::format(", holds {:g}", *device.calibration->valid_days);
    // A day ahead is another time zone's today.
    if (age < -1) {
      check.verdict = Verdict::bad;
      found = fmt::format("{}: {}, which is to come", device.name, date);
      add(check.what_to_do, "set the clock, or correct the device's description");
    } else if (device.calibration->valid_days && age > *device.calibration->valid_days) {
      check.verdict = Verdict::bad;
      found += ", out of date";
      add(check.what_to_do, fmt::format("calibrate the {} and write the day into its description", device.name));
    } else if (device.calibration->valid_days && age > *device.calibration->valid_days - kSoon_days &&
               *device.calibration->valid_days > kSoon_days) {
      check.verdict = std::max(check.verdict, Verdict::warn);
      found += ", soon out of date";
      add(check.what_to_do, fmt::format("calibrate the {} in the next days", device.name));
    }
    add(check.found, found);
  }
  return check;
}

Check check_loop_jitter(RealtimePolicy policy) {
  Check check = judge_jitter(probe_jitter_on_thread(policy, kJitter_s, interrupt_requested()));
  check.found = check.what + ": " + check.found;
  check.what = "loop";
  return check;
}

Check check_keyboard(bool is_terminal) {
  Check check = item("keyboard");
  check.found = is_terminal ? "a terminal" : "not a terminal: keys come from a pipe or a file";
  if (is_terminal) return check;
  check.verdict = Verdict::warn;
  check.what_to_do = "begin the session in a terminal: response times through a pipe are not those of a key";
  return check;
}

}  // namespace jnd
