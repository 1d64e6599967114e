// What `jnd doctor` finds, on made-up machines: trees of /sys, /proc and /dev in a temporary folder.
#include "devices/machine/machine_checks.h"

#include <filesystem>
#include <fstream>

#include <sys/stat.h>
#include <unistd.h>

#include "tests/catch.h"

using namespace jnd;

namespace {

namespace fs = std::filesystem;

class Machine {
 public:
  Machine() {
    std::string name = (fs::temp_directory_path() / "jnd-machine-XXXXXX").string();
    root = mkdtemp(name.data());
  }
  ~Machine() {
    std::error_code error;
    fs::remove_all(root, error);
  }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;
  void put(const std::string& path, const std::string& text) const {
    fs::create_directories((root / path).parent_path());
    std::ofstream(root / path) << text;
  }
  fs::path root;
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

JitterReport measured(std::int64_t usual_ns, std::int64_t worst_ns, int worst = 1) {
  JitterReport report;
  report.ticks = 1000;
  for (int i = 0; i < 1000; ++i) report.lateness.add(i < worst ? worst_ns : usual_ns);
  return report;
}

}  // namespace

TEST_CASE("a machine that shows nothing is no failure, and says so") {
  const Machine machine;
  for (const auto& check : {check_kernel(machine.root), check_processors(machine.root), check_frequency(machine.root),
                            check_clock_source(machine.root)}) {
    CAPTURE(check.what);
    CHECK(check.verdict == Verdict::ok);
    CHECK(contains(check.found, "not readable"));
    CHECK(check.what_to_do.empty());
  }
  const Check hid = check_hid(machine.root);
  CHECK(hid.verdict == Verdict::ok);
  CHECK(contains(hid.found, "none connected"));
}

TEST_CASE("the kernel's release and preemption") {
  const Machine machine;
  machine.put("proc/sys/kernel/osrelease", "6.1.0-18-amd64\n");
  machine.put("proc/version", "Linux version 6.1.0-18-amd64 (gcc-12) #1 SMP PREEMPT_DYNAMIC Debian 6.1.76-1\n");
  CHECK(check_kernel(machine.root).verdict == Verdict::ok);
  CHECK(contains(check_kernel(machine.root).found, "6.1.0-18-amd64, preemptible (PREEMPT_DYNAMIC)"));
  machine.put("proc/version", "Linux version 6.1.0-18-rt-amd64 (gcc-12) #1 SMP PREEMPT_RT Debian 6.1.76-1\n");
  CHECK(contains(check_kernel(machine.root).found, "fully preemptible"));
  machine.put("proc/version", "Linux version 5.4.0 (gcc-9) #1 SMP Mon\n");
  CHECK(check_kernel(machine.root).verdict == Verdict::warn);
  CHECK(contains(check_kernel(machine.root).what_to_do, "PREEMPT_RT"));
  machine.put("sys/kernel/realtime", "1\n");
  CHECK(check_kernel(machine.root).verdict == Verdict::ok);
}

TEST_CASE("processors and their load") {
  const Machine machine;
  machine.put("sys/devices/system/cpu/online", "0-3\n");
  machine.put("sys/devices/system/cpu/isolated", "2-3\n");
  machine.put("proc/loadavg", "1.25 0.5 0.4 1/200 1234\n");
  Check check = check_processors(machine.root);
  CHECK(check.verdict == Verdict::ok);
  CHECK(check.found == "4, of them isolated 2-3, load 1.25");
  machine.put("proc/loadavg", "4.50 0.5 0.4 1/200 1234\n");
  check = check_processors(machine.root);
  CHECK(check.verdict == Verdict::warn);
  CHECK(contains(check.what_to_do, "end other programs"));
  machine.put("sys/devices/system/cpu/online", "0\n");
  machine.put("proc/loadavg", "0.10 0.5 0.4 1/200 1234\n");
  check = check_processors(machine.root);
  CHECK(check.verdict == Verdict::warn);
  CHECK(contains(check.what_to_do, "two processors"));
}

TEST_CASE("frequency governors, grouped, in the order of the processors") {
  const Machine machine;
  for (int cpu = 0; cpu < 12; ++cpu)
    machine.put("sys/devices/system/cpu/cpu" + std::to_string(cpu) + "/cpufreq/scaling_governor", "performance\n");
  machine.put("sys/devices/system/cpu/cpufreq/boost", "1\n");
  machine.put("sys/devices/system/cpu/cpuidle/current_driver", "none\n");
  CHECK(check_frequency(machine.root).verdict == Verdict::ok);
  CHECK(check_frequency(machine.root).found == "governor performance on 0-11");
  machine.put("sys/devices/system/cpu/cpu3/cpufreq/scaling_governor", "powersave\n");
  const Check check = check_frequency(machine.root);
  CHECK(check.verdict == Verdict::warn);
  CHECK(contains(check.found, "performance on 0-2,4-11, powersave on 3"));
  CHECK(contains(check.what_to_do, "cpupower frequency-set -g performance"));
}

TEST_CASE("the clock source") {
  const Machine machine;
  const std::string folder = "sys/devices/system/clocksource/clocksource0/";
  for (const char* good : {"tsc", "kvm-clock", "arch_sys_counter"}) {
    machine.put(folder + "current_clocksource", std::string(good) + "\n");
    CHECK(check_clock_source(machine.root).verdict == Verdict::ok);
    CHECK(check_clock_source(machine.root).found == good);
  }
  machine.put(folder + "available_clocksource", "hpet acpi_pm\n");
  for (const char* slow : {"hpet", "acpi_pm", "jiffies"}) {
    machine.put(folder + "current_clocksource", std::string(slow) + "\n");
    CHECK(check_clock_source(machine.root).verdict == Verdict::warn);
    CHECK_FALSE(check_clock_source(machine.root).what_to_do.empty());
  }
}

TEST_CASE("HID devices: those that may be used, those that may not, and the rule that would let them") {
  const Machine machine;
  machine.put("dev/hidraw0", "");
  machine.put("sys/class/hidraw/hidraw0/device/uevent",
              "DRIVER=hid\nHID_ID=0003:0000ABCD:00000012\nHID_NAME=Thing 1\n");
  Check check = check_hid(machine.root);
  CHECK(check.verdict == Verdict::ok);
  CHECK(check.found == "1 connected; usable: hidraw0 (Thing 1)");
  // One that no user may use, root either: a name that leads nowhere. What it is, it does not say.
  fs::create_symlink("nowhere", machine.root / "dev/hidraw10");
  machine.put("sys/class/hidraw/hidraw10/device/uevent", "HID_ID=0003:0000046D:0000C52B\nHID_NAME=Thing\n");
  check = check_hid(machine.root);
  CHECK(check.verdict == Verdict::warn);
  CHECK(contains(check.found, "2 connected; usable: hidraw0 (Thing 1)"));
  CHECK(contains(check.found, "not readable and writable by this login: hidraw10 (Thing)"));
  CHECK(
      contains(check.what_to_do, "KERNELS==\"0003:046D:C52B.*\", MODE=\"0660\", GROUP=\"plugdev\", TAG+=\"uaccess\""));
  CHECK(contains(check.what_to_do, "/etc/udev/rules.d/70-jnd.rules"));
  // It says that it is a keyboard, which no session needs.
  machine.put("sys/class/hidraw/hidraw10/device/report_descriptor", "\x05\x01\x09\x06\xA1\x01");
  check = check_hid(machine.root);
  CHECK(check.verdict == Verdict::ok);
  CHECK(contains(check.found, "matters for a button box only: hidraw10 (Thing)"));
}

TEST_CASE("HID devices of ours are known by their usage, with serial number") {
  const Machine machine;
  machine.put("dev/hidraw3", "");
  machine.put("sys/class/hidraw/hidraw3/device/uevent",
              "HID_ID=0003:00001209:00005AFE\nHID_NAME=Whatever\nHID_UNIQ=FT-0001\n");
  machine.put("sys/class/hidraw/hidraw3/device/report_descriptor", "\x06\x4A\xFF\x09\x01\xA1\x01");
  CHECK(check_hid(machine.root).found == "1 connected; of jnd and usable: hidraw3 (fingertip device FT-0001)");
  fs::create_symlink("nowhere", machine.root / "dev/hidraw4");
  machine.put("sys/class/hidraw/hidraw4/device/uevent", "HID_ID=0005:00001209:00005AFE\nHID_UNIQ=TR-1\n");
  machine.put("sys/class/hidraw/hidraw4/device/report_descriptor", "\x06\x4A\xFF\x09\x02\xA1\x01");
  const Check check = check_hid(machine.root);
  CHECK(check.verdict == Verdict::warn);
  CHECK(contains(check.found, "by this login: hidraw4 (tracker TR-1)"));
  CHECK(contains(check.what_to_do, "\"0005:1209:5AFE.*\""));
}

TEST_CASE("what the kernel refused a real-time thread is a warning with its remedy") {
  RealtimeReport report{.policy = RealtimePolicy::prefer, .items = {}};
  CHECK(check_realtime(report).empty());
  report.items.push_back(
      {.what = "SCHED_FIFO", .ok = false, .detail = "ordinary", .why_not = "limit 0", .what_to_do = "raise it"});
  report.items.push_back({.what = "memory locked", .ok = true, .detail = "all", .why_not = "", .what_to_do = ""});
  const auto checks = check_realtime(report);
  REQUIRE(checks.size() == 2);
  CHECK(checks[0].verdict == Verdict::warn);
  CHECK(checks[0].found == "ordinary (limit 0)");
  CHECK(checks[0].what_to_do == "raise it");
  CHECK(checks[1].verdict == Verdict::ok);
}

TEST_CASE("lateness: fine, tight, and too much for a session") {
  CHECK(judge_jitter(measured(10'000, 900'000)).verdict == Verdict::ok);
  CHECK(judge_jitter(measured(10'000, 1'100'000)).verdict == Verdict::warn);     // one tick skipped
  CHECK(judge_jitter(measured(150'000, 200'000)).verdict == Verdict::warn);      // p99 above a tenth of a period
  CHECK(judge_jitter(measured(10'000, 20'000'000)).verdict == Verdict::bad);     // a gap that ends a trial
  CHECK(judge_jitter(measured(10'000, 1'500'000, 20)).verdict == Verdict::bad);  // p99 above a period
  CHECK(judge_jitter(JitterReport{}).verdict == Verdict::warn);
  // Half as late as voids a trial, in a second: a session, hundreds of times as long, would lose trials.
  CHECK(judge_jitter(measured(10'000, 9'400'000)).verdict == Verdict::warn);
  CHECK(judge_jitter(measured(10'000, 9'600'000)).verdict == Verdict::bad);
  CHECK(contains(judge_jitter(measured(10'000, 19'500'000)).found, "19 ms late, which voids a trial"));
  CHECK(contains(judge_jitter(measured(10'000, 50'000)).found, "p50 10 us, p99 10 us, largest 50 us"));
}

TEST_CASE("skipped ticks are judged by their share of the ticks that were due, however long was measured") {
  const auto skipped = [](std::int64_t ticks, std::int64_t overruns) {
    JitterReport report = measured(10'000, 900'000);
    report.ticks = ticks;
    report.overruns = overruns;
    return judge_jitter(report);
  };
  CHECK(skipped(3000, 0).verdict == Verdict::ok);
  CHECK(skipped(2978, 22).verdict == Verdict::warn);
  CHECK(skipped(2970, 30).verdict == Verdict::bad);  // 1 %, the limit itself
  CHECK(skipped(2911, 89).verdict == Verdict::bad);  // 3 %
  CHECK(contains(skipped(2911, 89).found, "89 skipped (3 %)"));
  CHECK(skipped(299'911, 89).verdict == Verdict::warn);
}

TEST_CASE("where studies go, judged by its figures") {
  const StorageFigures fine{.folder = "/data",
                            .type = "ext4",
                            .network = false,
                            .free_bytes = 5e10,
                            .sync_median_s = 0.004,
                            .sync_max_s = 0.020};
  CHECK(judge_storage(fine).verdict == Verdict::ok);
  CHECK(judge_storage(fine).found == "/data (ext4), 50 GB free, saving a trial takes 4.0 ms (longest 20.0 ms)");
  const auto changed = [&](auto change) {
    StorageFigures figures = fine;
    change(figures);
    const Check check = judge_storage(figures);
    CHECK_FALSE(check.what_to_do.empty());
    return check.verdict;
  };
  CHECK(changed([](StorageFigures& f) { f.network = true; }) == Verdict::bad);
  CHECK(changed([](StorageFigures& f) { f.type = "tmpfs"; }) == Verdict::bad);
  CHECK(changed([](StorageFigures& f) { f.type = "devtmpfs"; }) == Verdict::bad);
  CHECK(changed([](StorageFigures& f) { f.type = "fuse.sshfs"; }) == Verdict::bad);
  CHECK(changed([](StorageFigures& f) { f.free_bytes = 5e8; }) == Verdict::warn);
  CHECK(changed([](StorageFigures& f) { f.free_bytes = 5e7; }) == Verdict::bad);
  CHECK(changed([](StorageFigures& f) { f.sync_median_s = 0.1; }) == Verdict::warn);
  CHECK(changed([](StorageFigures& f) { f.sync_max_s = 2; }) == Verdict::warn);
  CHECK(changed([](StorageFigures& f) { f.sync_median_s = 2; }) == Verdict::bad);
  CHECK(changed([](StorageFigures& f) {
          f.network = true;
          f.free_bytes = 5e8;
        }) == Verdict::bad);
  // A rehearsal may be kept where it can be lost; no session begins without room for it.
  CHECK(changed([](StorageFigures& f) {
          f.type = "tmpfs";
          f.real = false;
        }) == Verdict::warn);
  CHECK(changed([](StorageFigures& f) {
          f.network = true;
          f.real = false;
        }) == Verdict::warn);
  CHECK(changed([](StorageFigures& f) { f.needed_bytes = 4.95e10; }) == Verdict::warn);
  CHECK(changed([](StorageFigures& f) {
          f.needed_bytes = 5.1e10;
          f.real = false;
        }) == Verdict::bad);
  StorageFigures room = fine;
  room.needed_bytes = 2e9;
  CHECK(judge_storage(room).verdict == Verdict::ok);
  CHECK(contains(judge_storage(room).found, "a session needs 2 GB"));
}

TEST_CASE("where studies go, measured") {
  const Machine machine;
  const std::string folder = fs::canonical(machine.root).string();
  machine.put("proc/self/mountinfo", "21 1 8:1 / / rw - rootfs none rw\n30 21 8:2 / " + folder +
                                         " rw,relatime shared:1 - madeupfs /dev/sdb1 rw\n31 21 8:3 / " + folder +
                                         "-other rw - wrong none rw\n");
  StorageProbe probe{.root = machine.root, .is_network = [](long) { return false; }, .syncs = 3};
  for (const fs::path& asked : {machine.root, machine.root / "study.sqlite"}) {
    const Check check = check_storage(asked, probe);
    CAPTURE(check.found);
    CHECK(contains(check.found, folder + " (madeupfs)"));
    CHECK(contains(check.found, "saving a trial takes"));
  }
  CHECK(fs::exists(machine.root / "proc"));
  for (const auto& entry : fs::directory_iterator(machine.root)) CHECK(entry.path().filename() == "proc");  // no rest
  probe.is_network = [](long) { return true; };
  CHECK(check_storage(machine.root, probe).verdict == Verdict::bad);
  const Check missing = check_storage(machine.root / "no" / "such" / "study.sqlite", probe);
  CHECK(missing.verdict == Verdict::bad);
  CHECK(contains(missing.found, "no such folder"));
  CHECK_FALSE(missing.what_to_do.empty());
}

TEST_CASE("a folder that cannot be written is bad, with the reason") {
  // /proc/self exists on every Linux and takes no files, not even from root.
  const Check check = check_storage("/proc/self", {.root = "/", .is_network = [](long) { return false; }, .syncs = 1});
  CHECK(check.verdict == Verdict::bad);
  CHECK(contains(check.found, "cannot be written"));
}
