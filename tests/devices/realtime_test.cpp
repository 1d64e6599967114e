// What is asked of the kernel, what it refuses, and that it is given back. As root or not, on any machine: what is not
// permitted must lead to the report that says so.
#include "devices/realtime.h"

#include <functional>

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "devices/clock.h"
#include "devices/device_error.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

struct Scheduling {
  int policy = 0, priority = 0;
  std::string processors;
  int slack_ns = 0;
  bool operator==(const Scheduling&) const = default;
};

Scheduling scheduling() {
  sched_param parameters{};
  sched_getparam(0, &parameters);
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  std::vector<int> processors;
  for (int i = 0; i < CPU_SETSIZE; ++i)
    if (CPU_ISSET(static_cast<std::size_t>(i), &set)) processors.push_back(i);
  return {.policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK,
          .priority = parameters.sched_priority,
          .processors = processor_list_text(processors),
          .slack_ns = prctl(PR_GET_TIMERSLACK, 0, 0, 0, 0)};
}

// Runs `body` in a child process without any privilege and with limits of nothing; true where it returned true.
bool unprivileged(const std::function<bool()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit nothing{0, 0};
    bool done = setrlimit(RLIMIT_RTPRIO, &nothing) == 0 && setrlimit(RLIMIT_MEMLOCK, &nothing) == 0;
    if (getuid() == 0) done = setgid(65534) == 0 && setuid(65534) == 0 && done;
    bool passed = false;
    try {
      passed = done && body();
    } catch (...) {
      passed = false;
    }
    _exit(passed ? 0 : 1);
  }
  int status = -1;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("the words of the policy are read as they are written") {
  for (const RealtimePolicy policy : {RealtimePolicy::off, RealtimePolicy::prefer, RealtimePolicy::require})
    CHECK(parse_realtime_policy(to_string(policy)) == policy);
  for (const char* word : {"", "Off", "yes", "required", "prefer "})
    CHECK_FALSE(parse_realtime_policy(word).has_value());
}

TEST_CASE("off touches nothing") {
  const Scheduling before = scheduling();
  const RealtimeScope scope(RealtimePolicy::off);
  const RealtimeReport& report = scope.report();
  CHECK(report.items.empty());
  CHECK(report.all_ok());
  CHECK_FALSE(report.fifo());
  CHECK(scheduling() == before);
}

TEST_CASE("what prefer reports is what the kernel now does, and the scope gives it back") {
  const Scheduling before = scheduling();
  {
    const RealtimeScope scope(RealtimePolicy::prefer);
    const RealtimeReport& report = scope.report();
    REQUIRE(report.items.size() == 5);
    for (const RealtimeItem& item : report.items) {
      CAPTURE(item.what, item.detail, item.why_not);
      CHECK_FALSE(item.what.empty());
      CHECK_FALSE(item.detail.empty());
      CHECK(item.why_not.empty() == item.ok);
      CHECK(item.what_to_do.empty() == item.ok);
    }
    const Scheduling now = scheduling();
    CHECK((now.policy == SCHED_FIFO) == report.fifo());
    CHECK(now.priority == (report.fifo() ? kRealtimePriority : before.priority));
    // Real-time threads have no slack: the kernel shows 0 or what was set.
    if (report.items[3].ok) CHECK(now.slack_ns <= 1);
    if (report.fifo() && report.items[2].ok) CHECK(parse_processor_list(now.processors).size() == 1);
    CHECK(report.all_ok() == report.problems().empty());
  }
  CHECK(scheduling() == before);
}

TEST_CASE("require gives all or throws, and then leaves the thread as it was") {
  const Scheduling before = scheduling();
  bool possible = false;
  {
    const RealtimeScope preferred(RealtimePolicy::prefer);
    possible = preferred.report().all_ok();
  }
  if (possible) {
    const RealtimeScope scope(RealtimePolicy::require);
    CHECK(scope.report().all_ok());
  } else {
    CHECK_THROWS_AS(RealtimeScope(RealtimePolicy::require), DeviceError);
  }
  CHECK(scheduling() == before);
}

TEST_CASE("without permission prefer says why and goes on") {
  CHECK(unprivileged([] {
    const RealtimeScope scope(RealtimePolicy::prefer);
    const RealtimeReport& report = scope.report();
    const RealtimeItem& scheduled = report.items.at(0);
    const RealtimeItem& memory = report.items.at(1);
    return !report.fifo() && scheduling().policy == SCHED_OTHER && !report.all_ok() && !memory.ok &&
           contains(scheduled.why_not, "ulimit -r") && contains(scheduled.why_not, "is 0, 50 is needed") &&
           contains(scheduled.what_to_do, "rtprio 50") &&
           contains(scheduled.what_to_do, "/etc/security/limits.d/99-jnd.conf") &&
           contains(memory.why_not, "(ulimit -l) is 0 kB") && contains(memory.what_to_do, "memlock unlimited");
  }));
}

TEST_CASE("without permission require throws, naming all that failed and what to do") {
  CHECK(unprivileged([] {
    const Scheduling before = scheduling();
    try {
      const RealtimeScope scope(RealtimePolicy::require);
    } catch (const DeviceError& error) {
      const std::string message = error.what();
      return contains(message, "SCHED_FIFO priority 50") && contains(message, "memory locked") &&
             contains(message, "limits.d") && scheduling() == before;
    }
    return false;
  }));
}

TEST_CASE("a finite limit of locked memory is refused even where the lock would succeed now") {
  CHECK(unprivileged([] {
    // The child's hard limit is 0 already; a process with no pages would pass the limit, this one must not try.
    const RealtimeScope scope(RealtimePolicy::prefer);
    if (scope.report().items.at(1).ok) return false;
    // Allocations of any size still succeed.
    void* const area = mmap(nullptr, 64 << 20, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return area != MAP_FAILED;
  }));
}

TEST_CASE("lists of processors are read and written as Linux does") {
  CHECK(parse_processor_list("0-3,8\n") == std::vector<int>{0, 1, 2, 3, 8});
  CHECK(parse_processor_list("5") == std::vector<int>{5});
  CHECK(parse_processor_list("2,0-1,1") == std::vector<int>{0, 1, 2});
  for (const char* wrong : {"", "\n", "a", "3-1", "1,", ",1", "1-", "-1", "1 2", "99999999999", "0-9999"})
    CHECK(parse_processor_list(wrong).empty());
  for (const char* text : {"", "0", "0-1", "0-3,8", "1,3,5-6"})
    CHECK(processor_list_text(parse_processor_list(text)) == text);
}

TEST_CASE("the real-time thread goes to an isolated processor, else the last allowed, else nowhere") {
  CHECK(choose_processor({0, 1, 2}, {}) == 2);
  CHECK(choose_processor({0, 1}, {2, 3}) == 3);
  CHECK(choose_processor({0}, {3}) == 3);
  CHECK_FALSE(choose_processor({0}, {}).has_value());
  CHECK_FALSE(choose_processor({}, {}).has_value());
}
