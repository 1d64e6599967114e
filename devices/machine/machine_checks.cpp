#include "devices/machine/machine_checks.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "devices/loop/loop_limits.h"

namespace jnd {

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

std::string_view to_string(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::ok:
      return "ok";
    case Verdict::warn:
      return "warn";
    case Verdict::bad:
      return "bad";
  }
  return "bad";
}

MachineCheck check_kernel(const fs::path& root) {
  MachineCheck check{.name = "kernel", .verdict = Verdict::ok, .found = "", .what_to_do = ""};
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

MachineCheck check_processors(const fs::path& root) {
  MachineCheck check{.name = "processors", .verdict = Verdict::ok, .found = "", .what_to_do = ""};
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

MachineCheck check_frequency(const fs::path& root) {
  MachineCheck check{.name = "processor frequency", .verdict = Verdict::ok, .found = "", .what_to_do = ""};
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

MachineCheck check_clock_source(const fs::path& root) {
  MachineCheck check{.name = "clock source", .verdict = Verdict::ok, .found = "", .what_to_do = ""};
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

std::vector<MachineCheck> check_realtime(const RealtimeReport& report) {
  std::vector<MachineCheck> checks;
  for (const RealtimeItem& item : report.items)
    checks.push_back({.name = item.what,
                      .verdict = item.ok ? Verdict::ok : Verdict::warn,
                      .found = item.ok ? item.detail : fmt::format("{} ({})", item.detail, item.why_not),
                      .what_to_do = item.ok ? "" : item.what_to_do});
  return checks;
}

std::string jitter_text(const JitterReport& report) {
  const LatenessHistogram& lateness = report.lateness;
  return fmt::format("p50 {:.0f} us, p99 {:.0f} us, largest {:.0f} us over {} ticks of 1 ms, {} skipped ({:.2g} %)",
                     lateness.percentile_us(0.50), lateness.percentile_us(0.99), lateness.largest_us(), report.ticks,
                     report.overruns, 100 * skipped_share(report.ticks, report.overruns));
}

MachineCheck judge_jitter(const JitterReport& report) {
  MachineCheck check{.name = report.realtime.fifo() ? "lateness with SCHED_FIFO" : "lateness without SCHED_FIFO",
                     .verdict = Verdict::ok,
                     .found = jitter_text(report),
                     .what_to_do = ""};
  if (report.ticks == 0) {
    check.verdict = Verdict::warn;
    check.found = "not measured";
    check.what_to_do = "let the measurement run to its end";
    return check;
  }
  const double p99_us = report.lateness.percentile_us(0.99), largest_us = report.lateness.largest_us();
  const double skipped = skipped_share(report.ticks, report.overruns);
  if (largest_us >= kUnfitLoop.largest_us) {
    check.verdict = Verdict::bad;
    check.found +=
        fmt::format(": in a session, which is longer, some ticks will be {:.0f} ms late, which voids a trial",
                    1e-3 * kGapLateness_us);
  } else if (p99_us >= kUnfitLoop.p99_us || skipped >= kUnfitLoop.skipped_share) {
    check.verdict = Verdict::bad;
    check.found += ": one tick in a hundred is lost";
  } else if (p99_us > kTightLoop.p99_us || largest_us > kTightLoop.largest_us || skipped > kTightLoop.skipped_share) {
    check.verdict = Verdict::warn;
  }
  if (check.verdict != Verdict::ok)
    check.what_to_do =
        report.realtime.fifo()
            ? "end other programs, switch power saving off in the firmware, or install a kernel with PREEMPT_RT"
            : "allow SCHED_FIFO (see above) and end other programs";
  return check;
}

}  // namespace jnd
