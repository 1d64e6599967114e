// jnd device step, bode, track and onset: how a McKibben finger's force loop answers.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/fields/csv_writer.h"
#include "devices/mckibben/mckibben_response.h"
#include "runner/device_commands/device_commands.h"
#include "runner/device_commands/device_output.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/plot.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

// The force loop of a McKibben finger.
struct MckibbenLoopOptions {
  std::string spec = "mckibben";
  ForceGains gains{.kp = 0.28};  // the paper's
  Tendon tendon = Tendon::bilateral;
};

struct DeviceStepOptions {
  MckibbenLoopOptions loop;
  std::optional<double> angle_rad;  // straight where not given
  double from_n = 0, to_n = 5;
  double duration_s = 1.2;
  DeviceOutput output;
};

struct DeviceBodeOptions {
  MckibbenLoopOptions loop;
  std::optional<double> angle_rad;
  double mean_n = 10, amplitude_n = 8;
  std::vector<double> frequencies_rad_per_s;
  int settle_cycles = 6, measure_cycles = 3;
  DeviceOutput output;
};

struct DeviceTrackOptions {
  MckibbenLoopOptions loop;
  std::vector<double> kobj_n_per_rad;
  double frequency_hz = 0.5;
  DeviceOutput output;
};

struct DeviceOnsetOptions {
  std::string spec = "mckibben";
  std::vector<double> angles_rad;  // some from straight to flexed where empty
  DeviceOutput output;
};

LoopOptions loop_of(const MckibbenLoopOptions& options) {
  return {.gains = options.gains, .tendon = options.tendon};
}

std::string loop_text(const MckibbenLoopOptions& loop) {
  std::string text = fmt::format("kp {:g} V/N", loop.gains.kp);
  if (loop.gains.ki != 0) text += fmt::format(", ki {:g} V/(N s)", loop.gains.ki);
  if (loop.gains.kd != 0) text += fmt::format(", kd {:g} V s/N", loop.gains.kd);
  return text + fmt::format(", {} tendon", to_string(loop.tendon));
}

double straight_rad(const DeviceSpec& spec) {
  return MckibbenLinkage(spec.finger).usable().min_rad;
}

void line(const char* what, const std::string& text) {
  fmt::print("  {:<20}{}\n", what, text);
}

int command_device_step(const DeviceStepOptions& options) {
  const DeviceSpec spec = device_named(options.loop.spec, DeviceModel::mckibben);
  const double angle = options.angle_rad.value_or(straight_rad(spec));
  const StepResponse response = step_response(spec.finger, {.loop = loop_of(options.loop),
                                                            .angle_rad = angle,
                                                            .from_n = options.from_n,
                                                            .to_n = options.to_n,
                                                            .duration_s = options.duration_s});
  std::string csv = "time_s,force_n\n";
  for (std::size_t i = 0; i < response.time_s.size(); ++i)
    csv += csv_line({csv_number(response.time_s[i]), csv_number(response.force_n[i])});
  if (write_csv(options.output, csv)) return exit_code::kDone;
  if (options.output.json) {
    print_json({{"t", json_array(response.time_s)},
                {"force", json_array(response.force_n)},
                {"f_start", json_number(response.start_n)},
                {"f_final", json_number(response.final_n)},
                {"e_ss", json_number(response.steady_error_n)},
                {"overshoot_pct", json_number(response.overshoot_pct)},
                {"oscillation_pp", json_number(response.oscillation_pp_n)},
                {"oscillation_rad_s", json_number(response.oscillation_rad_per_s)},
                {"verdict", to_string(response.verdict)},
                {"tail_mean", json_number(response.tail_mean_n)},
                {"angle", angle}});
    return exit_code::kDone;
  }
  fmt::print("{}: {:g} to {:g} N at {}, {}\n\n", bold("step"), options.from_n, options.to_n, angle_text(angle),
             loop_text(options.loop));
  const std::vector<double> ends = {response.time_s.front(), response.time_s.back()};
  fmt::print("{}", line_plot({{.name = "force on the finger", .x = response.time_s, .y = response.force_n},
                              {.name = "commanded", .x = ends, .y = {options.to_n, options.to_n}}},
                             {.x_label = "time (s)", .y_label = "force (N)"}, canvas_of_terminal()));
  fmt::print("\n");
  line("from, to", fmt::format("{:.4f} N, {:.4f} N (steady state)", response.start_n, response.final_n));
  line("steady error", fmt::format("{:.4f} N", response.steady_error_n));
  line("overshoot", fmt::format("{:.2f} % of the change", response.overshoot_pct));
  line("at the end", response.oscillation_rad_per_s > 0
                         ? fmt::format("{:.4f} N peak to peak at {:.1f} rad/s", response.oscillation_pp_n,
                                       response.oscillation_rad_per_s)
                         : std::string("at rest"));
  line("verdict", bold(std::string(to_string(response.verdict))));
  return exit_code::kDone;
}

int command_device_bode(const DeviceBodeOptions& options) {
  const DeviceSpec spec = device_named(options.loop.spec, DeviceModel::mckibben);
  const double angle = options.angle_rad.value_or(straight_rad(spec));
  const FrequencyResponse response =
      frequency_response(spec.finger, {.loop = loop_of(options.loop),
                                       .angle_rad = angle,
                                       .mean_n = options.mean_n,
                                       .amplitude_n = options.amplitude_n,
                                       .frequency_rad_per_s = options.frequencies_rad_per_s,
                                       .settle_cycles = options.settle_cycles,
                                       .measure_cycles = options.measure_cycles});
  std::string csv = "frequency_rad_per_s,magnitude,phase_rad\n";
  for (std::size_t i = 0; i < response.frequency_rad_per_s.size(); ++i)
    csv += csv_line({csv_number(response.frequency_rad_per_s[i]), csv_number(response.magnitude[i]),
                     csv_number(response.phase_rad[i])});
  if (write_csv(options.output, csv)) return exit_code::kDone;
  if (options.output.json) {
    nlohmann::ordered_json out = {{"frequency", json_array(response.frequency_rad_per_s)},
                                  {"magnitude", json_array(response.magnitude)},
                                  {"phase", json_array(response.phase_rad)},
                                  {"dc", json_number(response.dc)},
                                  {"bandwidth", nullptr},
                                  {"amplitude", options.amplitude_n},
                                  {"mean", options.mean_n},
                                  {"angle", angle}};
    if (response.bandwidth_rad_per_s) out["bandwidth"] = json_number(*response.bandwidth_rad_per_s);
    out["bandwidth_status"] = response.bandwidth_rad_per_s ? "ok" : "none up to 1000 rad/s";
    print_json(out);
    return exit_code::kDone;
  }
  fmt::print("{}: {:g} N about {:g} N at {}, {}\n\n", bold("frequency response"), options.amplitude_n, options.mean_n,
             angle_text(angle), loop_text(options.loop));
  if (response.frequency_rad_per_s.size() > 2) {
    const Canvas canvas = canvas_of_terminal();
    std::vector<double> decibels, degrees;
    for (const double magnitude : response.magnitude) decibels.push_back(20 * std::log10(magnitude));
    for (const double phase : response.phase_rad) degrees.push_back(phase * kDegreesPerRadian);
    const std::vector<double> ends = {response.frequency_rad_per_s.front(), response.frequency_rad_per_s.back()};
    const double three_below = 20 * std::log10(response.dc / std::sqrt(2.0));
    fmt::print("{}", line_plot({{.name = "magnitude", .x = response.frequency_rad_per_s, .y = decibels},
                                {.name = "3 dB below a slow change", .x = ends, .y = {three_below, three_below}}},
                               {.x_label = "frequency (rad/s)", .y_label = "F / Fref (dB)", .rows = 12, .log_x = true},
                               canvas));
    fmt::print("\n{}",
               line_plot({{.name = "phase", .x = response.frequency_rad_per_s, .y = degrees}},
                         {.x_label = "frequency (rad/s)", .y_label = "phase (deg)", .rows = 8, .log_x = true}, canvas));
    fmt::print("\n");
  } else {
    for (std::size_t i = 0; i < response.frequency_rad_per_s.size(); ++i)
      fmt::print("  at {:g} rad/s: {:.4f}, {}\n", response.frequency_rad_per_s[i], response.magnitude[i],
                 angle_text(response.phase_rad[i]));
  }
  line("slow change", fmt::format("{:.4f} N per N", response.dc));
  line("bandwidth", response.bandwidth_rad_per_s
                        ? fmt::format("{:.1f} rad/s ({:.2f} Hz) at this amplitude: it depends on it",
                                      *response.bandwidth_rad_per_s, *response.bandwidth_rad_per_s / (2 * M_PI))
                        : std::string("above 1000 rad/s"));
  return exit_code::kDone;
}

int command_device_track(const DeviceTrackOptions& options) {
  const DeviceSpec spec = device_named(options.loop.spec, DeviceModel::mckibben);
  std::string csv =
      "kobj_n_per_rad,frequency_hz,force_peak_n,force_min_n,rms_error_n,reference_peak_n,rendered_n_per_rad\n";
  std::vector<nlohmann::ordered_json> rows;
  using Align = TextTable::Align;
  TextTable table({"object (N/rad)", "force (N)", "least (N)", "asked (N)", "RMS error (N)", "rendered (N/rad)"},
                  {Align::right, Align::right, Align::right, Align::right, Align::right, Align::right});
  for (const double kobj : options.kobj_n_per_rad) {
    const TrackResult result = track(
        spec.finger, {.loop = loop_of(options.loop), .kobj_n_per_rad = kobj, .frequency_hz = options.frequency_hz});
    csv += csv_line({csv_number(kobj), csv_number(options.frequency_hz), csv_number(result.force_peak_n),
                     csv_number(result.force_min_n), csv_number(result.rms_error_n),
                     csv_number(result.reference_peak_n), csv_number(result.rendered_n_per_rad)});
    rows.push_back({{"force_peak", json_number(result.force_peak_n)},
                    {"force_min", json_number(result.force_min_n)},
                    {"rms_error", json_number(result.rms_error_n)},
                    {"reference_peak", json_number(result.reference_peak_n)},
                    {"kobj", kobj},
                    {"rendered", json_number(result.rendered_n_per_rad)}});
    table.add({fmt::format("{:g}", kobj), fmt::format("{:.3f}", result.force_peak_n),
               fmt::format("{:.3f}", result.force_min_n), fmt::format("{:.3f}", result.reference_peak_n),
               fmt::format("{:.3f}", result.rms_error_n), fmt::format("{:.3f}", result.rendered_n_per_rad)});
  }
  if (write_csv(options.output, csv)) return exit_code::kDone;
  if (options.output.json) {
    for (const auto& row : rows) print_json(row);
    return exit_code::kDone;
  }
  fmt::print("{}: straight to flexed and back at {:g} Hz, {}\n{}", bold("tracking"), options.frequency_hz,
             loop_text(options.loop), table.text());
  return exit_code::kDone;
}

int command_device_onset(const DeviceOnsetOptions& options) {
  const DeviceSpec spec = device_named(options.spec, DeviceModel::mckibben);
  const MckibbenModel model(spec.finger, Tendon::bilateral, ForceGains{});
  std::vector<double> angles = options.angles_rad;
  if (angles.empty()) {
    constexpr int kAngles = 6;
    const AngleRange& usable = model.linkage().usable();
    for (int i = 0; i < kAngles; ++i)
      angles.push_back(usable.min_rad + (usable.max_rad - usable.min_rad) * i / (kAngles - 1));
  }
  // Small oscillations of valve and muscle, sonic flow: 4 zeta (1 + zeta).
  const double theory = 4 * spec.finger.zeta * (1 + spec.finger.zeta);
  std::string csv = "angle_rad,kp_onset_v_per_n,loop_gain,ka_n_per_pa,kp_theory_v_per_n\n";
  std::vector<nlohmann::ordered_json> rows;
  using Align = TextTable::Align;
  TextTable table({"angle (rad)", "(deg)", "KP* (V/N)", "loop gain", "by theory (V/N)"},
                  {Align::right, Align::right, Align::right, Align::right, Align::right});
  for (const double angle : angles) {
    const std::optional<double> onset = onset_of_oscillation(spec.finger, angle);
    const double gain_per_kp = model.pose(angle)->ka_n_per_pa() * spec.finger.kv_pa_per_v;
    const double by_theory = theory / gain_per_kp;
    csv += csv_line({csv_number(angle), onset ? csv_number(*onset) : "", onset ? csv_number(*onset * gain_per_kp) : "",
                     csv_number(gain_per_kp / spec.finger.kv_pa_per_v), csv_number(by_theory)});
    nlohmann::ordered_json row = {{"angle", angle},
                                  {"kp_onset", nullptr},
                                  {"loop_gain", nullptr},
                                  {"kp_theory", json_number(by_theory)},
                                  {"status", onset ? "ok" : "stable up to 10 V/N"}};
    if (onset) {
      row["kp_onset"] = json_number(*onset);
      row["loop_gain"] = json_number(*onset * gain_per_kp);
    }
    rows.push_back(row);
    table.add({fmt::format("{:.6f}", angle), fmt::format("{:.3f}", angle * kDegreesPerRadian),
               onset ? fmt::format("{:.3f}", *onset) : "above 10",
               onset ? fmt::format("{:.2f}", *onset * gain_per_kp) : "", fmt::format("{:.3f}", by_theory)});
  }
  if (write_csv(options.output, csv)) return exit_code::kDone;
  if (options.output.json) {
    for (const auto& row : rows) print_json(row);
    return exit_code::kDone;
  }
  fmt::print("{}: least gain at which a step of 5 N oscillates on by more than 2 %\n{}", bold("onset under P control"),
             table.text());
  fmt::print(
      "\n  By theory at a loop gain of 4 zeta (1 + zeta) = {:.2f}. The paper finds it near 2 V/N and an unstable\n"
      "  finger at 3; with the parameters of its Table 1 it begins here.\n",
      theory);
  return exit_code::kDone;
}

void add_loop(const Command& command, MckibbenLoopOptions& loop) {
  command.add_option("--spec", loop.spec, "another description of such a device");
  add_number(command, "--kp", loop.gains.kp, "proportional gain, V/N (default: 0.28, the paper's)");
  add_number(command, "--ki", loop.gains.ki, "integral gain, V/(N s) (default: 0)");
  add_number(command, "--kd", loop.gains.kd, "derivative gain, V s/N (default: 0)");
  command.add_choice("--tendon", loop.tendon, kTendonWords,
                     "bilateral: it can push too, as the paper's (15); unilateral: as a real one (default: bilateral)");
}

}  // namespace

void add_device_step(CommandTree& device) {
  const auto [command, options] =
      device.add_group("step", "The answer to a step of the commanded force")
          .add("mckibben", "Step response of the force loop",
               "jnd device step mckibben --kp 0.7 --from 0 --to 5 --angle 0.351181", command_device_step);
  add_loop(command, options.loop);
  add_number(command, "--angle", options.angle_rad, "angle of the rocker, rad (default: straight)");
  add_number(command, "--from", options.from_n, "force commanded before, N (default: 0)");
  add_number(command, "--to", options.to_n, "force commanded then, N (default: 5)");
  add_number(command, "--duration", options.duration_s, "length of the answer, s (default: 1.2)");
  add_output(command, options.output, "the curve");
}

void add_device_bode(CommandTree& device) {
  const auto [command, options] =
      device.add_group("bode", "The frequency response of the commanded force")
          .add("mckibben", "Frequency response of the force loop, at an amplitude",
               "jnd device bode mckibben --kp 0.7 --mean 10 --amplitude 8 --angle 0.351181", command_device_bode);
  add_loop(command, options.loop);
  add_number(command, "--angle", options.angle_rad, "angle of the rocker, rad (default: straight)");
  add_number(command, "--mean", options.mean_n, "mean of the commanded force, N (default: 10)");
  add_number(command, "--amplitude", options.amplitude_n, "amplitude of the commanded force, N (default: 8)");
  add_number(command, "--frequencies", options.frequencies_rad_per_s, "W1,W2,... rad/s (default: 1 to 1000)")
      .delimiter(',');
  command.add_option("--settle", options.settle_cycles, "whole cycles to let pass (default: 6)").range(1, 10'000);
  command.add_option("--measure", options.measure_cycles, "whole cycles to measure then (default: 3)").range(1, 10'000);
  add_output(command, options.output, "the curve");
}

void add_device_track(CommandTree& device) {
  const auto [command, options] =
      device.add_group("track", "How the commanded force is followed while the finger flexes")
          .add("mckibben", "Tracking of a virtual object's force during flexion",
               "jnd device track mckibben --kobj 8,20,50 --kp 0.28 --frequency 0.5", command_device_track);
  add_loop(command, options.loop);
  add_number(command, "--kobj", options.kobj_n_per_rad, "stiffness of the object, N/rad; several with commas")
      .delimiter(',')
      .required();
  add_number(command, "--frequency", options.frequency_hz, "frequency of the flexion, Hz (default: 0.5)");
  add_output(command, options.output, "the table");
}

void add_device_onset(CommandTree& device) {
  const auto [command, options] =
      device.add_group("onset", "Where the force loop begins to oscillate")
          .add("mckibben", "KP*: the least gain of P control that oscillates, at each angle",
               "jnd device onset mckibben --angle 0.351181,0.610865", command_device_onset);
  command.add_option("--spec", options.spec, "another description of such a device");
  add_number(command, "--angle", options.angles_rad,
             "angle of the rocker, rad; several with commas (default: straight to flexed)")
      .delimiter(',');
  add_output(command, options.output, "the table");
}

}  // namespace jnd
