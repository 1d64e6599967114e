#include "devices/hid/virtual/virtual_tracker.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "devices/hid/virtual/virtual_device.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {

constexpr int kPresses = 3;
constexpr std::int64_t kRest_ns = 500'000'000;

HandHabits steady_habits() {
  HandHabits habits;
  habits.press_depth_sd_m = 0;
  habits.lateral_sd_m = 0;
  return habits;
}

const TrackerOptions& checked(const TrackerOptions& options) {
  const bool printable =
      std::all_of(options.serial.begin(), options.serial.end(), [](char c) { return c > ' ' && c < 0x7F; });
  if (options.serial.empty() || options.serial.size() > JND_SERIAL_SIZE || !printable)
    throw InputError(fmt::format("--serial \"{}\": give 1 to {} printable characters without blanks", options.serial,
                                 int{JND_SERIAL_SIZE}));
  if (options.rate_hz < 1 || options.rate_hz > 1000)
    throw InputError(fmt::format("--rate {}: a tracker sends 1 to 1000 poses a second", options.rate_hz));
  return options;
}

std::int32_t whole(double value) noexcept {
  return static_cast<std::int32_t>(std::lround(value));
}

}  // namespace

RepeatedPresses::RepeatedPresses(int fingers) : hand_(steady_habits(), std::clamp(fingers, 1, 2), 0, 0) {
  if (fingers < 1 || fingers > 2)
    throw InputError("the virtual tracker follows one finger or two: give one --finger or two");
  PresentRequest whole_cycle;
  whole_cycle.explore_s = kPresses * steady_habits().press_period_s;
  hand_.begin(whole_cycle, 0);
  const double period_s = steady_habits().press_period_s;
  approach_ns_ = std::llround(1e9 * hand_.approach_s());
  // The last press ends where the finger leaves the surface: from there the approach is played backwards.
  pressed_ns_ = approach_ns_ + std::llround(1e9 * period_s * (kPresses - 1 + kPressShare));
  cycle_ns_ = pressed_ns_ + approach_ns_ + kRest_ns;
}

FingerPose RepeatedPresses::pose(int finger, std::int64_t time_ns) noexcept {
  std::int64_t at_ns = time_ns % cycle_ns_;
  if (at_ns > pressed_ns_) at_ns = std::max<std::int64_t>(approach_ns_ - (at_ns - pressed_ns_), 0);
  FingerPose pose;
  (void)hand_.read(finger, at_ns, pose);
  return pose;
}

VirtualTracker::VirtualTracker(const TrackerOptions& options, const InputReport& port)
    : options_(checked(options)),
      motion_(static_cast<int>(options.fingers.size())),
      outlet_(JND_REPORT_TRACKER, port) {}

HidDescription VirtualTracker::description() const {
  return {.name = "jnd tracker (virtual)",
          .phys = "virtual/" + options_.serial,
          .serial = options_.serial,
          .vendor = kVirtualVendor,
          .product = kVirtualProduct,
          .report_descriptor = tracker_descriptor()};
}

void VirtualTracker::step(std::int64_t timer_ns, bool frozen) {
  if (frozen) return;
  ++steps_;
  for (std::size_t place = 0; place < options_.fingers.size(); ++place) {
    jnd_pose report{};
    report.finger = static_cast<std::uint8_t>(options_.fingers[place]);
    report.sequence = ++sequence_;
    report.time_us = static_cast<std::uint64_t>((timer_ns + ahead_ns_) / 1000);
    report.seen = !lost_;
    if (report.seen) {
      const FingerPose pose = motion_.pose(static_cast<int>(place), timer_ns);
      const Eigen::Quaterniond q(pose.device_axes);
      const std::array<double, 4> turn = {q.w(), q.x(), q.y(), q.z()};
      for (int axis = 0; axis < 3; ++axis) report.position_nm[axis] = whole(1e9 * pose.position_m[axis]);
      for (std::size_t part = 0; part < turn.size(); ++part)
        report.orientation[part] = whole(double{JND_NORMAL_ONE} * turn.at(part));
    }
    std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
    jnd_encode_pose(&report, bytes.data());
    (void)outlet_.send(bytes);
  }
}

jnd_identity VirtualTracker::identity() const noexcept {
  jnd_identity identity{};
  identity.lowest_version = identity.highest_version = JND_PROTOCOL_VERSION;
  identity.model = JND_MODEL_TRACKER;
  identity.finger = static_cast<std::uint8_t>(options_.fingers.size() == 1 ? options_.fingers[0] : JND_FINGER_ANY);
  identity.degrees_of_freedom = 6;
  identity.firmware[0] = 1;
  identity.loop_rate_hz = static_cast<std::uint16_t>(options_.rate_hz);
  identity.capabilities = JND_CAN_TRACK | JND_IS_MODEL;
  std::copy(options_.serial.begin(), options_.serial.end(), std::begin(identity.serial));
  return identity;
}

void VirtualTracker::receive(std::span<const std::uint8_t> report, std::int64_t /*timer_ns*/) {
  jnd_request request{};
  if (jnd_decode_request(report.data(), report.size(), &request) != JND_DECODE_OK) return;
  ++requests_;
  jnd_answer answer{};
  answer.page = request.page;
  answer.token = request.token;
  const bool known = request.page == JND_PAGE_IDENTITY;
  answer.result = static_cast<std::uint8_t>(known ? JND_PAGE_OK : JND_PAGE_UNKNOWN);
  if (known && request.operation != JND_READ_PAGE) answer.result = JND_PAGE_REFUSED;
  if (answer.result == JND_PAGE_OK) {
    const jnd_identity page = identity();
    jnd_encode_identity(&page, answer.data);
  }
  std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
  jnd_encode_answer(&answer, bytes.data());
  (void)outlet_.send(bytes);
}

bool VirtualTracker::obey(const DeviceOrder& order) {
  if (order.kind != OrderKind::lose) return outlet_.obey(order);
  lost_ = order.on;
  return true;
}

std::string VirtualTracker::status() const {
  return fmt::format(
      "\"kind\":\"tracker\",\"serial\":{},\"seen\":{},\"steps\":{},\"sequence\":{},\"sent\":{},\"dropped\":{},"
      "\"damaged\":{},\"answered\":{},\"requests\":{}",
      json_text(options_.serial), !lost_, steps_, sequence_, outlet_.sent(), outlet_.dropped(), outlet_.damaged(),
      outlet_.answered(), requests_);
}

}  // namespace jnd
