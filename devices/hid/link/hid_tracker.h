// A tracker over USB HID: reports JND_REPORT_TRACKER of the protocol in firmware/jnd_report.h.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "devices/clock.h"
#include "devices/hid/hid_bus.h"
#include "devices/hid/hid_reader.h"
#include "devices/rigs/rig_file.h"
#include "devices/tracker.h"
#include "devices/trackers/pose_feed.h"

namespace jnd {

class HidTracker final : public Tracker, private HidListener {
 public:
  // serial: of the tracker; empty: any. path: of the bus, where it must be; empty: anywhere. It need not be there yet: until it is, it is missing(), and so is one that is
  // another by its identity page, or speaks another version of the protocol. clock: the loop's, which must be the
  // machine's monotonic one. Bus and clock must outlive the tracker.
  HidTracker(HidBus& bus, std::string serial, const std::vector<std::string>& fingers,
             const Eigen::Isometry3d& to_world, const Clock& clock, std::string path = {});

  void begin(const PresentRequest& /*request*/, std::int64_t /*start_ns*/) override {}
  bool read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept override;
  std::optional<TrackerReport> report() const override;
  std::string missing() const override;

 private:
  void connected(const HidInfo& info, HidHandle& handle) override;
  void report(std::span<const std::uint8_t> bytes, std::int64_t time_ns) noexcept override;
  void lost(const std::string& why) override;

  std::string wanted_serial_, wanted_path_;
  const Clock& clock_;
  PoseFeed feed_;

  mutable std::mutex mutex_;
  std::string serial_, firmware_;  // of the one that is or was connected
  bool is_model_ = false;
  std::string trouble_;  // why it is not connected
  bool connected_ = false;

  HidReader reader_;  // last: it calls this object until it is destroyed
};

// Makes the tracker that a protocol asks for and a rig file says where to find.
// kind: "hid", "process" or "replay"; fingers: as in $.rig.fingers. Bus and clock (the loop's, the machine's monotonic
// one) must outlive the tracker. Throws InputError where the rig file does not say where such a tracker is, or its file
// of poses cannot be played. A tracker that is not there yet is no error: it is missing().
std::unique_ptr<Tracker> make_streamed_tracker(const std::string& kind, const std::vector<std::string>& fingers,
                                               const TrackerSource& source, HidBus& bus, const Clock& clock);

}  // namespace jnd
