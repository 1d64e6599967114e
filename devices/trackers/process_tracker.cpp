#include "devices/trackers/process_tracker.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "devices/machine/io_thread.h"

namespace jnd {

namespace {

constexpr std::int64_t kStartEvery_ns = 1'000'000'000;
// A presentation reads every millisecond; after so long without a read there is none.
constexpr std::int64_t kUnused_ns = 200'000'000;
constexpr int kLookEvery_ms = 50;  // at whether it has exited
// What one reading takes at most: a program that floods is still looked after now and then.
constexpr std::size_t kChunk = 65536;
constexpr std::size_t kMostQuoted = 120;

// For messages that reach terminals and JSON: what is no printable ASCII becomes a question mark.
std::string printable_ascii(std::string_view text) {
  std::string result(text.substr(0, kMostQuoted));
  for (char& letter : result)
    if (letter < ' ' || letter > '~') letter = '?';
  return result;
}

enum class PipeState { waits, ended };

// Reads what is there, at most kChunk, and hands it on. Throws nothing.
template <typename Hear>
PipeState drain(int file, std::array<char, kChunk>& buffer, const Hear& hear) {
  const ssize_t count = read(file, buffer.data(), buffer.size());
  if (count > 0) {
    hear(std::string_view(buffer.data(), static_cast<std::size_t>(count)));
    return PipeState::waits;
  }
  return count < 0 && (errno == EAGAIN || errno == EINTR) ? PipeState::waits : PipeState::ended;
}

}  // namespace

ProcessTracker::ProcessTracker(std::vector<std::string> command, std::filesystem::path folder,
                               const std::vector<std::string>& fingers, const Eigen::Isometry3d& to_world,
                               const Clock& clock)
    : command_(std::move(command)),
      command_text_(printable_ascii(fmt::format("{}", fmt::join(command_, " ")))),
      folder_(std::move(folder)),
      clock_(clock),
      feed_(fingers, to_world),
      last_read_ns_(clock.now_ns() - kUnused_ns),
      trouble_(fmt::format("{} has not been started yet", command_text_)),
      sealed_(trouble_),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (wake_ < 0) throw DeviceError(fmt::format("no eventfd can be made: {}", std::strerror(errno)));
  thread_ = start_io_thread([this] { serve(); }, 0);
}

ProcessTracker::~ProcessTracker() {
  (void)eventfd_write(wake_, 1);
  thread_.join();
  close(wake_);
}

void ProcessTracker::begin(const PresentRequest& /*request*/, std::int64_t start_ns) {
  last_read_ns_.store(start_ns, std::memory_order_relaxed);
}

bool ProcessTracker::read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept {
  last_read_ns_.store(now_ns, std::memory_order_relaxed);
  return feed_.read(finger, pose);
}

std::optional<TrackerReport> ProcessTracker::report() const {
  TrackerReport report;
  report.kind = "process";
  report.source = command_text_;
  feed_.add_to(report);
  const std::lock_guard lock(mutex_);
  report.connected = running_;
  report.trouble = trouble_.empty() ? refused_ : trouble_;
  return report;
}

std::string ProcessTracker::missing() const {
  std::string refused;
  {
    const std::lock_guard lock(mutex_);
    if (!trouble_.empty()) return trouble_;
    refused = refused_;
  }
  std::string missing = feed_.missing(clock_.now_ns());
  if (!missing.empty() && !refused.empty()) missing += "; " + refused;
  return missing;
}

std::string ProcessTracker::missing_sealed() const {
  {
    const std::lock_guard lock(mutex_);
    if (!trouble_.empty()) return sealed_;
  }
  return feed_.missing(clock_.now_ns());
}

void ProcessTracker::say(bool running, std::string trouble, std::string sealed) {
  const std::lock_guard lock(mutex_);
  running_ = running;
  trouble_ = std::move(trouble);
  sealed_ = std::move(sealed);
}

bool ProcessTracker::in_use() const noexcept {
  return clock_.now_ns() - last_read_ns_.load(std::memory_order_relaxed) < kUnused_ns;
}

// False once the thread is to end. A file that is over is -1.
bool ProcessTracker::wait_for_news(int output, int errors) const {
  std::array<pollfd, 3> files{{{wake_, POLLIN, 0}, {output, POLLIN, 0}, {errors, POLLIN, 0}}};
  (void)poll(files.data(), files.size(), kLookEvery_ms);
  return files[0].revents == 0;
}

void ProcessTracker::serve() noexcept {
  while (wait_for_news(-1, -1)) {
    const std::int64_t started_ns = clock_.now_ns();
    serve_once();
    while (clock_.now_ns() < started_ns + kStartEvery_ns || in_use())
      if (!wait_for_news(-1, -1)) return;
  }
}

// One run of the program, from start to end.
void ProcessTracker::serve_once() {
  lines_.clear();
  error_lines_.clear();
  header_.reset();
  last_error_.clear();
  refused_any_ = false;
  feed_.begin();
  {
    const std::lock_guard lock(mutex_);
    refused_.clear();
  }
  try {
    ChildProcess child(command_, folder_);
    say(true, "", "");
    listen(child);
    const std::string how = child.end();
    const std::string sealed = fmt::format("{} has ended ({})", command_text_, how);
    std::string trouble = sealed;
    if (!last_error_.empty()) trouble += fmt::format(", and said last: {}", last_error_);
    if (const std::lock_guard lock(mutex_); !refused_.empty()) trouble += "; " + refused_;
    say(false, trouble, sealed);
  } catch (const DeviceError& error) {
    const std::string trouble =
        fmt::format("{} {}: correct the tracker's \"command\" in the rig file", command_text_, error.what());
    say(false, trouble, trouble);
  }
}

// Until the program has ended, closed its output, or is to be ended.
void ProcessTracker::listen(ChildProcess& child) {
  std::array<char, kChunk> buffer;  // NOLINT(cppcoreguidelines-pro-type-member-init): read() fills it
  const auto hear_poses = [&](std::string_view bytes) {
    const std::int64_t arrival_ns = clock_.now_ns();
    lines_.cut(
        bytes, [&](std::string_view line) { hear_line(line, arrival_ns); },
        [&] {
          feed_.refuse();
          remember(lines_.rest(), "longer than 256 bytes");
        });
  };
  const auto hear_errors = [&](std::string_view bytes) {
    error_lines_.cut(
        bytes, [&](std::string_view line) { hear_error(line); }, [&] { hear_error(error_lines_.rest()); });
  };
  int output = child.output(), errors = child.errors();
  while (output >= 0 && !child.has_exited()) {
    if (!wait_for_news(output, errors)) return;
    if (drain(output, buffer, hear_poses) != PipeState::waits) output = -1;
    if (errors >= 0 && drain(errors, buffer, hear_errors) == PipeState::ended) errors = -1;
  }
  // What it wrote last is still in the pipes; no more than they hold, for its own children may write on.
  for (int rest = 0; rest < 2 && output >= 0; ++rest) (void)drain(output, buffer, hear_poses);
  for (int rest = 0; rest < 2 && errors >= 0; ++rest) (void)drain(errors, buffer, hear_errors);
  hear_error(error_lines_.rest());
}

void ProcessTracker::hear_line(std::string_view line, std::int64_t arrival_ns) {
  if (is_blank_or_comment(line)) return;
  const char* why = "";
  if (!header_) {
    header_ = parse_pose_header(line, why);
    if (header_) return;
    feed_.refuse();
    remember(line, why);
    return;
  }
  const std::optional<PoseLine> pose = parse_pose_line(line, why);
  if (!pose) {
    feed_.refuse();
    remember(line, why);
  } else if (!feed_.take(*pose, *header_, arrival_ns)) {
    remember(line, "its time lies more than 20 ms ahead, or is not after that of the finger's pose before");
  }
}

// Of what is refused, the first of a run is kept for people.
void ProcessTracker::remember(std::string_view line, const char* why) {
  if (std::exchange(refused_any_, true)) return;
  const std::lock_guard lock(mutex_);
  refused_ = fmt::format("of {} this line was refused: \"{}\" ({})", command_text_, printable_ascii(line), why);
}

void ProcessTracker::hear_error(std::string_view line) {
  if (line.find_first_not_of(" \t\r") != std::string_view::npos) last_error_ = printable_ascii(line);
}

}  // namespace jnd
