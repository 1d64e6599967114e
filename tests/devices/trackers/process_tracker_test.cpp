// Poses from a program: real little ones that do what programs do.
#include "devices/trackers/process_tracker.h"

#include <csignal>
#include <fstream>
#include <iterator>

#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/devices/tracker_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

const SteadyClock kClock;

// Stands still until it is set, and counts how often somebody looks at it.
class WatchedClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override {
    looks_.fetch_add(1);
    return now_.load();
  }
  std::int64_t utc_ns() const noexcept override { return now_.load(); }
  void sleep_until_ns(std::int64_t deadline) noexcept override { now_.store(deadline); }
  // Until the tracker's thread has seen that it is so late. False: it does not look any more.
  [[nodiscard]] bool shows(std::int64_t now_ns) {
    now_.store(now_ns);
    const int seen = looks_.load() + 5;
    return wait_until([&] { return looks_.load() >= seen; });
  }

 private:
  mutable std::atomic<int> looks_{0};
  std::atomic<std::int64_t> now_{3'600'000 * kMs};
};
const std::vector<std::string> kOneFinger = {"index"};

std::vector<std::string> python(const std::string& text) {
  return {"python3", "-c", "import os, signal, sys, time\nsay = lambda s: print(s, flush=True)\n" + text};
}
std::vector<std::string> shell(const std::string& text) {
  return {"sh", "-c", text};
}
constexpr const char* kSource = "jnd-poses 1 units=m clock=source";
constexpr const char* kForEver = "\nwhile True: signal.pause()";

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}
std::size_t lines_of(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

// Neither gone nor a zombie that another process has to reap.
bool runs(const std::string& pid) {
  const std::string stat = read_file("/proc/" + pid + "/stat");
  const std::size_t name_end = stat.rfind(')');
  return name_end != std::string::npos && stat.at(name_end + 2) != 'Z' && stat.at(name_end + 2) != 'X';
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a program that tells poses in time is a tracker") {
  const std::int64_t before = kClock.now_ns();
  ProcessTracker tracker(python("say('# hello')\nsay('jnd-poses 1 units=m clock=monotonic')\nn = 0\n"
                                "while True:\n"
                                " say(f'index {time.monotonic():.9f} 0.05 0.01 -0.02 1 0 0 0 0.3 n={n}')\n"
                                " n += 1\n time.sleep(0.004)"),
                         {}, kOneFinger, kHere, kClock);
  REQUIRE(wait_until([&] { return tracker.missing().empty(); }));
  FingerPose pose;
  REQUIRE(tracker.read(0, kClock.now_ns(), pose));
  CHECK(pose.position_m == Eigen::Vector3d(0.05, 0.01, -0.02));
  CHECK(pose.flexion_rad == 0.3);
  CHECK(pose.time_ns > before);
  CHECK(pose.time_ns <= kClock.now_ns());
  REQUIRE(wait_until([&] { return tracker.report()->poses > 20; }));
  const auto report = tracker.report();
  CHECK(report->kind == "process");
  CHECK(report->source.substr(0, 10) == "python3 -c");
  CHECK(report->connected);
  CHECK(report->trouble.empty());
  CHECK(report->gaps == 0);
  CHECK(report->refused == 0);
  CHECK(report->rate_hz > 0);
  CHECK(report->latency_p50_ms <= report->latency_p99_ms);
  CHECK(report->latency_max_ms > 0);
}

TEST_CASE("a program that ends is told with its exit code and its last words, and started again") {
  const ScratchFile starts("starts", "");
  WatchedClock clock;
  const std::int64_t began_ns = clock.now_ns();
  ProcessTracker tracker(
      shell("echo start >> starts; echo jnd-poses 1 units=m clock=source; echo index 1 0 0 0 1 0 0 0;"
            "echo 'loading the SDK' >&2; printf 'no licence \\342\\202\\254 found\\n\\n' >&2; exit 3"),
      starts.folder(), kOneFinger, kHere, clock);
  REQUIRE(wait_until([&] { return has(tracker.missing(), "exit code 3"); }));
  CHECK(has(tracker.missing(), "no licence ??? found"));  // what is no ASCII stays out of logs
  CHECK(has(tracker.missing_sealed(), "exit code 3"));
  CHECK_FALSE(has(tracker.missing_sealed(), "licence"));
  CHECK_FALSE(tracker.report()->connected);
  CHECK(has(tracker.report()->trouble, "exit code 3"));
  CHECK(tracker.report()->poses >= 1);  // what it wrote last was heard
  // At most once a second.
  for (std::size_t times = 1; times <= 3; ++times) {
    const std::int64_t again_ns = began_ns + static_cast<std::int64_t>(times) * 1'000 * kMs;
    REQUIRE(clock.shows(again_ns - 1));
    CHECK(lines_of(starts.path()) == times);
    REQUIRE(clock.shows(again_ns));
    REQUIRE(wait_until([&] { return lines_of(starts.path()) == times + 1 && has(tracker.missing(), "exit code 3"); }));
  }
}

TEST_CASE("a program that a signal ends is told with it") {
  ProcessTracker tracker(shell("kill -SEGV $$"), {}, kOneFinger, kHere, kClock);
  REQUIRE(wait_until([&] { return has(tracker.missing(), "signal 11"); }));
}

TEST_CASE("a script whose program is not there is told so") {
  ProcessTracker tracker(shell("exec no-such-program-here"), {}, kOneFinger, kHere, kClock);
  REQUIRE(wait_until([&] { return has(tracker.missing(), "exit code 127: a program was not found"); }));
}

TEST_CASE("a program is not started again within a presentation") {
  const ScratchFile starts("starts", "");
  WatchedClock clock;
  const std::int64_t began_ns = clock.now_ns();
  ProcessTracker tracker(shell("echo start >> starts; exit 1"), starts.folder(), kOneFinger, kHere, clock);
  tracker.begin({}, began_ns);
  FingerPose pose;
  REQUIRE(wait_until([&] { return has(tracker.missing(), "exit code 1"); }));
  for (int ms = 100; ms <= 2'000; ms += 100) {
    (void)tracker.read(0, began_ns + ms * kMs, pose);  // as the loop does, more often
    REQUIRE(clock.shows(began_ns + ms * kMs));
  }
  REQUIRE(clock.shows(began_ns + 2'199 * kMs));
  CHECK(lines_of(starts.path()) == 1);
  REQUIRE(clock.shows(began_ns + 2'200 * kMs));  // it is over
  CHECK(wait_until([&] { return lines_of(starts.path()) >= 2; }));
}

TEST_CASE("garbage is counted, and the first of it is told") {
  ProcessTracker tracker(python(fmt::format("out = os.fdopen(1, 'wb', 0)\n"
                                            "out.write(b'Welcome to the SDK\\xff\\x1b[2J 1.0\\n')\n"
                                            "out.write(b'{}\\n')\n"
                                            "out.write(b'\\x00\\xff\\n' * 10 + b'index nan 0 0 0 1 0 0 0\\n')\n"
                                            "out.write(b'z' * 100000 + b'\\n')\n"
                                            "out.write(b'index 1 0 0 0 1 0 0 0\\nindex 1 0 0 0 1 0 0 0\\n'){}",
                                            kSource, kForEver)),
                         {}, kOneFinger, kHere, kClock);
  REQUIRE(wait_until([&] { return tracker.report()->poses == 1 && tracker.report()->refused == 14; }));
  const std::string trouble = tracker.report()->trouble;
  CHECK(has(trouble, "Welcome to the SDK??[2J 1.0"));
  CHECK(has(trouble, "jnd-poses 1 units=m"));
  CHECK(wait_until([&] { return has(tracker.missing(), "Welcome"); }));  // it is silent, and this may be why
}

TEST_CASE("a program that says nothing has told no pose yet") {
  ProcessTracker tracker(shell("exec tail -f /dev/null"), {}, kTwoFingers, kHere, kClock);
  REQUIRE(wait_until([&] { return tracker.report()->connected; }));
  CHECK(tracker.missing() == "no pose of the thumb has come yet");
  FingerPose pose;
  CHECK_FALSE(tracker.read(0, kClock.now_ns(), pose));
  CHECK(tracker.report()->poses == 0);
}

TEST_CASE("half lines become whole ones") {
  ProcessTracker tracker(python(fmt::format("text = '{}\\n' + ''.join(f'index {{i}} 0.0{{i}} 0 0 1 0 0 0 n={{i}}\\r\\n'"
                                            " for i in range(1, 10))\n"
                                            "for i in range(0, len(text), 7):\n"
                                            " sys.stdout.write(text[i:i + 7]); sys.stdout.flush(); os.sched_yield(){}",
                                            kSource, kForEver)),
                         {}, kOneFinger, kHere, kClock);
  REQUIRE(wait_until([&] { return tracker.report()->poses == 9; }));
  CHECK(tracker.report()->refused == 0);
  CHECK(tracker.report()->gaps == 0);
  FingerPose pose;
  REQUIRE(tracker.read(0, kClock.now_ns(), pose));
  CHECK(pose.position_m.x() == 0.09);
}

TEST_CASE("a flood is taken in to its last line") {
  ProcessTracker tracker(python(fmt::format("say('{}')\n"
                                            "for part in range(20):\n"
                                            " sys.stdout.write(''.join(f'index {{1 + 1e-5 * i:.6f}} 0.05 0 0 1 0 0 0 "
                                            "n={{i}}\\n' for i in range(part * 10000, part * 10000 + 10000)))\n"
                                            "sys.stdout.flush(){}",
                                            kSource, kForEver)),
                         {}, kOneFinger, kHere, kClock);
  REQUIRE(wait_until([&] { return tracker.report()->poses + tracker.report()->refused >= 200'000; }));
  CHECK(tracker.report()->poses == 200'000);
  CHECK(tracker.report()->gaps == 0);
}

TEST_CASE("a program that ignores SIGTERM is killed, with what it started") {
  const ScratchFile pids("pids", "");
  std::string leader, child;
  {
    ProcessTracker tracker(shell("trap '' TERM; tail -f /dev/null & echo $$ $! > pids.new; mv pids.new pids; wait"),
                           pids.folder(), kOneFinger, kHere, kClock);
    REQUIRE(wait_until([&] { return lines_of(pids.path()) == 1; }));
    std::ifstream(pids.path()) >> leader >> child;
    CHECK(runs(leader));
    CHECK(runs(child));
  }
  CHECK(read_file("/proc/" + leader + "/stat").empty());  // no zombie of ours
  CHECK(wait_until([&] { return !runs(child); }));
}

TEST_CASE("a program may end its work in peace") {
  // It has a second for it, which a busy machine may keep from it: then once more.
  CHECK(wait_until([] {
    const ScratchFile file("said", "");
    {
      ProcessTracker tracker(
          shell("trap 'kill $!; echo bye >> said; exit 0' TERM; echo hello >> said; tail -f /dev/null & wait"),
          file.folder(), kOneFinger, kHere, kClock);
      CHECK(wait_until([&] { return read_file(file.path()) == "hello\n"; }));
    }
    return read_file(file.path()) == "hello\nbye\n";
  }));
}

TEST_CASE("a program gets its words, its folder, no input, no other files and no blocked signals") {
  const ScratchFile script(
      "bridge.py",
      "import os, signal, sys\n"
      "files = sorted(int(f) for f in os.listdir('/proc/self/fd') if os.path.exists('/proc/self/fd/' + f))\n"
      "print(sys.argv[1:], os.getcwd(), repr(sys.stdin.read()), files,\n"
      "      signal.pthread_sigmask(signal.SIG_BLOCK, []), os.getpgid(0) == os.getpid(),\n"
      "      signal.getsignal(signal.SIGTERM) == signal.SIG_DFL, file=sys.stderr)\n");
  ProcessTracker tracker({"python3", "bridge.py", "a b", "$HOME;*"}, script.folder(), kOneFinger, kHere, kClock);
  REQUIRE(wait_until([&] { return has(tracker.missing(), "exit code 0"); }));
  const std::string folder = std::filesystem::canonical(script.folder()).string();
  CHECK(has(tracker.missing(), "['a b', '$HOME;*'] " + folder.substr(0, 20)));
  CHECK(has(tracker.missing(), "[0, 1, 2] set() True True"));
}

TEST_CASE("a program that cannot be started is told, and what to do") {
  for (const char* const name : {"/nowhere/bridge", "no-such-program-here", "/"}) {
    ProcessTracker tracker({name}, {}, kOneFinger, kHere, kClock);
    REQUIRE(wait_until([&] { return has(tracker.missing(), "cannot be started"); }));
    CHECK(has(tracker.missing(), name));
    CHECK(has(tracker.missing(), "rig file"));
    CHECK_FALSE(tracker.report()->connected);
  }
}

TEST_CASE("the shipped example is a tracker") {
  ProcessTracker tracker({"python3", "bridge_example.py"}, source_path("devices/trackers"), kTwoFingers, kHere, kClock);
  REQUIRE(wait_until([&] { return tracker.missing().empty() && tracker.report()->poses > 40; }));
  CHECK(tracker.report()->refused == 0);
  CHECK(tracker.report()->gaps == 0);
  FingerPose thumb, index;
  REQUIRE(tracker.read(0, kClock.now_ns(), thumb));
  REQUIRE(tracker.read(1, kClock.now_ns(), index));
  CHECK(thumb.position_m.x() < -0.03);
  CHECK(index.position_m.x() > 0.03);
  CHECK(thumb.device_axes.col(2).dot(-Eigen::Vector3d::UnitX()) == Approx(1));  // the nail looks away from the sphere
  CHECK(index.device_axes.col(2).dot(Eigen::Vector3d::UnitX()) == Approx(1));
}

TEST_CASE("a program that falls silent takes the force away within 20 ms") {
  ProcessTracker tracker(python(fmt::format("say('jnd-poses 1 units=m clock=monotonic')\n"
                                            "now = time.monotonic()\n"
                                            "say(f'thumb {{now:.9f}} -0.036 0 0 0.70710678 0 -0.70710678 0')\n"
                                            "say(f'index {{now:.9f}} 0.036 0 0 0.70710678 0 0.70710678 0'){}",
                                            kForEver)),
                         {}, kTwoFingers, kHere, kClock);
  FingerPose pose;
  REQUIRE(wait_until([&] { return tracker.report()->poses == 2; }));
  REQUIRE(tracker.read(1, 0, pose));
  const std::int64_t last_ns = pose.time_ns;
  const Presentation given = present_on(tracker, last_ns);
  CHECK(given.fault == Fault::stale_pose);
  const ForceEnd end = force_end(given);
  CHECK(end.largest_n > 0.05);  // the soft start is not over yet
  CHECK(end.last_given_n == 0);
  CHECK(end.last_force_ns > last_ns);
  CHECK(end.last_force_ns <= last_ns + 20 * kMs);
  CHECK(end.last_tick_ns <= last_ns + 21 * kMs);
}
