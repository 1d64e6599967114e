// What the tests of streamed trackers share: poses by hand, files that go away again, waiting, and the loop on a
// tracker that has fallen silent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "devices/loop/control_loop.h"
#include "devices/rrs3/rrs3_device.h"
#include "devices/tracker.h"
#include "devices/trackers/pose_line.h"
#include "tests/devices/device_fixtures.h"
#include "tests/wait_until.h"

namespace jnd::testing {

inline const Eigen::Isometry3d kHere = Eigen::Isometry3d::Identity();
inline constexpr int kThumb = 0, kIndex = 1;  // in kFingerNames
inline constexpr std::int64_t kMillisecond_ns = 1'000'000;
inline const std::vector<std::string> kTwoFingers = {"thumb", "index"};

inline PoseLine pose_at(int finger, std::int64_t time_ns, double x_m = 0) {
  PoseLine line;
  line.finger = finger;
  line.time_ns = time_ns;
  line.position_m = {x_m, 0, 0};
  return line;
}

// The same, with the device between the finger and the sphere at the origin.
inline PoseLine pressing_pose(int finger, std::int64_t time_ns, double x_m) {
  PoseLine line = pose_at(finger, time_ns, x_m);
  line.orientation = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), line.position_m.normalized());
  return line;
}
// As it is written.
inline std::string text_of(const PoseLine& line) {
  std::string text = fmt::format("{} {:.9f}", kFingerNames[static_cast<std::size_t>(line.finger)],
                                 1e-9 * static_cast<double>(line.time_ns));
  if (!line.seen) return text + " lost\n";
  for (const double number : {line.position_m.x(), line.position_m.y(), line.position_m.z(), line.orientation.w(),
                              line.orientation.x(), line.orientation.y(), line.orientation.z()})
    text += fmt::format(" {}", number);
  return text + "\n";
}

// A file, or a folder's name, that is removed with this.
class ScratchFile {
 public:
  ScratchFile(const std::string& name, const std::string& text)
      : folder_(std::filesystem::temp_directory_path() / fmt::format("jnd-tracker-{}-{}", getpid(), ++count())),
        path_(folder_ / name) {
    std::filesystem::create_directories(folder_);
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  static int& count() {
    static int number = 0;
    return number;
  }
  std::filesystem::path folder_, path_;
};

// Two models of the 3RRS around the sphere of 40 mm, with the tracker's poses, from start_ns on a simulated clock.
inline Presentation present_on(Tracker& tracker, std::int64_t start_ns) {
  const DeviceSpec spec = rrs3_spec();
  Rrs3Device thumb(spec, Rrs3DeviceOptions{}), index(spec, Rrs3DeviceOptions{});
  SimulatedClock clock(0);
  clock.sleep_until_ns(start_ns);
  ControlLoop loop(on_fingers({&thumb, &index}, spec), tracker, clock, sphere_scene());
  const EmergencyStop stop;
  return loop.run(request(500, kForce), stop);
}

// The time from the last tick that gave force to the end; and whether the last tick gave none.
struct ForceEnd {
  double largest_n = 0;
  std::int64_t last_force_ns = 0;  // of a tick
  std::int64_t last_tick_ns = 0;
  double last_given_n = -1;
};
inline ForceEnd force_end(const Presentation& presentation) {
  ForceEnd end;
  for (const TickRecord& tick : presentation.last_ticks) {
    end.largest_n = std::max(end.largest_n, tick.given_n);
    if (tick.given_n > 0) end.last_force_ns = std::max(end.last_force_ns, tick.time_ns);
    if (tick.time_ns >= end.last_tick_ns) {
      end.last_tick_ns = tick.time_ns;
      end.last_given_n = tick.given_n;
    }
  }
  return end;
}

}  // namespace jnd::testing
