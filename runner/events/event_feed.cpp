#include "runner/events/event_feed.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "data/files/descriptor.h"
#include "devices/clock.h"
#include "devices/machine/io_thread.h"
#include "devices/machine/peer_user.h"
#include "protocols/input/input_error.h"
#include "protocols/version.h"

namespace jnd {

namespace {

constexpr int kVersionOfLines = 1;
constexpr std::string_view kLast = "bye";
constexpr int kLookEvery_ms = 50;  // at whether it is to end
constexpr std::int64_t kLongestEnd_ns = 500'000'000;

InputError no_events(const std::string& where, const std::string& why) {
  return InputError(fmt::format("--events {}: {}", where, why));
}

// A file that holds something is added to, and the study's own files are left alone.
void check_file(const std::string& where, int number, const struct stat& what, const std::filesystem::path& study) {
  for (const char* const suffix : {"", "-wal", "-shm", "-journal", ".lock"})
    if (is_at(study.string() + suffix, number, Links::followed))
      throw no_events(where, "is a file of the study itself; give another one");
  if ((fcntl(number, F_GETFL) & O_APPEND) == 0 && lseek(number, 0, SEEK_CUR) < what.st_size)
    throw no_events(where, "is a file whose content would be written over; to add to it: --events 3 3>>FILE");
}

// Another way into the same pipe or terminal, which does not wait; whoever shares the descriptor is not changed. A socket
// is told so with every line, and a file does not wait.
OwnedFile opened_descriptor(const std::string& where, int number, const std::filesystem::path& study) {
  struct stat what {};
  if (fstat(number, &what) != 0)
    throw no_events(where, "no file descriptor of that number is open (in a shell: --events 3 3>FILE)");
  if (number <= STDERR_FILENO) throw no_events(where, "is for the console; give a file descriptor from 3 on");
  if ((fcntl(number, F_GETFL) & O_ACCMODE) == O_RDONLY) throw no_events(where, "cannot be written to");
  if (S_ISREG(what.st_mode)) check_file(where, number, what, study);
  const bool reopens = S_ISFIFO(what.st_mode) || S_ISCHR(what.st_mode);
  OwnedFile file(
      reopens ? open(fmt::format("/proc/self/fd/{}", number).c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY)
              : fcntl(number, F_DUPFD_CLOEXEC, 0));
  if (file.get() < 0) throw no_events(where, std::strerror(errno));
  return file;
}

OwnedFile connected_socket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path)
    throw no_events(path, fmt::format("give a path of 1 to {} bytes", sizeof address.sun_path - 1));
  std::memcpy(address.sun_path, path.data(), path.size());
  OwnedFile socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw no_events(path, fmt::format("{}; start the program that listens there first, or give the number of an open "
                                      "file descriptor",
                                      std::strerror(errno)));
  if (!is_same_user(socket.get()))
    throw no_events(path, "another user's program listens there; start it as the same user");
  return socket;
}

bool is_number(const std::string& where, int& number) {
  const auto [end, error] = std::from_chars(where.data(), where.data() + where.size(), number);
  return error == std::errc() && end == where.data() + where.size();
}

// As the operator is told, and less: a force sensor tells that there was force, a limit how stiff an object is.
std::string_view told_reason(std::string_view reason) {
  if (reason == "saturated" || reason == "off_prescription") return "rule";
  if (reason == "sensor_stuck") return "device_fault";
  return reason;
}

std::int64_t monotonic_now_ns() noexcept {
  return SteadyClock().now_ns();
}

nlohmann::ordered_json members_of(const TrialOutline& outline) {
  return {{"trial", outline.plan_number}, {"practice", outline.practice}};
}

}  // namespace

EventFeed::EventFeed(const std::string& where, const std::filesystem::path& study) {
  int number = -1;
  file_ = is_number(where, number) ? opened_descriptor(where, number, study) : connected_socket(where);
  struct stat what {};
  is_socket_ = fstat(file_.get(), &what) == 0 && S_ISSOCK(what.st_mode);
  thread_ = start_io_thread([this] { serve(); }, 0);
  tell("hello",
       {{"version", kVersionOfLines}, {"program", std::string("jnd ") + kVersion}, {"clock", "CLOCK_MONOTONIC"}});
}

EventFeed::~EventFeed() {
  finish();
}

void EventFeed::finish() {
  if (!thread_.joinable()) return;
  tell(kLast, {{"dropped", dropped()}});
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    give_up_ns_ = monotonic_now_ns() + kLongestEnd_ns;
  }
  changed_.notify_one();
  thread_.join();
  file_.close();  // the reader sees the end
  const std::lock_guard lock(mutex_);
  dropped_ += static_cast<std::int64_t>(queue_.size());
  queue_.clear();
}

std::int64_t EventFeed::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

void EventFeed::tell(std::string_view event, const nlohmann::ordered_json& members) {
  const std::int64_t now_ns = monotonic_now_ns();
  const std::lock_guard lock(mutex_);
  if (ends_) return;
  const std::int64_t number = ++told_;
  const bool full = queue_.size() >= kMostEventsQueued && event != kLast;  // for which there is always room
  if (gone_ || full) {
    ++dropped_;
    return;
  }
  // The time is written by hand: nine decimals of seconds are more than a double of JSON's writer shows.
  std::string line = fmt::format("{{\"time_s\":{}.{:09},\"n\":{},\"event\":\"{}\"", now_ns / 1'000'000'000,
                                 now_ns % 1'000'000'000, number, event);
  for (const auto& [key, value] : members.items()) line += fmt::format(",\"{}\":{}", key, value.dump());
  queue_.push_back(line + "}\n");
  changed_.notify_one();
}

void EventFeed::trial(const TrialOutline& outline) {
  interval_ = 0;
  nlohmann::ordered_json members = members_of(outline);
  members["attempt"] = outline.attempt;
  tell("trial.began", members);
}

bool EventFeed::cue(CuePlace place, const CueSignal& /*cue*/) {
  if (place == CuePlace::question) {
    tell("question");
    return false;
  }
  interval_ = static_cast<int>(place) + 1;
  tell("interval.began", {{"interval", interval_}});
  return false;
}

void EventFeed::interval_over() {
  tell("interval.ended", {{"interval", interval_}});
}

void EventFeed::answered(const TrialOutline& outline, const Answer& answer) {
  nlohmann::ordered_json members = members_of(outline);
  members["response_s"] = answer.response_time_s;
  tell("answered", members);
}

void EventFeed::voided(const TrialOutline& outline, const std::string& reason) {
  nlohmann::ordered_json members = members_of(outline);
  members["reason"] = told_reason(reason);
  tell("trial.voided", members);
}

void EventFeed::happened(std::string_view moment) {
  tell(moment);
}

// The writer's part. A line that was begun is finished, so that a reader never sees half of one before the next.
void EventFeed::serve() noexcept {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ends_ || !queue_.empty(); });
    if (queue_.empty() || gone_) return;
    const std::string line = queue_.front();
    lock.unlock();
    const bool taken = hand_over(line);
    lock.lock();
    if (taken) {
      queue_.pop_front();
      continue;
    }
    gone_ = true;
    dropped_ += static_cast<std::int64_t>(queue_.size());
    queue_.clear();
  }
}

// Waits until the reader has it, is gone, or it is time to give up.
bool EventFeed::hand_over(std::string_view line) noexcept {
  while (!line.empty()) {
    const ssize_t count = is_socket_ ? ::send(file_.get(), line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL)
                                     : ::write(file_.get(), line.data(), line.size());
    if (count >= 0) {
      line.remove_prefix(static_cast<std::size_t>(count));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN) return false;
    pollfd ready{.fd = file_.get(), .events = POLLOUT, .revents = 0};
    (void)::poll(&ready, 1, kLookEvery_ms);
    const std::lock_guard lock(mutex_);
    if (ends_ && monotonic_now_ns() >= give_up_ns_) return false;
  }
  return true;
}

}  // namespace jnd
