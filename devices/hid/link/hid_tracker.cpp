#include "devices/hid/link/hid_tracker.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/our_devices.h"
#include "devices/hid/page_exchange.h"
#include "devices/hid/report_words.h"
#include "devices/trackers/process_tracker.h"
#include "devices/trackers/replay_tracker.h"
#include "protocols/input/input_error.h"

namespace jnd {

std::unique_ptr<Tracker> make_streamed_tracker(const std::string& kind, const std::vector<std::string>& fingers,
                                               const TrackerSource& source, HidBus& bus, const Clock& clock) {
  if (kind == "hid")
    return std::make_unique<HidTracker>(bus, source.serial, fingers, source.to_world, clock, source.socket.string());
  if (kind == "process") {
    if (source.command.empty())
      throw InputError(
          "$.rig.tracker of the protocol is \"process\", but the rig file does not say which program: give its "
          "\"tracker\" a \"command\", such as [\"python3\", \"bridge.py\"]");
    return std::make_unique<ProcessTracker>(source.command, source.folder, fingers, source.to_world, clock);
  }
  if (kind == "replay") {
    if (source.replay.empty())
      throw InputError(
          "$.rig.tracker of the protocol is \"replay\", but the rig file does not say which file: give its \"tracker\" "
          "a \"replay\", such as \"poses.txt\"");
    return std::make_unique<ReplayTracker>(source.replay, fingers, source.to_world);
  }
  throw InputError("$.rig.tracker \"" + kind + "\" is no stream of poses: use \"hid\", \"process\" or \"replay\"");
}

namespace {

// A pose that comes late is worth less than any other work of this machine but the loop's (50).
constexpr int kPriority = 40;
constexpr double kUnitQuaternion = 1 << 30;
constexpr std::uint64_t kLongestTime_us = kLongestPoseTime_ns / 1000;

PoseLine line_of(const jnd_pose& pose) noexcept {
  PoseLine line;
  line.finger = pose.finger - JND_THUMB;
  line.time_ns = static_cast<std::int64_t>(pose.time_us * 1000);
  line.seen = pose.seen;
  line.sequence = pose.sequence;
  if (!pose.seen) return line;
  line.position_m = 1e-9 * Eigen::Vector3d(pose.position_nm[0], pose.position_nm[1], pose.position_nm[2]);
  line.orientation = Eigen::Quaterniond(pose.orientation[0] / kUnitQuaternion, pose.orientation[1] / kUnitQuaternion,
                                        pose.orientation[2] / kUnitQuaternion, pose.orientation[3] / kUnitQuaternion)
                         .normalized();
  if (pose.has_flexion) line.flexion_rad = 1e-6 * pose.flexion_urad;
  return line;
}

}  // namespace

HidTracker::HidTracker(HidBus& bus, std::string serial, const std::vector<std::string>& fingers,
                       const Eigen::Isometry3d& to_world, const Clock& clock, std::string path)
    : wanted_serial_(std::move(serial)),
      wanted_path_(std::move(path)),
      clock_(clock),
      feed_(fingers, to_world),
      reader_(
          bus,
          [this](const HidInfo& info) {
            // One without a serial number on the bus has it in its identity page only.
            return is_tracker(info) && (wanted_path_.empty() || info.path == wanted_path_) &&
                   (wanted_serial_.empty() || info.serial.empty() || info.serial == wanted_serial_);
          },
          *this, kPriority, &clock) {}

bool HidTracker::read(int finger, std::int64_t /*now_ns*/, FingerPose& pose) noexcept {
  return feed_.read(finger, pose);
}

std::optional<TrackerReport> HidTracker::report() const {
  TrackerReport report;
  report.kind = "hid";
  feed_.add_to(report);
  const std::lock_guard lock(mutex_);
  report.source = serial_.empty() ? wanted_serial_ : serial_;
  report.firmware = firmware_;
  report.is_model = is_model_;
  report.connected = connected_;
  report.trouble = trouble_;
  return report;
}

std::string HidTracker::missing() const {
  {
    const std::lock_guard lock(mutex_);
    if (!connected_) {
      const std::string which = wanted_serial_.empty() ? "" : " " + wanted_serial_;
      return fmt::format("the tracker{} is not connected{}", which, trouble_.empty() ? "" : ": " + trouble_);
    }
  }
  return feed_.missing(clock_.now_ns());
}

// Poses that come while its identity is asked are not missed: nothing rests on them yet.
void HidTracker::connected(const HidInfo& info, HidHandle& handle) {
  const jnd_identity identity = PageExchange(handle, name_of(info)).identity();
  const std::string serial = serial_of(identity);
  if (identity.model != JND_MODEL_TRACKER)
    throw DeviceError(
        fmt::format("{} says that it is a {}; look at its firmware", name_of(info), model_word(identity.model)));
  if (!wanted_serial_.empty() && serial != wanted_serial_)
    throw DeviceError(fmt::format("{} is tracker {}, not {}", info.path, serial, wanted_serial_));
  feed_.begin();
  const std::lock_guard lock(mutex_);
  serial_ = serial;
  firmware_ = firmware_text(identity);
  is_model_ = (identity.capabilities & JND_IS_MODEL) != 0;
  trouble_.clear();
  connected_ = true;
}

void HidTracker::report(std::span<const std::uint8_t> bytes, std::int64_t time_ns) noexcept {
  if (bytes.empty() || bytes[0] == JND_REPORT_PAGE) return;  // an answer to a question of another program
  jnd_pose pose{};
  if (jnd_decode_pose(bytes.data(), bytes.size(), &pose) == JND_DECODE_OK && pose.time_us <= kLongestTime_us)
    (void)feed_.take(line_of(pose), PoseClock::source, time_ns);
  else
    feed_.refuse();
}

void HidTracker::lost(const std::string& why) {
  const std::lock_guard lock(mutex_);
  trouble_ = why;
  connected_ = false;
}

}  // namespace jnd
