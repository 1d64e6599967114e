#include "devices/machine/machine_checks.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <map>
#include <sstream>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <sys/statvfs.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "devices/loop/control_loop.h"
#include "protocols/input/file_trouble.h"

namespace jnd {

JitterReport probe_jitter(RealtimePolicy policy, double seconds, Clock& clock, const std::atomic<bool>& stop) {
  const RealtimeScope realtime(policy);
  JitterReport report;
  report.realtime = realtime.report();
  const auto periods =
      static_cast<std::int64_t>(std::llround(std::clamp(seconds, 0.0, 1e6) * 1e9 / static_cast<double>(kPeriod_ns)));
  const std::int64_t end_ns = clock.now_ns() + periods * kPeriod_ns;
  std::int64_t deadline_ns = end_ns - periods * kPeriod_ns;
  while (deadline_ns < end_ns && !stop.load(std::memory_order_relaxed)) {
    deadline_ns += kPeriod_ns;
    clock.sleep_until_ns(deadline_ns);
    const std::int64_t late_ns = std::max<std::int64_t>(clock.now_ns() - deadline_ns, 0);
    report.lateness.add(late_ns);
    ++report.ticks;
    // As the control loop: what was missed is counted and not caught up.
    const std::int64_t skipped = late_ns / kPeriod_ns;
    report.overruns += skipped;
    deadline_ns += skipped * kPeriod_ns;
  }
  return report;
}

JitterReport probe_jitter_on_thread(RealtimePolicy policy, double seconds, const std::atomic<bool>& stop) {
  JitterReport report;
  std::exception_ptr error;
  std::thread thread([&] {
    try {
      SteadyClock clock;
      report = probe_jitter(policy, seconds, clock, stop);
    } catch (...) {
      error = std::current_exception();
    }
  });
  thread.join();
  if (error) std::rethrow_exception(error);
  return report;
}

namespace {

namespace fs = std::filesystem;

std::optional<std::string> first_line(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  return line.substr(0, line.find_last_not_of(" \t\r") + 1);
}

// Entries of a folder whose names are a prefix and a number, by number.
std::map<int, fs::path> numbered(const fs::path& folder, std::string_view prefix) {
  std::map<int, fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(prefix)) continue;
    const std::vector<int> number = parse_processor_list(std::string_view(name).substr(prefix.size()));
    if (number.size() == 1) entries[number.front()] = entry->path();
  }
  return entries;
}

// Words of a line, as /proc separates them.
bool has_word(const std::string& line, std::string_view wanted) {
  std::istringstream words(line);
  for (std::string word; words >> word;)
    if (word == wanted) return true;
  return false;
}

}  // namespace

Check check_kernel(const fs::path& root) {
  Check check{.what = "kernel", .verdict = Verdict::ok};
  const std::string version = first_line(root / "proc/version").value_or("");
  const std::string release = first_line(root / "proc/sys/kernel/osrelease").value_or("");
  if (version.empty() && release.empty()) {
    check.found = "version not readable";
    return check;
  }
  const bool real_time =
      first_line(root / "sys/kernel/realtime") == "1" || has_word(version, "PREEMPT_RT") || has_word(version, "RT");
  check.found = "Linux " + (release.empty() ? version : release);
  if (real_time) {
    check.found += ", fully preemptible (PREEMPT_RT)";
  } else if (has_word(version, "PREEMPT_DYNAMIC") || has_word(version, "PREEMPT")) {
    check.found += has_word(version, "PREEMPT_DYNAMIC") ? ", preemptible (PREEMPT_DYNAMIC)" : ", preemptible (PREEMPT)";
    check.found += "; not PREEMPT_RT, which only matters where the lateness below is too large";
  } else {
    check.verdict = Verdict::warn;
    check.found += ", not preemptible: a driver may delay the loop by milliseconds";
    check.what_to_do = "install a kernel with PREEMPT_RT (Debian: apt install linux-image-rt-amd64)";
  }
  return check;
}

Check check_processors(const fs::path& root) {
  Check check{.what = "processors", .verdict = Verdict::ok};
  const std::vector<int> online = parse_processor_list(first_line(root / "sys/devices/system/cpu/online").value_or(""));
  const std::vector<int> isolated =
      parse_processor_list(first_line(root / "sys/devices/system/cpu/isolated").value_or(""));
  check.found = online.empty() ? "number not readable" : fmt::format("{}", online.size());
  if (!isolated.empty()) check.found += fmt::format(", of them isolated {}", processor_list_text(isolated));
  if (online.size() == 1) {
    check.verdict = Verdict::warn;
    check.what_to_do = "use a machine with two processors or more: the loop shares the only one with everything else";
  }
  double load = -1;
  std::istringstream(first_line(root / "proc/loadavg").value_or("")) >> load;
  if (load < 0) return check;
  check.found += fmt::format(", load {:.2f}", load);
  if (!online.empty() && load > static_cast<double>(online.size())) {
    check.verdict = Verdict::warn;
    check.found += ", more than there are processors";
    if (check.what_to_do.empty()) check.what_to_do = "end other programs before a session (see top)";
  }
  return check;
}

Check check_frequency(const fs::path& root) {
  Check check{.what = "processor frequency", .verdict = Verdict::ok};
  std::map<std::string, std::vector<int>> by_governor;
  for (const auto& [number, folder] : numbered(root / "sys/devices/system/cpu", "cpu"))
    if (const auto governor = first_line(folder / "cpufreq/scaling_governor")) by_governor[*governor].push_back(number);
  if (by_governor.empty()) {
    check.found = "governor not readable (a virtual machine, or a fixed frequency)";
    return check;
  }
  for (const auto& [governor, processors] : by_governor) {
    check.found +=
        fmt::format("{}{} on {}", check.found.empty() ? "governor " : ", ", governor, processor_list_text(processors));
    if (governor != "performance") check.verdict = Verdict::warn;
  }
  if (check.verdict != Verdict::ok) {
    check.found += ": a processor that slows down between ticks wakes late";
    check.what_to_do = "cpupower frequency-set -g performance (as root, until the next start)";
  }
  return check;
}

Check check_clock_source(const fs::path& root) {
  Check check{.what = "clock source", .verdict = Verdict::ok};
  const fs::path folder = root / "sys/devices/system/clocksource/clocksource0";
  const auto current = first_line(folder / "current_clocksource");
  if (!current) {
    check.found = "not readable";
    return check;
  }
  check.found = *current;
  if (*current != "hpet" && *current != "acpi_pm" && *current != "jiffies" && *current != "refined-jiffies")
    return check;
  check.verdict = Verdict::warn;
  const std::string available = first_line(folder / "available_clocksource").value_or("");
  if (!available.empty()) check.found += fmt::format(" (of {})", available);
  check.found += *current == "hpet" || *current == "acpi_pm" ? ": every reading of the time takes about a microsecond"
                                                             : ": no finer than a tick of the kernel";
  check.what_to_do =
      has_word(available, "tsc")
          ? "look into the kernel's log why it does not use tsc (journalctl -k | grep -i clocksource)"
          : "the kernel found tsc unstable or has none: look for a firmware update, or use another machine";
  return check;
}

Checks check_realtime(const RealtimeReport& report) {
  Checks checks;
  for (const RealtimeItem& item : report.items)
    checks.push_back({.what = item.what,
                      .verdict = item.ok ? Verdict::ok : Verdict::warn,
                      .found = item.ok ? item.detail : fmt::format("{} ({})", item.detail, item.why_not),
                      .what_to_do = item.ok ? "" : item.what_to_do});
  return checks;
}

namespace {

std::string loop_text(const LoopFigures& figures) {
  return fmt::format("p99 {:.0f} us, largest {:.0f} us over {} ticks of 1 ms, {} skipped ({:.2g} %)", figures.p99_us,
                     figures.largest_us, figures.ticks, figures.overruns,
                     100 * skipped_share(figures.ticks, figures.overruns));
}

LoopFigures figures_of(const JitterReport& report) {
  return {.what = report.realtime.fifo() ? "lateness with SCHED_FIFO" : "lateness without SCHED_FIFO",
          .fifo = report.realtime.fifo(),
          .p99_us = report.lateness.percentile_us(0.99),
          .largest_us = report.lateness.largest_us(),
          .ticks = report.ticks,
          .overruns = report.overruns};
}

}  // namespace

std::string jitter_text(const JitterReport& report) {
  return fmt::format("p50 {:.0f} us, {}", report.lateness.percentile_us(0.50), loop_text(figures_of(report)));
}

std::string loop_advice(bool fifo) {
  return fifo ? "end other programs, switch power saving off in the firmware, or install a kernel with PREEMPT_RT"
              : "allow SCHED_FIFO (see above) and end other programs";
}

Check judge_loop(const LoopFigures& figures) {
  Check check{.what = figures.what, .verdict = Verdict::ok, .found = loop_text(figures), .what_to_do = ""};
  const double skipped = skipped_share(figures.ticks, figures.overruns);
  if (figures.largest_us >= kUnfitLoop.largest_us) {
    check.verdict = Verdict::bad;
    check.found +=
        fmt::format(": in a session, which is longer, some ticks will be {:.0f} ms late, which voids a trial",
                    1e-3 * kGapLateness_us);
  } else if (figures.p99_us >= kUnfitLoop.p99_us || skipped >= kUnfitLoop.skipped_share) {
    check.verdict = Verdict::bad;
    check.found += ": one tick in a hundred is lost";
  } else if (figures.p99_us > kTightLoop.p99_us || figures.largest_us > kTightLoop.largest_us ||
             skipped > kTightLoop.skipped_share) {
    check.verdict = Verdict::warn;
  }
  if (check.verdict != Verdict::ok) check.what_to_do = loop_advice(figures.fifo);
  return check;
}

Check judge_jitter(const JitterReport& report) {
  const LoopFigures figures = figures_of(report);
  if (report.ticks == 0)
    return {.what = figures.what,
            .verdict = Verdict::warn,
            .found = "not measured",
            .what_to_do = "let the measurement run to its end"};
  Check check = judge_loop(figures);
  check.found = fmt::format("p50 {:.0f} us, {}", report.lateness.percentile_us(0.50), check.found);
  return check;
}

// Where studies go: the file system, its free space, and how long it takes to promise that a trial is saved.

namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "study folder";

Check bad(std::string found, std::string what_to_do) {
  return {.what = kName, .verdict = Verdict::bad, .found = std::move(found), .what_to_do = std::move(what_to_do)};
}

// The type of the mount that holds `folder`: that with the longest mount point, the later of equals (it covers the
// other). proc_pid_mountinfo(5): ... mount point is field 5, the type the first after " - ".
std::string mount_type(const fs::path& mountinfo, const fs::path& folder) {
  std::ifstream file(mountinfo);
  std::string type, best;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string point;
    for (int field = 0; field < 5; ++field) words >> point;
    for (std::size_t at = 0; (at = point.find("\\040", at)) != std::string::npos;) point.replace(at, 4, 1, ' ');
    const auto separator = line.find(" - ");
    if (separator == std::string::npos || point.size() < best.size()) continue;
    const std::string path = folder.string();
    const bool holds =
        path.starts_with(point) && (point.ends_with('/') || path.size() == point.size() || path[point.size()] == '/');
    if (!holds) continue;
    best = point;
    type = line.substr(separator + 3, line.find(' ', separator + 3) - separator - 3);
  }
  return type;
}

// Seconds that each of so many writes of 4 kB took to be on the disk; empty, with errno, where the folder cannot be
// written.
std::vector<double> time_syncs(const fs::path& folder, int syncs) {
  std::string name = (folder / ".jnd-doctor-XXXXXX").string();
  const int file = mkstemp(name.data());
  if (file < 0) return {};
  unlink(name.c_str());
  const std::string block(4096, 'x');
  std::vector<double> seconds;
  int error = 0;
  for (int i = 0; i < syncs && error == 0; ++i) {
    const auto began = std::chrono::steady_clock::now();
    errno = 0;
    if (write(file, block.data(), block.size()) != static_cast<ssize_t>(block.size()) || fsync(file) != 0)
      error = errno == 0 ? EIO : errno;
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
  }
  close(file);
  if (error != 0) {
    errno = error;
    return {};
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds;
}

std::string bytes_text(double bytes) {
  return bytes >= 1e9 ? fmt::format("{:.0f} GB", bytes / 1e9) : fmt::format("{:.0f} MB", bytes / 1e6);
}

}  // namespace

Check judge_storage(const StorageFigures& figures) {
  Check check{.what = kName, .verdict = Verdict::ok};
  check.found = fmt::format("{} ({}), {} free, saving a trial takes {:.1f} ms (longest {:.1f} ms)", figures.folder,
                            figures.type.empty() ? "type of file system not readable" : figures.type,
                            bytes_text(figures.free_bytes), 1e3 * figures.sync_median_s, 1e3 * figures.sync_max_s);
  const auto complain = [&](Verdict verdict, const char* why, const std::string& what_to_do) {
    check.found += why;
    check.verdict = std::max(check.verdict, verdict);
    if (!check.what_to_do.empty()) check.what_to_do += "; ";
    check.what_to_do += what_to_do;
  };
  const Verdict unsafe = figures.real ? Verdict::bad : Verdict::warn;
  if (figures.network)
    complain(unsafe, "; a network file system cannot promise that an answer is saved, real sessions are refused",
             "keep studies on a local disk (--study FOLDER checks another place)");
  if (figures.type == "fuse" || figures.type.starts_with("fuse."))
    complain(unsafe, "; a file system of another program (sshfs, a cloud drive) may promise what it does not keep",
             "keep studies on a local disk");
  if (figures.type == "tmpfs" || figures.type == "ramfs" || figures.type == "devtmpfs")
    complain(unsafe, "; this is memory: everything in it is lost when the machine stops", "keep studies on a disk");
  if (figures.needed_bytes > 0) check.found += fmt::format(", a session needs {}", bytes_text(figures.needed_bytes));
  const std::string free_more = fmt::format("free at least {}", bytes_text(kFewBytes + figures.needed_bytes));
  if (figures.free_bytes < kTooFewBytes + figures.needed_bytes)
    complain(Verdict::bad, "; too little space for a session", free_more);
  else if (figures.free_bytes < kFewBytes + figures.needed_bytes)
    complain(Verdict::warn, "; little space", free_more);
  if (figures.sync_median_s >= kTooSlowSync_s)
    complain(Verdict::bad, "; participants would wait for the disk after every answer", "use another disk");
  else if (figures.sync_median_s >= kSlowSync_s || figures.sync_max_s >= kTooSlowSync_s)
    complain(Verdict::warn, "; a slow disk", "end programs that write to it, or use another disk");
  return check;
}

Check check_storage(const fs::path& folder_or_file, const StorageProbe& probe) {
  std::error_code error;
  fs::path folder = folder_or_file.empty() ? fs::path(".") : folder_or_file;
  if (!fs::is_directory(folder, error)) folder = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
  const fs::path resolved = fs::canonical(folder, error);
  if (error || !fs::is_directory(resolved, error))
    return bad(fmt::format("{}: there is no such folder", folder.string()), "make it, or name another with --study");
  folder = resolved;

  struct statfs status {};
  struct statvfs space {};
  if (::statfs(folder.c_str(), &status) != 0 || ::statvfs(folder.c_str(), &space) != 0)
    return bad(fmt::format("{}: {}", folder.string(), std::system_category().message(errno)), "use another folder");
  StorageFigures figures{.folder = folder.string(),
                         .type = mount_type(probe.root / "proc/self/mountinfo", folder),
                         .network = probe.is_network && probe.is_network(static_cast<long>(status.f_type)),
                         .free_bytes = static_cast<double>(space.f_bavail) * static_cast<double>(space.f_frsize),
                         .sync_median_s = 0,
                         .sync_max_s = 0,
                         .real = probe.real,
                         .needed_bytes = probe.needed_bytes};
  const std::vector<double> syncs = time_syncs(folder, std::max(probe.syncs, 1));
  if (syncs.empty()) {
    const FileTrouble trouble = file_trouble(folder / ".jnd-doctor", errno, FileUse::write);
    return bad(fmt::format("{}: cannot be written: {}", folder.string(), trouble.why),
               trouble.what_to_do + "; or name another with --study");
  }
  figures.sync_median_s = syncs[syncs.size() / 2];
  figures.sync_max_s = syncs.back();
  return judge_storage(figures);
}

RehearsalReport probe_rehearsal(Rig& rig, const Stimulus& stimulus, double seconds, const std::atomic<bool>& stop) {
  constexpr double kExplore_s = 0.5, kNoContact_s = 5;
  RehearsalReport report;
  report.realtime = rig.realtime();
  rig.watch([&](const LoopSnapshot&) {
    if (stop) rig.stop.latch(StopSource::program);
  });
  const SteadyClock clock;
  const std::int64_t end_ns = clock.now_ns() + static_cast<std::int64_t>(seconds * 1e9);
  do {
    PresentRequest request;
    request.stimulus = stimulus;
    request.explore_s = kExplore_s;
    request.no_contact_time_out_s = kNoContact_s;
    request.id.trial = report.presentations + 1;
    const Presentation given = rig.present(request);
    if (stop) break;
    ++report.presentations;
    report.presented_s += given.duration_s;
    report.ticks += given.ticks;
    report.overruns += given.overruns;
    report.p99_us = std::max(report.p99_us, given.lateness_p99_us);
    report.largest_us = std::max(report.largest_us, given.lateness_max_us);
    if (given.fault == Fault::command_gap)
      ++report.gaps;
    else if (given.fault != Fault::none)
      report.fault = to_string(given.fault);
  } while (report.fault.empty() && clock.now_ns() < end_ns);
  rig.watch({});
  rig.neutral();
  return report;
}

std::optional<double> lost_trials(const RehearsalReport& report, double trial_s) {
  if (!(report.presented_s > 0)) return std::nullopt;
  return -std::expm1(-report.gaps / report.presented_s * trial_s);
}

Check judge_rehearsal(const RehearsalReport& report, double trial_s) {
  if (report.presentations == 0)
    return {.what = "rehearsal",
            .verdict = Verdict::warn,
            .found = "not measured",
            .what_to_do = "let the measurement run to its end"};
  Check check = judge_loop({.what = "rehearsal",
                            .fifo = report.realtime.fifo(),
                            .p99_us = report.p99_us,
                            .largest_us = report.largest_us,
                            .ticks = report.ticks,
                            .overruns = report.overruns});
  std::string lost = fmt::format("{} of {} presentation{} lost to a gap between commands", report.gaps,
                                 report.presentations, report.presentations == 1 ? "" : "s");
  // Of none in some seconds nobody can tell how few would be lost in a session.
  if (const std::optional<double> share = lost_trials(report, trial_s); share && report.gaps > 0)
    lost += fmt::format(" (at this rate some {:.0f} of 100 trials, which present for {:.3g} s each)", 100 * *share,
                        trial_s);
  check.found = fmt::format("{}, in real time on a simulated rig; {}", lost, check.found);
  if (report.gaps > 0) {
    check.verdict = Verdict::bad;
    check.what_to_do = loop_advice(report.realtime.fifo());
  }
  if (!report.fault.empty()) {
    check.verdict = Verdict::bad;
    check.found += fmt::format("; ended by {}", report.fault);
    check.what_to_do = "a simulated rig has no such faults: please report this, with what jnd --version says";
  }
  return check;
}

}  // namespace jnd
