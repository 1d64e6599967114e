#include "devices/realtime.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <mutex>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "analysis/numerics/words.h"
#include "devices/device_error.h"

namespace jnd {

namespace {

constexpr auto kPolicies = words<RealtimePolicy>(
    {{"off", RealtimePolicy::off}, {"prefer", RealtimePolicy::prefer}, {"require", RealtimePolicy::require}});

std::string words(int error) {
  return std::system_category().message(error);
}

std::string limit_text(rlim_t limit, rlim_t unit) {
  return limit == RLIM_INFINITY ? "unlimited" : std::to_string(limit / unit);
}

std::string login() {
  std::array<char, 4096> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  if (getpwuid_r(getuid(), &entry, buffer.data(), buffer.size(), &found) == 0 && found != nullptr) return entry.pw_name;
  return "YOUR_LOGIN";
}

std::string limits_advice(std::string_view item, std::string_view value) {
  return fmt::format("put the line \"{} - {} {}\" into /etc/security/limits.d/99-jnd.conf and log in again", login(),
                     item, value);
}

// A session may raise its own limit as far as the hard one.
rlimit raised_limit(__rlimit_resource resource) noexcept {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) return limit;
  if (limit.rlim_cur != limit.rlim_max) {
    const rlimit wanted{limit.rlim_max, limit.rlim_max};
    if (setrlimit(resource, &wanted) == 0) limit = wanted;
  }
  return limit;
}

RealtimeItem set_scheduling() {
  RealtimeItem item{.what = fmt::format("SCHED_FIFO priority {}", kRealtimePriority),
                    .ok = false,
                    .detail = "",
                    .why_not = "",
                    .what_to_do = ""};
  const rlimit limit = raised_limit(RLIMIT_RTPRIO);
  const sched_param wanted{.sched_priority = kRealtimePriority};
  // Threads and programs that this thread starts shall be ordinary ones.
  if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted) == 0) {
    item.ok = true;
    item.detail = "given";
    return item;
  }
  const int error = errno;
  item.detail = "ordinary scheduling";
  if (error == EPERM && limit.rlim_cur < kRealtimePriority) {
    item.why_not = fmt::format("{}: the limit (ulimit -r) is {}, {} is needed", words(error),
                               limit_text(limit.rlim_cur, 1), kRealtimePriority);
    item.what_to_do = limits_advice("rtprio", std::to_string(kRealtimePriority));
  } else {
    item.why_not = fmt::format("{} although the limit (ulimit -r) is {}", words(error), limit_text(limit.rlim_cur, 1));
    item.what_to_do =
        "in a container, give it the capability SYS_NICE; otherwise the control group of this login has no real-time "
        "time (cpu.rt_runtime_us), or the kernel none (sysctl kernel.sched_rt_runtime_us)";
  }
  return item;
}

// Whether more than the limit may be locked, as the holder of CAP_IPC_LOCK may. Tried and not looked up: in a user
// namespace the capability shows and does not count. MLOCK_ONFAULT charges the limit without touching a page.
bool may_lock_beyond(rlim_t limit) noexcept {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const std::size_t size = static_cast<std::size_t>(limit) / page * page + 2 * page;
  void* const area = mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (area == MAP_FAILED) return false;
  const bool locked = mlock2(area, size, MLOCK_ONFAULT) == 0;
  munmap(area, size);
  return locked;
}

// mlockall is of the process: the last scope unlocks.
std::mutex memory_mutex;
int memory_locks = 0;

RealtimeItem lock_memory() {
  RealtimeItem item{
      .what = "memory locked", .ok = false, .detail = "may be swapped out", .why_not = "", .what_to_do = ""};
  const rlimit limit = raised_limit(RLIMIT_MEMLOCK);
  const std::lock_guard lock(memory_mutex);
  // Under a limit the lock could succeed now and make a later allocation fail in the middle of a session.
  if (memory_locks == 0 && limit.rlim_cur != RLIM_INFINITY && !may_lock_beyond(limit.rlim_cur)) {
    item.why_not = fmt::format("the limit (ulimit -l) is {} kB, no limit is needed", limit_text(limit.rlim_cur, 1024));
    item.what_to_do = limits_advice("memlock", "unlimited");
    return item;
  }
  if (memory_locks == 0 && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    item.why_not = words(errno);
    item.what_to_do = limits_advice("memlock", "unlimited");
    return item;
  }
  ++memory_locks;
  item.ok = true;
  item.detail = "all pages, now and in future";
  return item;
}

void unlock_memory() noexcept {
  const std::lock_guard lock(memory_mutex);
  if (--memory_locks == 0) munlockall();
}

// The pages that the loop will use, before it does: also where the lock was refused.
void prefault_stack() noexcept {
  constexpr std::size_t kSize = 131'072, kStep = 1024;
  std::array<volatile char, kSize> stack;
  for (std::size_t i = 0; i < kSize; i += kStep) stack[i] = 0;
}

std::vector<int> processors_in(const cpu_set_t& set) {
  std::vector<int> processors;
  for (int processor = 0; processor < CPU_SETSIZE; ++processor)
    if (CPU_ISSET(static_cast<std::size_t>(processor), &set)) processors.push_back(processor);
  return processors;
}

std::vector<int> isolated_processors() {
  std::ifstream file("/sys/devices/system/cpu/isolated");
  std::string line;
  std::getline(file, line);
  return parse_processor_list(line);
}

bool move_to(int processor) noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(processor), &set);
  return sched_setaffinity(0, sizeof set, &set) == 0;
}

RealtimeItem take_processor(const std::vector<int>& allowed, bool fifo) {
  RealtimeItem item{.what = "processor of its own", .ok = true, .detail = "", .why_not = "", .what_to_do = ""};
  const std::vector<int> isolated = isolated_processors();
  if (const auto processor = choose_processor(allowed, isolated); !isolated.empty() && move_to(*processor)) {
    item.detail = fmt::format("processor {}, isolated", *processor);
    return item;
  }
  const auto processor = choose_processor(allowed, {});
  if (!processor) {
    item.detail = "only one processor is allowed: nothing to choose";
  } else if (!fifo) {
    // An ordinary thread tied to one processor would wait behind whatever else runs there.
    item.detail = "left to the scheduler, which is better without SCHED_FIFO";
  } else if (move_to(*processor)) {
    item.detail = fmt::format("processor {} of {}", *processor, processor_list_text(allowed));
  } else {
    item.ok = false;
    item.why_not = words(errno);
    item.what_to_do = fmt::format("check that this login may use processor {} (taskset, cpuset)", *processor);
  }
  return item;
}

RealtimeItem set_timer_slack() {
  RealtimeItem item{.what = "timer slack 1 ns", .ok = true, .detail = "set", .why_not = "", .what_to_do = ""};
  if (prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL) != 0) {
    item.ok = false;
    item.detail = "the kernel's default";
    item.why_not = words(errno);
    item.what_to_do = "check that the sandbox or container lets prctl(PR_SET_TIMERSLACK) through";
  }
  return item;
}

// A processor in deep sleep takes tens of microseconds to wake. Most logins may not ask; the loop works without.
RealtimeItem stay_awake(int& request) {
  RealtimeItem item{
      .what = "processors kept awake", .ok = true, .detail = "while it runs", .why_not = "", .what_to_do = ""};
  request = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
  const std::int32_t most_us = 0;
  if (request >= 0 && write(request, &most_us, sizeof most_us) == static_cast<ssize_t>(sizeof most_us)) return item;
  item.detail = fmt::format("left to power saving (/dev/cpu_dma_latency: {})", words(errno));
  if (request >= 0) close(request);
  request = -1;
  return item;
}

}  // namespace

std::string_view to_string(RealtimePolicy policy) noexcept {
  return word_of(kPolicies, policy);
}

std::optional<RealtimePolicy> parse_realtime_policy(std::string_view word) noexcept {
  return value_of(kPolicies, word);
}

bool RealtimeReport::all_ok() const noexcept {
  for (const RealtimeItem& item : items)
    if (!item.ok) return false;
  return true;
}

bool RealtimeReport::fifo() const noexcept {
  return !items.empty() && items.front().ok;
}

std::string RealtimeReport::problems() const {
  std::string text;
  for (const RealtimeItem& item : items)
    if (!item.ok)
      text += fmt::format("{}{}: {}; {}", text.empty() ? "" : "\n", item.what, item.why_not, item.what_to_do);
  return text;
}

struct RealtimeScope::Former {
  int policy = SCHED_OTHER;
  sched_param parameters{};
  cpu_set_t processors{};
  unsigned long timer_slack_ns = 0;
  bool memory_locked = false;
  int awake_request = -1;  // open as long as processors shall stay awake

  Former() {
    policy = sched_getscheduler(0);
    sched_getparam(0, &parameters);
    sched_getaffinity(0, sizeof processors, &processors);
    timer_slack_ns = static_cast<unsigned long>(prctl(PR_GET_TIMERSLACK, 0UL, 0UL, 0UL, 0UL));
  }
  // What the thread had before it may have again: no privilege is needed, and a destructor reports no error.
  ~Former() {
    // Only a privileged thread may drop SCHED_RESET_ON_FORK again.
    if (sched_setscheduler(0, policy, &parameters) != 0)
      sched_setscheduler(0, policy | SCHED_RESET_ON_FORK, &parameters);
    sched_setaffinity(0, sizeof processors, &processors);
    prctl(PR_SET_TIMERSLACK, timer_slack_ns, 0UL, 0UL, 0UL);
    if (awake_request >= 0) close(awake_request);
    if (memory_locked) unlock_memory();
  }
  Former(const Former&) = delete;
  Former& operator=(const Former&) = delete;
};

RealtimeScope::RealtimeScope(RealtimePolicy policy) {
  report_.policy = policy;
  if (policy == RealtimePolicy::off) return;
  former_ = std::make_unique<Former>();
  report_.items.push_back(set_scheduling());
  report_.items.push_back(lock_memory());
  former_->memory_locked = report_.items.back().ok;
  prefault_stack();
  report_.items.push_back(take_processor(processors_in(former_->processors), report_.fifo()));
  report_.items.push_back(set_timer_slack());
  report_.items.push_back(stay_awake(former_->awake_request));
  if (policy == RealtimePolicy::require && !report_.all_ok())
    throw DeviceError("this machine does not give the real-time scheduling that is required:\n" + report_.problems() +
                      "\njnd doctor says more; without the requirement the session runs on what the machine gives");
}

RealtimeScope::~RealtimeScope() = default;

// Which processors there are, as Linux writes them, and which one a real-time thread takes.

namespace {

constexpr int kMostProcessors = 8192;  // Linux's own largest NR_CPUS

bool read_number(std::string_view& text, int& number) noexcept {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || number < 0 || number >= kMostProcessors) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

}  // namespace

std::vector<int> parse_processor_list(std::string_view text) {
  const auto last = text.find_last_not_of(" \n\t");
  text = text.substr(0, last == std::string_view::npos ? 0 : last + 1);
  std::vector<int> processors;
  while (!text.empty()) {
    int from = 0;
    if (!read_number(text, from)) return {};
    int to = from;
    if (text.starts_with('-')) {
      text.remove_prefix(1);
      if (!read_number(text, to) || to < from) return {};
    }
    for (int processor = from; processor <= to; ++processor) processors.push_back(processor);
    if (text.empty()) break;
    if (!text.starts_with(',') || text.size() == 1) return {};
    text.remove_prefix(1);
  }
  std::sort(processors.begin(), processors.end());
  processors.erase(std::unique(processors.begin(), processors.end()), processors.end());
  return processors;
}

std::string processor_list_text(const std::vector<int>& processors) {
  std::string text;
  for (std::size_t i = 0; i < processors.size();) {
    std::size_t end = i + 1;
    while (end < processors.size() && processors[end] == processors[end - 1] + 1) ++end;
    if (!text.empty()) text += ',';
    text += end - i == 1 ? std::to_string(processors[i]) : fmt::format("{}-{}", processors[i], processors[end - 1]);
    i = end;
  }
  return text;
}

std::optional<int> choose_processor(const std::vector<int>& allowed, const std::vector<int>& isolated) noexcept {
  if (!isolated.empty()) return isolated.back();
  if (allowed.size() < 2) return std::nullopt;
  return allowed.back();
}

}  // namespace jnd
