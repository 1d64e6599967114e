// A tracker that plays poses from a file, the same in every interval: for rehearsals and repeatable tests.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "devices/tracker.h"

namespace jnd {

// Each interval begins at the file's start: the first moment at which every finger has a pose. Between two poses at
// most 20 ms apart it goes straight from one to the other; across longer waits, lost fingers and the file's end the
// last pose stays and grows stale, as with a live tracker.
class ReplayTracker final : public Tracker {
 public:
  // Throws InputError where the file cannot be read, is not in the format of pose_line.h, or has no pose of a finger:
  // with its lines.
  ReplayTracker(const std::filesystem::path& file, const std::vector<std::string>& fingers,
                const Eigen::Isometry3d& to_world);

  void begin(const PresentRequest& request, std::int64_t start_ns) override;
  bool read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept override;
  // Of the file as a whole: nothing in it was late.
  std::optional<TrackerReport> report() const override { return report_; }

 private:
  struct Sample {              // in the world
    std::int64_t time_ns = 0;  // from the file's start
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    double flexion_rad = 0;
    bool lost_after = false;  // the finger is lost before the next sample
  };
  void measure();

  std::vector<std::vector<Sample>> samples_;  // by finger, by time; never empty
  std::int64_t start_ns_ = 0;
  TrackerReport report_;
};

}  // namespace jnd
