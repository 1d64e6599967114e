#include "devices/hid/link/hid_fingertip.h"

#include "devices/hid/report_units.h"

namespace jnd {

namespace {

// By then a device has heard of an engagement and is active, unless it takes no commands, or has a cause to stop that
// stays.
constexpr std::int64_t kLongestSilence_ns = 100'000'000;

}  // namespace

DeviceStatus HidFingertip::engage(std::int64_t now_ns) noexcept {
  was_active_ = false;
  engaged_ns_ = now_ns;
  connection_ = link_.connection();
  if (connection_ == 0) return DeviceStatus::lost;
  engagement_ = link_.engage();
  return DeviceStatus::ok;
}

DeviceStatus HidFingertip::read(std::int64_t now_ns, DeviceReading& reading) noexcept {
  if (lost()) return DeviceStatus::lost;
  const LinkTelemetry newest = link_.newest();
  if (newest.connection != connection_) return DeviceStatus::lost;
  reading = to_reading(newest.telemetry, newest.time_ns);
  const bool settled = now_ns - engaged_ns_ > kLongestSilence_ns;
  // Before that, what it says of stops is of the engagement before.
  if (newest.engagement != engagement_) return settled ? DeviceStatus::lost : DeviceStatus::ok;
  if (newest.telemetry.state == JND_STATE_ACTIVE) {
    was_active_ = true;
    return DeviceStatus::ok;
  }
  return was_active_ || settled ? DeviceStatus::stopped : DeviceStatus::ok;
}

DeviceStatus HidFingertip::write(const DeviceCommand& command, std::int64_t /*now_ns*/) noexcept {
  if (lost()) return DeviceStatus::lost;
  jnd_command report{};
  (void)to_report(command, mode_, report);
  link_.send(report);
  return DeviceStatus::ok;
}

void HidFingertip::neutral() noexcept {
  link_.send(jnd_command{});
}

}  // namespace jnd
