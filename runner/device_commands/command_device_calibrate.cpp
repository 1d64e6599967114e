// jnd device calibrate: known forces against what the device measures, a certificate, and a table in the device.
#include <filesystem>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "devices/hid/calibration/calibration_bench.h"
#include "devices/hid/calibration/calibration_certificate.h"
#include "devices/hid/report_words.h"
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "protocols/version.h"
#include "runner/device_commands/device_commands.h"
#include "runner/device_commands/device_output.h"
#include "runner/device_commands/hid_devices.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

// Thread rule: one thread, the only one that reads standard input meanwhile.
class TypingOperator final : public CalibrationOperator {
 public:
  void ask(const std::string& question) override;
  std::optional<std::string> answer() override;
  void say(const std::string& text) override;

 private:
  std::string typed_;  // of the line that is not complete
};

void TypingOperator::ask(const std::string& question) {
  print_message("{}: ", printable(question));
}

void TypingOperator::say(const std::string& text) {
  print_message("  {}\n", printable(text));
}

std::optional<std::string> TypingOperator::answer() {
  pollfd ready{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  while (poll(&ready, 1, 0) > 0) {
    char character = 0;
    const ssize_t got = ::read(STDIN_FILENO, &character, 1);
    if (got != 1) throw InputError("calibration: the input ended before the last point; nothing was changed");
    if (character == '\n') {
      std::string line;
      line.swap(typed_);
      return line;
    }
    typed_ += character;
  }
  return std::nullopt;
}

struct DeviceCalibrateOptions {
  std::string name;                       // serial number or path
  std::string rig_file;                   // whose devices that are programs are looked for too; empty: none
  std::string reference = "interactive";  // or a CSV file: known_n, and pushed_n where the device presses the reference
  std::vector<double> push_n;             // forces to press the reference with, each read from it and typed
  std::string operator_name, reference_name, remarks;
  std::string out;  // of the certificate; named by serial, date and id in this folder where empty
  bool no_stiffness = false, store = false, yes = false, json = false;
};

struct CalibrationPlan {
  std::vector<CalibrationStep> steps;
  bool open_ended = false;
  std::vector<double> stiffness_n_per_m;

  bool presses() const {
    for (const CalibrationStep& step : steps)
      if (step.pushed_n > 0) return true;
    return !stiffness_n_per_m.empty();
  }
};

CalibrationPlan plan_of(const DeviceCalibrateOptions& options) {
  CalibrationPlan plan;
  if (!options.no_stiffness) plan.stiffness_n_per_m = {500, 700, 900};
  if (options.reference != "interactive") {
    if (!options.push_n.empty())
      throw UsageError("--push is for --reference interactive: a file has a column pushed_n for it");
    const CsvTable table = CsvTable::read(options.reference, {"known_n"}, {"pushed_n"});
    for (std::size_t row = 0; row < table.rows(); ++row) {
      CalibrationStep step{.known_n = table.number(row, "known_n", {.min = 0, .max = 100}), .pushed_n = 0};
      if (table.has("pushed_n")) step.pushed_n = table.number(row, "pushed_n", {.min = 0, .max = 100});
      plan.steps.push_back(step);
    }
    if (plan.steps.size() < 3) throw InputError(options.reference + ": fewer than three points: give at least three");
    return plan;
  }
  for (const double force : options.push_n) {
    if (!(force > 0)) throw UsageError("--push: forces above 0 N, such as 0.5,1.5,3,4,3,1.5,0.5");
    plan.steps.push_back({.known_n = std::nullopt, .pushed_n = force});
  }
  if (!plan.steps.empty() && plan.steps.size() < 3) throw UsageError("--push: at least three forces");
  plan.open_ended = plan.steps.empty();
  return plan;
}

void check_plan(const CalibrationPlan& plan, const DeviceDescription& device, const std::string& name, bool store) {
  const double most_n = 1e-6 * device.limits.most_force_un;
  for (const CalibrationStep& step : plan.steps)
    if (step.pushed_n > most_n)
      throw InputError(fmt::format("{}: presses with at most {:g} N, not {:g} N", name, most_n, step.pushed_n));
  if (store && (device.identity.capabilities & JND_CAN_STORE_CALIBRATION) == 0)
    throw DeviceError(fmt::format("{}: cannot keep a calibration; leave out --store", name));
}

// On the device's thread: everything that is measured.
CalibrationRecord measure(HidHandle& handle, const DeviceCalibrateOptions& options, const CalibrationPlan& plan) {
  const DeviceDescription device = describe(handle, options.name);
  refuse_if_driven(device, options.name);
  check_plan(plan, device, options.name, options.store);
  CalibrationRecord record;
  record.identity = device.identity;
  record.limits = device.limits;
  record.program = kVersion;
  record.operator_name = options.operator_name;
  record.reference = options.reference_name;
  record.remarks = options.remarks;
  record.former_table = from_report(device.table);
  SteadyClock clock;
  TypingOperator person;
  const double full_scale_n = 1e-6 * device.limits.most_force_un;
  BenchLink link(handle, clock, spec_of(device.limits, device.geometry, full_scale_n), interrupt_requested());
  record.force = take_forces(link, record.former_table, plan.steps, plan.open_ended, person);
  std::vector<ForcePoint> points;
  for (const ForceRecord& one : record.force) points.push_back(one.point);
  record.fit = fit_force(points);
  for (const double stiffness : plan.stiffness_n_per_m) {
    person.say(fmt::format("rendering {:g} N/m at five depths", stiffness));
    record.stiffness.push_back(take_stiffness(link, record.former_table, record.fit.table, stiffness, full_scale_n));
  }
  record.utc_ns = clock.utc_ns();
  return record;
}

std::string file_name(const DeviceCalibrateOptions& options, const nlohmann::ordered_json& certificate) {
  if (!options.out.empty()) return options.out;
  return fmt::format("{}-{}-{}.json", certificate["device"]["serial"].get<std::string>(),
                     certificate["date"].get<std::string>(), certificate["id"].get<std::string>());
}

void print_findings(const CalibrationRecord& record, const std::vector<CalibrationFinding>& findings) {
  using Align = TextTable::Align;
  TextTable points({"known (N)", "sensor (N)", "SD (N)", "residual (N)"},
                   {Align::right, Align::right, Align::right, Align::right});
  for (std::size_t i = 0; i < record.force.size(); ++i)
    points.add(
        {fmt::format("{:.3f}", record.force[i].point.known_n), fmt::format("{:.4f}", record.force[i].point.sensor.mean),
         fmt::format("{:.4f}", record.force[i].point.sensor.sd), fmt::format("{:+.4f}", record.fit.residuals_n[i])});
  TextTable verdict({"verdict", "measured", "limit", ""}, {Align::left, Align::right, Align::right, Align::left});
  for (const CalibrationFinding& finding : findings)
    verdict.add({finding.what, fmt::format("{:.4g} {}", finding.value, finding.unit),
                 fmt::format("{:.4g} {}", finding.limit, finding.unit), finding.ok ? "ok" : bold(warn("FAILED"))});
  fmt::print("{}\n  table of {} points\n\n{}\n  limits: {}\n", points.text(), record.fit.table.sensor_n.size(),
             verdict.text(), calibration_limits_source());
}

int command_device_calibrate(const DeviceCalibrateOptions& options) {
  const HoldInterrupts hold;
  const CalibrationPlan plan = plan_of(options);
  std::error_code error;
  if (!options.out.empty() && std::filesystem::exists(options.out, error))
    throw UsageError(fmt::format("{} exists already; choose another name", options.out));
  const std::unique_ptr<HidBus> found_on = bus_for(options.name, options.rig_file);
  HidBus& bus = *found_on;
  const HidInfo info = find_device(bus, options.name);
  if (is_tracker(info)) throw UsageError(fmt::format("{} is a tracker: it has no force to calibrate", options.name));
  if (plan.presses() &&
      !may_press(fmt::format("{} will press with up to its largest force. Put the reference before its platform, and "
                             "let nobody wear it.",
                             printable(options.name)),
                 options.yes, true))
    return exit_code::kInterrupted;
  CalibrationRecord record;
  try {
    with_device(bus, info, [&](HidHandle& handle) { record = measure(handle, options, plan); });
  } catch (const BenchInterrupted& interrupted) {
    print_message("{}: {}; its calibration is as it was\n", printable(options.name), interrupted.what());
    return exit_code::kInterrupted;
  }
  const std::vector<CalibrationFinding> findings = findings_of(record);
  const nlohmann::ordered_json certificate = certificate_of(record);
  const std::string file = file_name(options, certificate);
  (void)write_csv({.json = false, .csv = file}, json_line(certificate) + "\n");  // a new file, whole or none
  const bool good = passed(findings);
  if (options.store && good)
    with_device(bus, info, [&](HidHandle& handle) {
      PageExchange pages(handle, options.name);
      store_calibration(pages, record.fit.table, stored_certificate(certificate));
    });
  if (options.json) {
    print_json(certificate);
  } else {
    print_findings(record, findings);
    fmt::print("\n  certificate {}: {}\n", certificate["id"].get<std::string>(), printable(file));
    if (!options.store)
      fmt::print("  The device is as it was: --store writes table and certificate into it.\n");
    else if (good)
      fmt::print("  Table and certificate are in the device, read back and compared.\n");
    fmt::print("{}\n", bold(good ? "passed" : "NOT PASSED: the device keeps its former calibration"));
  }
  return good ? exit_code::kDone : exit_code::kDevice;
}

}  // namespace

void add_device_calibrate(CommandTree& device) {
  const auto [command, options] =
      device.add("calibrate", "Calibrate a connected device's force, and check its stiffness",
                 "jnd device calibrate FT-0001 --operator \"A. Smith\" --reference-name \"scale 17\" --push 1,2,4,2,1\n"
                 "  jnd device calibrate FT-0001 --operator \"A. Smith\" --reference-name \"weights\" "
                 "--reference points.csv --store",
                 command_device_calibrate);
  command.add_option("DEVICE", options.name, "a serial number or a path, as jnd device list shows them").required();
  command.add_option("--rig", options.rig_file, "a rig file: its devices that are programs are looked for too");
  command.add_option("--reference", options.reference,
                     "interactive: known forces are typed; or a CSV file of them: known_n (N), and pushed_n (N) where "
                     "the device presses the reference (default: interactive)");
  command
      .add_option("--push", options.push_n,
                  "N1,N2,...: forces with which the device presses the reference; what that shows is typed")
      .delimiter(',')
      .check(not_finite);
  command.add_option("--operator", options.operator_name, "who calibrates").required();
  command.add_option("--reference-name", options.reference_name, "which scale or weights, such as an inventory number")
      .required();
  command.add_option("--remarks", options.remarks, "anything that should stand in the certificate");
  command.add_option("--out", options.out, "the certificate's file (default: SERIAL-DATE-ID.json in this folder)");
  command.add_flag("--no-stiffness", options.no_stiffness, "leave the check of 500, 700 and 900 N/m out");
  command.add_flag("--store", options.store, "write table and certificate into the device, where it passes");
  command.add_flag("--yes", options.yes, "the device may press without being asked for");
  command.add_flag("--json", options.json, "print the certificate");
}

}  // namespace jnd
