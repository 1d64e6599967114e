// jnd doctor: is this machine fit to run a session.
#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "data/study/database.h"
#include "devices/hid/hidapi_bus.h"
#include "devices/hid/link/hid_rig.h"
#include "devices/hid/link/rig_check.h"
#include "devices/machine/machine_checks.h"
#include "devices/rigs/rig_factory.h"
#include "protocols/course/duration.h"
#include "protocols/input/resources.h"
#include "protocols/reading/protocol_json.h"
#include "runner/device_commands/device_commands.h"
#include "runner/device_commands/hid_devices.h"
#include "runner/keys/interrupt.h"
#include "runner/opening/asked_rig.h"
#include "runner/opening/study_access.h"
#include "runner/sound/player.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

struct DoctorOptions {
  std::optional<std::string> study;  // a study, or the folder where studies go; where not given, this folder
  double seconds = 3;                // of each measurement
  std::string protocol, rig;         // to be fit for: a protocol's file or shipped name, a rig file; empty: none
  bool json = false;
};

JitterReport measure(RealtimePolicy policy, double seconds) {
  const WorkLine working(fmt::format("measuring for {:g} s how late a loop of 1 ms wakes{}", seconds,
                                     policy == RealtimePolicy::off ? ", without SCHED_FIFO" : ""));
  return probe_jitter_on_thread(policy, seconds, interrupt_requested());
}

// What is rehearsed: the protocol that was named, or a shipped one where none was, or it has no trials, or its rig is
// not one of the program's own.
Protocol rehearsed_protocol(const DoctorOptions& options) {
  constexpr const char* kShipped = "tutorial";
  Protocol protocol = load_checked_protocol(options.protocol.empty() ? kShipped : options.protocol);
  return protocol.rig.built_in() && !protocol.explore ? protocol : load_checked_protocol(kShipped);
}

// On simulated devices, by the loop that sessions run.
RehearsalReport rehearse(const Protocol& protocol, double seconds) {
  const WorkLine working(fmt::format("rehearsing for {:g} s on a simulated rig", seconds));
  const RigDescription description = rig_of(protocol);
  const ParticipantProfile profile = load_profile(find_resource(Resource::profile, default_profile(protocol)));
  SteadyClock clock;
  RigOptions how;
  how.realtime = RealtimePolicy::prefer;
  const std::unique_ptr<Rig> rig = make_simulated_rig(protocol, description, profile, 1, 1, clock, how);
  return probe_rehearsal(*rig, {.stiffness = protocol.stimulus.reference, .cues = protocol.conditions.front().cues},
                         seconds, interrupt_requested());
}

// Nulls where nothing was measured.
nlohmann::ordered_json rehearsal_json(const RehearsalReport& report, double trial_s) {
  const std::optional<double> lost = lost_trials(report, trial_s);
  return {{"presentations", report.presentations},
          {"gaps", report.gaps},
          {"presented_s", json_number(report.presented_s)},
          {"trial_s", json_number(trial_s)},
          {"lost_trials", lost ? json_number(*lost) : nlohmann::ordered_json(nullptr)},
          {"p99_us", json_number(report.p99_us)},
          {"max_us", json_number(report.largest_us)},
          {"ticks", report.ticks},
          {"overruns", report.overruns}};
}

nlohmann::ordered_json jitter_json(const JitterReport& report) {
  return {{"scheduling", report.realtime.fifo() ? fmt::format("SCHED_FIFO {}", kRealtimePriority) : "ordinary"},
          {"p50_us", json_number(report.lateness.percentile_us(0.50))},
          {"p99_us", json_number(report.lateness.percentile_us(0.99))},
          {"max_us", json_number(report.lateness.largest_us())},
          {"ticks", report.ticks},
          {"overruns", report.overruns}};
}

// Broken between words to the terminal's width, further lines indented. Whole where there is no terminal.
std::string wrapped(const std::string& text, std::size_t indent) {
  if (!is_terminal(STDOUT_FILENO)) return text;
  constexpr int kNarrowest = 20;
  const int width = std::max(terminal_width() - 1 - static_cast<int>(indent), kNarrowest);
  return fmt::format("{}",
                     fmt::join(wrapped_words(text, static_cast<std::size_t>(width)), "\n" + std::string(indent, ' ')));
}

std::string mark(Verdict verdict) {
  switch (verdict) {
    case Verdict::ok:
      return "ok  ";
    case Verdict::warn:
      return warn("warn");
    case Verdict::bad:
      return bold(warn("BAD "));
    case Verdict::not_judged:
      return "    ";
  }
  return "    ";
}

void print_check(const Check& check, std::size_t name_width) {
  constexpr std::size_t kMarkWidth = 8;  // two spaces, the mark, two spaces
  const std::size_t indent = kMarkWidth + name_width + 2;
  fmt::print("  {}  {}{}  {}\n", mark(check.verdict), check.what,
             std::string(name_width - display_width(check.what), ' '), wrapped(printable(check.found), indent));
  if (!check.what_to_do.empty())
    fmt::print("{}{} {}\n", std::string(indent, ' '), dim("->"), wrapped(printable(check.what_to_do), indent + 3));
}

// A laboratory's own rig, and whether it can present what the protocol asks.
Checks check_external_rig(const ExternalSettings& settings, const Protocol* protocol) {
  AskedRig asked = ask_external_rig(settings, protocol);
  if (protocol != nullptr && asked.problems.empty())
    asked.checks.push_back({.what = "protocol", .verdict = Verdict::ok, .found = "the rig can present what it asks"});
  for (std::string& problem : asked.problems)
    asked.checks.push_back({.what = "protocol",
                            .verdict = Verdict::bad,
                            .found = std::move(problem),
                            .what_to_do = "change the protocol, or take another rig"});
  for (std::string& caution : asked.cautions)
    asked.checks.push_back({.what = "protocol", .verdict = Verdict::warn, .found = std::move(caution)});
  for (Check& check : asked.checks) check.what = "external rig: " + check.what;
  return std::move(asked.checks);
}

// What the protocol and the rig file need of this machine.
Checks check_rig_of(const DoctorOptions& options) {
  std::optional<Protocol> protocol;
  std::optional<RigFile> file;
  if (!options.protocol.empty()) protocol = load_checked_protocol(options.protocol);
  if (!options.rig.empty()) file = load_rig_file(options.rig);
  if (!protocol && !file) return {};
  if (file && file->external) return check_external_rig(*file->external, protocol ? &*protocol : nullptr);
  std::vector<SeenHid> seen;
  const std::unique_ptr<HidBus> bus = make_bus(file ? socket_devices(*file, false) : std::vector<SocketDevice>{});
  for (const HidInfo& info : bus->list()) seen.push_back({.info = info, .usable = is_usable(info)});
  return check_rig(protocol ? &protocol->rig : nullptr, file ? &*file : nullptr, seen);
}

int command_doctor(const DoctorOptions& options) {
  const HoldInterrupts hold;
  Checks checks = {check_kernel("/"), check_processors("/"), check_frequency("/"), check_clock_source("/"),
                   check_hid("/")};
  checks.push_back(check_sound());
  for (Check& check : check_rig_of(options)) checks.push_back(std::move(check));
  checks.push_back(
      check_storage(options.study.value_or("."), {.root = "/", .is_network = is_network_file_system, .syncs = 20}));
  const JitterReport session = measure(RealtimePolicy::prefer, options.seconds);
  const bool compare = session.realtime.fifo();
  const JitterReport ordinary = compare ? measure(RealtimePolicy::off, options.seconds) : JitterReport{};
  if (interrupt_requested()) throw Stopped();
  const Protocol protocol = rehearsed_protocol(options);
  const double trial_s = expected_presented_s(protocol);
  const RehearsalReport rehearsal = rehearse(protocol, options.seconds);
  if (interrupt_requested()) throw Stopped();
  for (Check& check : check_realtime(session.realtime)) checks.push_back(std::move(check));
  checks.push_back(judge_jitter(session));
  // For comparison, and no finding of its own: a session does not run so.
  if (compare) checks.back().found += "; without SCHED_FIFO: " + jitter_text(ordinary);
  checks.push_back(judge_rehearsal(rehearsal, trial_s));

  int bad = 0, warnings = 0;
  std::size_t name_width = 0;
  for (const Check& check : checks) {
    bad += check.verdict == Verdict::bad ? 1 : 0;
    warnings += check.verdict == Verdict::warn ? 1 : 0;
    name_width = std::max(name_width, display_width(check.what));
  }
  const int code = bad > 0 ? exit_code::kProblemFound : exit_code::kDone;
  if (options.json) {
    nlohmann::ordered_json out = {{"ok", bad == 0}, {"checks", nlohmann::ordered_json::array()}};
    for (const Check& check : checks)
      out["checks"].push_back({{"name", check.what},
                               {"verdict", to_string(check.verdict)},
                               {"found", check.found},
                               {"what_to_do", check.what_to_do}});
    out["jitter"] = jitter_json(session);
    out["jitter"]["without_fifo"] = compare ? jitter_json(ordinary) : nlohmann::ordered_json(nullptr);
    out["rehearsal"] = rehearsal_json(rehearsal, trial_s);
    print_json(out);
    return code;
  }
  for (const Check& check : checks) print_check(check, name_width);
  if (bad > 0)
    fmt::print("\n{}\n", bold(fmt::format("not fit for a real session: {} problem{} (BAD)", bad, bad == 1 ? "" : "s")));
  else if (warnings > 0)
    fmt::print("\n{}\n",
               bold(fmt::format("fit to run a session, with {} warning{}", warnings, warnings == 1 ? "" : "s")));
  else
    fmt::print("\n{}\n", bold("fit to run a session"));
  return code;
}

}  // namespace

void add_doctor(CommandTree& program) {
  const auto [command, options] =
      program.add("doctor", "Is this machine fit to run a session", "jnd doctor --study studies", command_doctor);
  command.add_option("--study", options.study, "a study, or the folder where studies go (default: this folder)");
  command
      .add_option("--seconds", options.seconds,
                  "length of each of the measurements: two of lateness, and the rehearsal (default: 3)")
      .range(0.1, 600.0);
  command.add_option("--protocol", options.protocol, "is the machine fit for this one too: has it the tracker");
  command.add_option("--rig", options.rig, "and for this rig file: are its devices, tracker and buttons there");
  command.add_flag("--json", options.json, "machine-readable");
}

}  // namespace jnd
