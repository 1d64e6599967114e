// jnd device stiffness: what a device renders of the stiffness that is asked of it.
#include <algorithm>

#include <fmt/format.h>

#include "data/fields/csv_writer.h"
#include "devices/mckibben/mckibben_response.h"
#include "devices/rrs3/rrs3_rendering.h"
#include "runner/device_commands/device_commands.h"
#include "runner/device_commands/device_output.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/plot.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

struct Rrs3StiffnessOptions {
  std::string spec = "rrs3";
  std::vector<double> stiffness_n_per_m;
  RenderingMode mode = RenderingMode::wrench;
  double finger_n_per_m = 1000;
  double roll_rad = 0, pitch_rad = 0;
  DeviceOutput output;
};

struct MckibbenStiffnessOptions {
  std::string spec = "mckibben";
  std::vector<double> stiffness_n_per_rad;
  std::optional<double> kp, ki, kd;  // where none is given: the paper's P, and the device's own control
  std::optional<Tendon> tendon;      // the device's own where not given
  double frequency_hz = 0.5;
  DeviceOutput output;
};

int command_device_stiffness_rrs3(const Rrs3StiffnessOptions& options) {
  const DeviceSpec spec = device_named(options.spec, DeviceModel::rrs3);
  std::string csv = "mode,asked_n_per_m,depth_m,force_n\n";
  std::vector<nlohmann::ordered_json> rows;
  std::vector<PlotSeries> series;
  using Align = TextTable::Align;
  TextTable table({"asked (N/m)", "rendered (N/m)", "expected (N/m)", "rendered / asked"},
                  {Align::right, Align::right, Align::right, Align::right});
  for (const double asked : options.stiffness_n_per_m) {
    const Rrs3StiffnessAnswer answer = measure_rendered_stiffness(spec, {.stiffness_n_per_m = asked,
                                                                         .mode = options.mode,
                                                                         .finger_n_per_m = options.finger_n_per_m,
                                                                         .roll_rad = options.roll_rad,
                                                                         .pitch_rad = options.pitch_rad});
    PlotSeries curve{.name = fmt::format("{:g} N/m asked", asked), .x = {0}, .y = {0}};
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    for (const DepthAndForce& point : answer.curve) {
      csv += csv_line({std::string(to_string(answer.mode)), csv_number(asked), csv_number(point.depth_m),
                       csv_number(point.force_n)});
      points.push_back({json_number(point.depth_m), json_number(point.force_n)});
      curve.x.push_back(1e3 * point.depth_m);
      curve.y.push_back(point.force_n);
    }
    rows.push_back({{"mode", to_string(answer.mode)},
                    {"asked", answer.asked_n_per_m},
                    {"rendered", json_number(answer.rendered_n_per_m)},
                    {"expected", json_number(answer.expected_n_per_m)},
                    {"finger", options.finger_n_per_m},
                    {"curve", points}});
    table.add({fmt::format("{:g}", asked), fmt::format("{:.2f}", answer.rendered_n_per_m),
               fmt::format("{:.2f}", answer.expected_n_per_m),
               fmt::format("{:.4f}", answer.rendered_n_per_m / answer.asked_n_per_m)});
    series.push_back(std::move(curve));
  }
  if (write_csv(options.output, csv)) return exit_code::kDone;
  if (options.output.json) {
    for (const auto& row : rows) print_json(row);
    return exit_code::kDone;
  }
  fmt::print("{}: mode {}, against a finger of {:g} N/m\n\n", bold("rendered stiffness"), to_string(options.mode),
             options.finger_n_per_m);
  fmt::print(
      "{}\n{}",
      line_plot(series,
                {.x_label = "depth in the virtual surface (mm)", .y_label = "force (N)", .rows = 12, .from_zero = true},
                canvas_of_terminal()),
      table.text());
  return exit_code::kDone;
}

struct Control {
  std::string name;
  ForceGains gains;
};

std::vector<Control> controls_of(const MckibbenStiffnessOptions& options, const DeviceSpec& spec) {
  if (options.kp || options.ki || options.kd)
    return {{"as given", {.kp = options.kp.value_or(0), .ki = options.ki.value_or(0), .kd = options.kd.value_or(0)}}};
  return {{"the paper's P", LoopOptions{}.gains}, {"the device's own", spec.gains}};
}

int command_device_stiffness_mckibben(const MckibbenStiffnessOptions& options) {
  const DeviceSpec spec = device_named(options.spec, DeviceModel::mckibben);
  const Tendon tendon = options.tendon.value_or(spec.tendon);
  std::string csv = "control,kp,ki,kd,tendon,asked_n_per_rad,rendered_n_per_rad,rms_error_n\n";
  std::vector<nlohmann::ordered_json> rows;
  using Align = TextTable::Align;
  TextTable table(
      {"asked (N/rad)", "control", "gains (P, I, D)", "rendered (N/rad)", "rendered / asked", "RMS error (N)"},
      {Align::right, Align::left, Align::left, Align::right, Align::right, Align::right});
  for (const double asked : options.stiffness_n_per_rad) {
    for (const Control& control : controls_of(options, spec)) {
      const ForceGains& gains = control.gains;
      const TrackResult result = track(
          spec.finger,
          {.loop = {.gains = gains, .tendon = tendon}, .kobj_n_per_rad = asked, .frequency_hz = options.frequency_hz});
      csv += csv_line({control.name, csv_number(gains.kp), csv_number(gains.ki), csv_number(gains.kd),
                       std::string(to_string(tendon)), csv_number(asked), csv_number(result.rendered_n_per_rad),
                       csv_number(result.rms_error_n)});
      rows.push_back({{"asked", asked},
                      {"rendered", json_number(result.rendered_n_per_rad)},
                      {"control", control.name},
                      {"kp", gains.kp},
                      {"ki", gains.ki},
                      {"kd", gains.kd},
                      {"tendon", to_string(tendon)},
                      {"frequency_hz", options.frequency_hz},
                      {"rms_error", json_number(result.rms_error_n)}});
      table.add({fmt::format("{:g}", asked), control.name,
                 fmt::format("{:g}, {:g}, {:g}", gains.kp, gains.ki, gains.kd),
                 fmt::format("{:.3f}", result.rendered_n_per_rad),
                 fmt::format("{:.4f}", result.rendered_n_per_rad / asked), fmt::format("{:.3f}", result.rms_error_n)});
    }
  }
  if (write_csv(options.output, csv)) return exit_code::kDone;
  if (options.output.json) {
    for (const auto& row : rows) print_json(row);
    return exit_code::kDone;
  }
  fmt::print("{}: straight to flexed and back at {:g} Hz, {} tendon\n{}", bold("rendered stiffness"),
             options.frequency_hz, to_string(tendon), table.text());
  return exit_code::kDone;
}

void add_rrs3_stiffness(CommandTree& stiffness) {
  const auto [command, options] = stiffness.add("rrs3", "Pressed through the governor, settled, and fitted",
                                                "jnd device stiffness rrs3 --stiffness 500,900 --mode pd --finger 1000",
                                                command_device_stiffness_rrs3);
  command.add_option("--spec", options.spec, "another description of such a device");
  add_number(command, "--stiffness", options.stiffness_n_per_m, "kS, N/m; several with commas")
      .delimiter(',')
      .required();
  command.add_choice("--mode", options.mode, kRenderingModeWords,
                     "rendering: wrench, pd or pd-literal (default: wrench)");
  add_number(command, "--finger", options.finger_n_per_m, "stiffness of the finger's pulp, N/m (default: 1000)");
  add_number(command, "--roll", options.roll_rad, "inclination of the surface, rad (default: 0)");
  add_number(command, "--pitch", options.pitch_rad, "inclination of the surface, rad (default: 0)");
  add_output(command, options.output, "force over depth");
}

void add_mckibben_stiffness(CommandTree& stiffness) {
  const auto [command, options] =
      stiffness.add("mckibben", "Fitted while the finger flexes against the object",
                    "jnd device stiffness mckibben --stiffness 8,50", command_device_stiffness_mckibben);
  command.add_option("--spec", options.spec, "another description of such a device");
  add_number(command, "--stiffness", options.stiffness_n_per_rad, "of the object, N/rad; several with commas")
      .delimiter(',')
      .required();
  add_number(command, "--kp", options.kp,
             "proportional gain, V/N (default: both the paper's P control and the device's own)");
  add_number(command, "--ki", options.ki, "integral gain, V/(N s) (default: 0 beside another gain)");
  add_number(command, "--kd", options.kd, "derivative gain, V s/N (default: 0 beside another gain)");
  command.add_choice("--tendon", options.tendon, kTendonWords, "bilateral or unilateral (default: the device's own)");
  add_number(command, "--frequency", options.frequency_hz, "frequency of the flexion, Hz (default: 0.5)");
  add_output(command, options.output, "the table");
}

}  // namespace

void add_device_stiffness(CommandTree& device) {
  CommandTree stiffness = device.add_group("stiffness", "The stiffness that a device really renders");
  add_rrs3_stiffness(stiffness);
  add_mckibben_stiffness(stiffness);
}

}  // namespace jnd
