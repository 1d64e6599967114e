#include "devices/trackers/replay_tracker.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "devices/trackers/pose_feed.h"
#include "devices/trackers/pose_line.h"
#include "protocols/input/input_error.h"
#include "protocols/input/read_file.h"

namespace jnd {

namespace {

// Enough of a broken file's mistakes to see what they have in common.
constexpr std::size_t kMostErrors = 20;
constexpr std::size_t kMostBytes = std::size_t{64} << 20U;

struct ReplayFile {
  std::vector<std::pair<int, PoseLine>> lines;  // with their numbers
  std::vector<Diagnostic> errors;
  std::int64_t gaps = 0;  // of the lines' own numbers
};

class ReplayReading {
 public:
  explicit ReplayReading(std::string name) : name_(std::move(name)) {}

  void read(std::string_view line) {
    ++number_;
    if (is_blank_or_comment(line) || file_.errors.size() >= kMostErrors) return;
    const char* why = "";
    if (!header_) {
      header_ = parse_pose_header(line, why).has_value();
      if (!header_) {
        error(why);
        header_ = true;  // said once
      }
      return;
    }
    const std::optional<PoseLine> pose = parse_pose_line(line, why);
    if (!pose) {
      error(why);
      return;
    }
    if (pose->sequence && sequence_) {
      const std::uint32_t skipped = *pose->sequence - *sequence_ - 1;
      if (skipped < 0x8000'0000U) file_.gaps += skipped;  // otherwise it went back
    }
    sequence_ = pose->sequence;
    file_.lines.emplace_back(number_, *pose);
  }
  void read_too_long() {
    ++number_;
    if (file_.errors.size() < kMostErrors) error("the line is longer than 256 bytes");
  }
  void error(const std::string& message, const std::string& suggestion = "devices/trackers/README.md has the format") {
    error_at(number_, message, suggestion);
  }
  void error_at(int line, const std::string& message, const std::string& suggestion) {
    file_.errors.push_back(
        {.file = name_, .line = line, .column = 1, .path = "", .message = message, .suggestion = suggestion});
  }
  bool has_header() const noexcept { return header_; }
  ReplayFile& file() noexcept { return file_; }

 private:
  std::string name_;
  ReplayFile file_;
  int number_ = 0;
  bool header_ = false;
  std::optional<std::uint32_t> sequence_;
};

ReplayReading read_replay(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw InputError(std::vector<Diagnostic>{{path.string(), 0, 0, "", "there is no such file of poses",
                                              "look at the tracker's \"replay\" in the rig file"}});
  const std::string bytes = read_input_file(path, kMostBytes);
  ReplayReading reading(path.string());
  PoseLineCutter cutter;
  const auto whole = [&](std::string_view line) { reading.read(line); };
  const auto too_long = [&] { reading.read_too_long(); };
  cutter.cut(bytes, whole, too_long);
  cutter.cut("\n", whole, too_long);  // of a last line without its end
  if (!reading.has_header()) reading.error("the file has no header", "begin it with: jnd-poses 1 units=m clock=source");
  return reading;
}

}  // namespace

ReplayTracker::ReplayTracker(const std::filesystem::path& file, const std::vector<std::string>& fingers,
                             const Eigen::Isometry3d& to_world)
    : samples_(fingers.size()) {
  ReplayReading reading = read_replay(file);
  const Eigen::Quaterniond turn(to_world.linear());
  for (const auto& [number, line] : reading.file().lines) {
    const auto worn = std::find(fingers.begin(), fingers.end(), kFingerNames[static_cast<std::size_t>(line.finger)]);
    if (worn == fingers.end()) continue;
    std::vector<Sample>& samples = samples_[static_cast<std::size_t>(worn - fingers.begin())];
    if (!line.seen) {
      if (!samples.empty()) samples.back().lost_after = true;
      continue;
    }
    if (!samples.empty() && line.time_ns <= samples.back().time_ns) {
      reading.error_at(number, fmt::format("the time is not after that of the {}'s pose before", *worn),
                       "each finger's lines must be in the order of their times");
      if (reading.file().errors.size() >= kMostErrors) break;
      continue;
    }
    samples.push_back({.time_ns = line.time_ns,
                       .position_m = to_world * line.position_m,
                       .orientation = (turn * line.orientation).normalized(),
                       .flexion_rad = line.flexion_rad});
  }
  for (std::size_t finger = 0; finger < fingers.size(); ++finger)
    if (samples_[finger].empty() && reading.file().errors.empty())
      reading.error(fmt::format("there is no pose of the {}", fingers[finger]),
                    "record all the fingers of the protocol's $.rig.fingers");
  if (!reading.file().errors.empty()) throw InputError(std::move(reading.file().errors));

  std::int64_t begin_ns = samples_.front().front().time_ns;
  for (const auto& samples : samples_) begin_ns = std::max(begin_ns, samples.front().time_ns);
  for (auto& samples : samples_)
    for (Sample& sample : samples) sample.time_ns -= begin_ns;
  report_.kind = "replay";
  report_.source = file.string();
  report_.connected = true;
  report_.gaps = reading.file().gaps;
  measure();
}

// What the file itself is like: nothing happens to it on the way.
void ReplayTracker::measure() {
  std::int64_t longest_ns = 0;
  for (const auto& samples : samples_) {
    report_.poses += static_cast<std::int64_t>(samples.size());
    std::int64_t waits = 0, waited_ns = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      if (samples[i - 1].lost_after) continue;
      const std::int64_t wait_ns = samples[i].time_ns - samples[i - 1].time_ns;
      longest_ns = std::max(longest_ns, wait_ns);
      if (wait_ns > kOldestPose_ns) continue;
      ++waits;
      waited_ns += wait_ns;
    }
    const double rate_hz = waits > 0 ? 1e9 * static_cast<double>(waits) / static_cast<double>(waited_ns) : 0;
    report_.rate_hz = &samples == &samples_.front() ? rate_hz : std::min(report_.rate_hz, rate_hz);
  }
  report_.longest_wait_ms = 1e-6 * static_cast<double>(longest_ns);
}

void ReplayTracker::begin(const PresentRequest& /*request*/, std::int64_t start_ns) {
  start_ns_ = start_ns;
}

bool ReplayTracker::read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept {
  if (finger < 0 || static_cast<std::size_t>(finger) >= samples_.size()) return false;
  const std::vector<Sample>& samples = samples_[static_cast<std::size_t>(finger)];
  const std::int64_t time_ns = now_ns - start_ns_;
  const auto after = std::upper_bound(samples.begin(), samples.end(), time_ns,
                                      [](std::int64_t time, const Sample& sample) { return time < sample.time_ns; });
  if (after == samples.begin()) return false;
  const Sample& last = *(after - 1);
  pose.position_m = last.position_m;
  pose.device_axes = last.orientation.toRotationMatrix();
  pose.flexion_rad = last.flexion_rad;
  pose.time_ns = start_ns_ + last.time_ns;
  if (after == samples.end() || last.lost_after || after->time_ns - last.time_ns > kOldestPose_ns) return true;
  const double share = static_cast<double>(time_ns - last.time_ns) / static_cast<double>(after->time_ns - last.time_ns);
  pose.position_m += share * (after->position_m - last.position_m);
  pose.device_axes = last.orientation.slerp(share, after->orientation).toRotationMatrix();
  pose.flexion_rad += share * (after->flexion_rad - last.flexion_rad);
  pose.time_ns = now_ns;
  return true;
}

}  // namespace jnd
