// A tracker that is any program: it writes poses to its standard output, in the lines of pose_line.h.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <Eigen/Geometry>

#include "devices/clock.h"
#include "devices/machine/child_process.h"
#include "devices/tracker.h"
#include "devices/trackers/pose_feed.h"
#include "devices/trackers/pose_line.h"

namespace jnd {

// The program runs until the tracker is destroyed. When it ends, missing() says how, and what it said last on its
// standard error; it is started again by itself, at most once a second, and never while a presentation reads poses.
class ProcessTracker final : public Tracker {
 public:
  // Starts the program at once, in `folder` (empty: this one's). A program that cannot be started is missing(). clock:
  // the loop's, which must be the machine's monotonic one and outlive the tracker.
  ProcessTracker(std::vector<std::string> command, std::filesystem::path folder,
                 const std::vector<std::string>& fingers, const Eigen::Isometry3d& to_world, const Clock& clock);
  ~ProcessTracker() override;
  ProcessTracker(const ProcessTracker&) = delete;
  ProcessTracker& operator=(const ProcessTracker&) = delete;

  void begin(const PresentRequest& request, std::int64_t start_ns) override;
  bool read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept override;
  std::optional<TrackerReport> report() const override;
  std::string missing() const override;
  std::string missing_sealed() const override;

 private:
  void serve() noexcept;
  void serve_once();
  void listen(ChildProcess& child);
  bool wait_for_news(int output, int errors) const;
  void hear_line(std::string_view line, std::int64_t arrival_ns);
  void remember(std::string_view line, const char* why);
  void hear_error(std::string_view line);
  bool in_use() const noexcept;
  void say(bool running, std::string trouble, std::string sealed);

  const std::vector<std::string> command_;
  const std::string command_text_;
  const std::filesystem::path folder_;
  const Clock& clock_;
  PoseFeed feed_;
  std::atomic<std::int64_t> last_read_ns_;  // by the loop

  // The thread's own.
  PoseLineCutter lines_, error_lines_;
  std::optional<PoseClock> header_;
  std::string last_error_;  // line of its standard error
  bool refused_any_ = false;

  mutable std::mutex mutex_;  // never the loop's
  std::string trouble_;       // why there are no poses; empty while it runs and writes as it should
  std::string sealed_;        // trouble_ without words of the program
  std::string refused_;       // the first line of this run that was none, and why
  bool running_ = false;

  int wake_;  // an eventfd: readable once the thread is to end
  std::thread thread_;
};

}  // namespace jnd
