// jnd device model: one question to the models of the two papers, the 3RRS platform and the McKibben finger.
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "data/fields/csv_writer.h"
#include "devices/mckibben/mckibben_model.h"
#include "devices/rrs3/rrs3_model.h"
#include "devices/rrs3/rrs3_workspace.h"
#include "protocols/input/input_error.h"
#include "runner/device_commands/device_commands.h"
#include "runner/device_commands/device_output.h"
#include "runner/device_commands/rrs3_answer.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/plot.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

struct MckibbenModelOptions {
  std::string spec = "mckibben";
  std::optional<double> angle_rad;
  std::optional<double> pressure_pa, length_m;   // gauge, of the muscle
  std::optional<double> upstream_pa, muscle_pa;  // absolute
  bool sweep = false;                            // over the usable range
  DeviceOutput output;
};

constexpr const char* kPoseWanted = "PZ,ROLL,PITCH (m, rad, rad), such as -0.018,0.2,-0.1";
constexpr const char* kWrenchWanted = "FX,FY,FZ,MX,MY,MZ (N and N m), such as 0,0,2,0,0,0";

std::string row_text(const Eigen::VectorXd& numbers, double scale = 1) {
  std::string text;
  for (Eigen::Index i = 0; i < numbers.size(); ++i) text += fmt::format("{:>12.5g}", scale * numbers[i]);
  return text;
}

void print_rrs3(const Rrs3ModelQuery& query, const Rrs3ModelAnswer& answer) {
  const Rrs3Coordinates& at = query.coordinates;
  fmt::print("pose: pz {:g} mm, roll {}, pitch {}\n", 1e3 * at.pz_m, angle_text(at.roll_rad), angle_text(at.pitch_rad));
  const auto line = [](const char* what, const std::string& text) { fmt::print("  {:<28}{}\n", what, text); };
  line("parasitic yaw (1)", angle_text(answer.yaw));
  line("platform's centre (mm)", row_text(answer.p, 1e3));
  for (Eigen::Index leg = 0; leg < 3; ++leg)
    line(fmt::format("leg {}: joint, elbow (mm)", leg + 1).c_str(),
         row_text(answer.b.row(leg).transpose(), 1e3) + "  " + row_text(answer.d.row(leg).transpose(), 1e3));
  line("joint angles q (deg)", row_text(answer.q, kDegreesPerRadian));
  for (Eigen::Index row = 0; row < 3; ++row)
    line(row == 0 ? "J: q' of [vz, wx, wy] (22)" : "", row_text(answer.j_chi.row(row).transpose()));
  line("torques (26) (N mm)", row_text(answer.tau, 1e3));
  if (query.translational_n_per_m != 0 || query.rotational_n_m_per_rad != 0)
    for (Eigen::Index row = 0; row < 3; ++row)
      line(row == 0 ? "Kq (35) (N m/rad)" : "", row_text(answer.kq.row(row).transpose()));
  line("condition number of J", fmt::format("{:>12.4f}", answer.cond));
  const auto nearest = [](const Rrs3Margin& margin, double scale, const char* unit) {
    const auto one = [&](double distance) {
      return std::isfinite(distance) ? fmt::format("{:.2f} {}", scale * distance, unit) : std::string("none");
    };
    return fmt::format("{} below, {} above", one(margin.down), one(margin.up));
  };
  const Rrs3SingularityDistances& far = answer.singularities;
  line("serial singularity, pz", nearest(far.pz.serial, 1e3, "mm"));
  line("parallel singularity, roll", nearest(far.roll.parallel, kDegreesPerRadian, "deg"));
  line("parallel singularity, pitch", nearest(far.pitch.parallel, kDegreesPerRadian, "deg"));
}

int show_map(const Rrs3ModelOptions& options) {
  const DeviceSpec spec = device_named("rrs3", DeviceModel::rrs3);
  const Rrs3Geometry geometry = options.geometry.empty() ? geometry_of(spec) : load_rrs3_geometry(options.geometry);
  const Rrs3Kinematics kinematics(geometry);
  Rrs3Box box = box_of(spec);
  const double rest = geometry.rest_z_m;
  box.lowest_m = rest - spec.stroke_m / 2;
  box.highest_m = rest + spec.stroke_m / 2;
  const double height = options.height_m.value_or(rest);
  constexpr int kRolls = 25, kPitches = 37;
  const Rrs3ConditionMap map = condition_map(kinematics, box, height, kRolls, kPitches);
  if (write_csv(options.output, condition_csv(map))) return exit_code::kDone;
  const Rrs3Workspace whole = workspace_of(kinematics, box);
  if (options.output.json) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (std::size_t roll = 0; roll < map.rolls_rad.size(); ++roll) {
      nlohmann::ordered_json row = nlohmann::ordered_json::array();
      for (std::size_t pitch = 0; pitch < map.pitches_rad.size(); ++pitch) {
        const double condition = map.at(roll, pitch);
        row.push_back(std::isfinite(condition) ? nlohmann::ordered_json(condition) : nlohmann::ordered_json(nullptr));
      }
      rows.push_back(row);
    }
    print_json({{"pz", map.pz_m},
                {"roll", json_array(map.rolls_rad)},
                {"pitch", json_array(map.pitches_rad)},
                {"cond", rows},
                {"reachable_share", whole.reachable_share()},
                {"worst_cond", json_number(whole.worst_condition)}});
    return exit_code::kDone;
  }
  HeatMap picture;
  picture.x_label = "pitch (deg)";
  picture.y_label = fmt::format("roll (deg), at pz = {:g} mm", 1e3 * height);
  for (const double pitch : map.pitches_rad) picture.x.push_back(pitch * kDegreesPerRadian);
  for (const double roll : map.rolls_rad) picture.y.push_back(roll * kDegreesPerRadian);
  picture.values = map.conditions;
  picture.value_label = "condition number";
  picture.edges = {1.6, 2, 2.5};
  picture.none_label = "out of reach";
  fmt::print("{}", heat_map(picture, canvas_of_terminal()));
  fmt::print(
      "\n  all heights of the stroke: {:.1f} % of {} poses reachable; worst condition number {:.2f},\n"
      "  at pz {:.2f} mm, roll {:.1f}, pitch {:.1f} deg\n",
      100 * whole.reachable_share(), whole.poses, whole.worst_condition, 1e3 * whole.worst.pz_m,
      whole.worst.roll_rad * kDegreesPerRadian, whole.worst.pitch_rad * kDegreesPerRadian);
  return exit_code::kDone;
}

int command_device_model_rrs3(const Rrs3ModelOptions& options) {
  const int asked = (options.pose.empty() ? 0 : 1) + (options.batch.empty() ? 0 : 1) + (options.map ? 1 : 0);
  if (asked != 1) throw UsageError("give one of --pose PZ,ROLL,PITCH, --batch FILE and --map");
  if (!options.map && !options.output.csv.empty()) throw UsageError("--csv is for --map");
  if (!options.map && options.height_m) throw UsageError("--height is for --map");
  if (options.map) return show_map(options);
  if (!options.batch.empty()) return answer_rrs3_batch(options);

  Rrs3ModelQuery query;
  const std::vector<double> pose = numbers_of(options.pose, 3, "--pose", kPoseWanted);
  query.coordinates = {.pz_m = pose[0], .roll_rad = pose[1], .pitch_rad = pose[2]};
  if (!options.wrench.empty()) {
    const std::vector<double> wrench = numbers_of(options.wrench, 6, "--wrench", kWrenchWanted);
    for (Eigen::Index i = 0; i < 6; ++i) query.wrench[i] = wrench[static_cast<std::size_t>(i)];
  }
  query.geometry = options.geometry.empty() ? geometry_of(device_named("rrs3", DeviceModel::rrs3))
                                            : load_rrs3_geometry(options.geometry);
  query.translational_n_per_m = options.stiffness_n_per_m;
  query.rotational_n_m_per_rad = options.rotational_n_m_per_rad.value_or(1e-3 * options.stiffness_n_per_m);
  check_rrs3_query(query);
  const std::optional<Rrs3ModelAnswer> answer = ask_rrs3_model(query);
  if (!answer)
    throw InputError(
        fmt::format("pz {:g} m, roll {:g}, pitch {:g} rad is out of the legs' reach: `jnd device model rrs3 "
                    "--map` shows where the platform can go",
                    pose[0], pose[1], pose[2]));
  if (options.output.json)
    print_json(rrs3_answer_json(*answer));
  else
    print_rrs3(query, *answer);
  return exit_code::kDone;
}

// What the finger is at an angle, without its loop.
struct FingerAt {
  double angle_rad = 0;
  LinkagePose linkage;
  MckibbenPose pose;
  double length_m = 0, volume_m3 = 0, f0_n = 0;
};

FingerAt finger_at(const MckibbenModel& model, double angle_rad) {
  const std::optional<LinkagePose> linkage = model.linkage().pose(angle_rad);
  const std::optional<MckibbenPose> pose = linkage ? model.pose(angle_rad) : std::nullopt;
  if (!pose) {
    const AngleRange& range = model.linkage().assembles();
    throw InputError(
        fmt::format("the finger cannot be at {}: its linkage assembles at {:.6f} to {:.6f} rad ({:.3f} to "
                    "{:.3f} deg), as long as the muscle is not longer than its fibres",
                    angle_text(angle_rad), range.min_rad, range.max_rad, range.min_rad * kDegreesPerRadian,
                    range.max_rad * kDegreesPerRadian));
  }
  FingerAt at{.angle_rad = angle_rad, .linkage = *linkage, .pose = *pose};
  at.length_m = model.parameters().l0_m - linkage->stroke_m;
  at.volume_m3 = muscle_volume_m3(model.parameters(), at.length_m);
  at.f0_n = muscle_force_at_zero_n(model.parameters(), at.length_m);
  return at;
}

void add_to(nlohmann::ordered_json& out, const FingerAt& at) {
  const LinkagePose& linkage = at.linkage;
  out["theta1"] = json_number(linkage.theta1_rad);
  out["theta2"] = json_number(linkage.theta2_rad);
  out["beta"] = json_number(linkage.beta_rad);
  out["l5"] = json_number(linkage.l5_m);
  out["stroke"] = json_number(linkage.stroke_m);
  out["p"] = json_array(linkage.p_m);
  out["kx"] = json_number(linkage.kx);
  out["kw"] = json_number(linkage.kw);
  out["length"] = json_number(at.length_m);
  out["volume"] = json_number(at.volume_m3);
  out["ka"] = json_number(at.pose.ka_n_per_pa());
  out["off"] = json_number(at.pose.off_n());
  out["f0"] = json_number(at.f0_n);
}

void print_finger(const MckibbenModel& model, const FingerAt& at) {
  const auto line = [](const char* what, const std::string& text) { fmt::print("  {:<30}{}\n", what, text); };
  const AngleRange& usable = model.linkage().usable();
  const bool used = at.angle_rad >= usable.min_rad - 1e-9 && at.angle_rad <= usable.max_rad + 1e-9;
  fmt::print("rocker at {}{}\n", angle_text(at.angle_rad),
             used ? ""
                  : warn(fmt::format(", outside the finger's range of {:.3f} to {:.3f} deg",
                                     usable.min_rad * kDegreesPerRadian, usable.max_rad * kDegreesPerRadian)));
  line("finger link theta1", angle_text(at.linkage.theta1_rad));
  line("coupler theta2", angle_text(at.linkage.theta2_rad));
  line("tendon beta", angle_text(at.linkage.beta_rad));
  line("tendon l5, stroke", fmt::format("{:.3f}, {:.3f} mm", 1e3 * at.linkage.l5_m, 1e3 * at.linkage.stroke_m));
  line("fingertip P (u, w)", fmt::format("{:.3f}, {:.3f} mm", 1e3 * at.linkage.p_m[0], 1e3 * at.linkage.p_m[1]));
  line("dF/dFx, dF/d(weight)", fmt::format("{:.6f}, {:.6f}", at.linkage.kx, at.linkage.kw));
  line("muscle: length, volume", fmt::format("{:.3f} mm, {:.3f} cm3", 1e3 * at.length_m, 1e6 * at.volume_m3));
  line("muscle's force at p = 0 (14)", fmt::format("{:.3f} N", at.f0_n));
  line("force on the finger", fmt::format("{:.3f} N + {:.3f} N/bar p", at.pose.off_n(), 1e5 * at.pose.ka_n_per_pa()));
}

int sweep(const MckibbenModel& model, const DeviceOutput& output) {
  constexpr int kSteps = 60;
  const AngleRange& usable = model.linkage().usable();
  std::vector<FingerAt> all;
  for (int i = 0; i <= kSteps; ++i)
    all.push_back(finger_at(model, usable.min_rad + (usable.max_rad - usable.min_rad) * i / kSteps));
  std::string csv = "angle_rad,stroke_m,length_m,volume_m3,kx,kw,ka_n_per_pa,off_n\n";
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  PlotSeries empty{.name = "without pressure", .x = {}, .y = {}}, full = {.name = "at 1 bar", .x = {}, .y = {}};
  for (const FingerAt& at : all) {
    csv += csv_line({csv_number(at.angle_rad), csv_number(at.linkage.stroke_m), csv_number(at.length_m),
                     csv_number(at.volume_m3), csv_number(at.linkage.kx), csv_number(at.linkage.kw),
                     csv_number(at.pose.ka_n_per_pa()), csv_number(at.pose.off_n())});
    nlohmann::ordered_json row = {{"angle", at.angle_rad}};
    add_to(row, at);
    out.push_back(row);
    empty.x.push_back(at.angle_rad * kDegreesPerRadian);
    empty.y.push_back(at.pose.off_n());
    full.x.push_back(empty.x.back());
    full.y.push_back(at.pose.off_n() + 1e5 * at.pose.ka_n_per_pa());
  }
  if (write_csv(output, csv)) return exit_code::kDone;
  if (output.json) {
    for (const auto& row : out) print_json(row);
    return exit_code::kDone;
  }
  fmt::print("{}",
             line_plot({full, empty}, {.x_label = "rocker angle (deg), straight to flexed", .y_label = "force (N)"},
                       canvas_of_terminal()));
  return exit_code::kDone;
}

int command_device_model_mckibben(const MckibbenModelOptions& options) {
  if (options.pressure_pa.has_value() != options.length_m.has_value())
    throw UsageError("the muscle's force needs both --pressure and --length");
  if (options.upstream_pa.has_value() != options.muscle_pa.has_value())
    throw UsageError("the mass flow needs both --upstream and --muscle");
  if (!options.sweep && !options.output.csv.empty()) throw UsageError("--csv is for --sweep");
  const DeviceSpec spec = device_named(options.spec, DeviceModel::mckibben);
  const MckibbenModel model(spec.finger, Tendon::bilateral, spec.gains);
  if (options.sweep) {
    if (options.angle_rad || options.pressure_pa || options.upstream_pa)
      throw UsageError("--sweep goes over all angles: ask the other questions without it");
    return sweep(model, options.output);
  }
  if (!options.angle_rad && !options.pressure_pa && !options.upstream_pa)
    throw UsageError("give --angle, --pressure with --length, --upstream with --muscle, or --sweep");

  nlohmann::ordered_json out;
  if (options.angle_rad) {
    const FingerAt at = finger_at(model, *options.angle_rad);
    add_to(out, at);
    if (!options.output.json) print_finger(model, at);
  }
  if (options.pressure_pa) {
    if (!(*options.length_m > 0 && *options.length_m < spec.finger.h_fibre_m))
      throw InputError(
          fmt::format("a muscle of {:g} m is impossible: give more than 0 and less than its fibres' {:g} m",
                      *options.length_m, spec.finger.h_fibre_m));
    const double force = muscle_force_n(spec.finger, *options.pressure_pa, *options.length_m);
    out["force"] = json_number(force);
    if (!options.output.json)
      fmt::print("muscle of {:g} mm at {:g} bar: {:.4f} N (positive pulls)\n", 1e3 * *options.length_m,
                 1e-5 * *options.pressure_pa, force);
  }
  if (options.upstream_pa) {
    if (!(*options.upstream_pa > 0) || !(*options.muscle_pa > 0))
      throw InputError(fmt::format("absolute pressures of {:g} and {:g} Pa: give more than 0", *options.upstream_pa,
                                   *options.muscle_pa));
    const FlowResistance resistance{spec.finger.rho0_kg_per_m3 * spec.finger.c_m3_per_s_pa, spec.finger.b};
    const double flow = resistance.flow_kg_per_s(*options.upstream_pa, *options.muscle_pa);
    out["flow"] = json_number(flow);
    if (!options.output.json)
      fmt::print("from {:g} to {:g} Pa: {:.6g} kg/s {}\n", *options.upstream_pa, *options.muscle_pa, std::abs(flow),
                 flow < 0 ? "out of the muscle" : "into the muscle");
  }
  if (options.output.json) print_json(out);
  return exit_code::kDone;
}

void add_rrs3_model(CommandTree& models) {
  const auto [command, options] = models.add(
      "rrs3", "Kinematics and statics of the 3RRS platform at a pose, or a map of its workspace",
      "jnd device model rrs3 --pose -0.018,0.2,-0.1 --wrench 0,0,2,0,0,0 --stiffness 700\n  jnd device model rrs3 --map\n"
      "  jnd device model rrs3 --batch poses.jsonl",
      command_device_model_rrs3);
  command.add_option("--pose", options.pose, "PZ,ROLL,PITCH: m, rad, rad");
  command.add_option("--geometry", options.geometry,
                     "JSON of a geometry, or of a device (default: the shipped device)");
  command.add_option("--wrench", options.wrench, "FX,FY,FZ,MX,MY,MZ on the finger at the platform's centre: N, N m");
  add_number(command, "--stiffness", options.stiffness_n_per_m, "kS of the joint stiffness (35), N/m");
  add_number(command, "--rotational", options.rotational_n_m_per_rad,
             "kphi of the joint stiffness, N m/rad (default: kS read as N mm/rad)");
  command.add_option("--batch", options.batch,
                     "a question a line, as JSON: {\"pz\", \"roll\", \"pitch\", \"geometry\"?: {\"a\", \"b\", \"bh\", "
                     "\"bd\", \"l1\", \"l2\", \"pz0\"}, \"wrench\"?, \"stiffness\"?, \"rotational\"?}; - reads "
                     "standard input. Answers are JSON lines");
  command.add_flag("--map", options.map, "condition number over roll and pitch");
  add_number(command, "--height", options.height_m, "height of the map, m (default: the rest height)");
  add_output(command, options.output, "the map");
}

void add_mckibben_model(CommandTree& models) {
  const auto [command, options] =
      models.add("mckibben", "Linkage, muscle and air of the McKibben finger",
                 "jnd device model mckibben --angle 0.6\n  jnd device model mckibben --pressure 200000 --length 0.13\n"
                 "  jnd device model mckibben --upstream 500000 --muscle 150000\n  jnd device model mckibben --sweep",
                 command_device_model_mckibben);
  command.add_option("--spec", options.spec, "another description of such a device");
  add_number(command, "--angle", options.angle_rad, "angle of the rocker, rad: linkage and static force");
  add_number(command, "--pressure", options.pressure_pa,
             "pressure in the muscle, gauge, Pa; with --length: force of the muscle, (14)");
  add_number(command, "--length", options.length_m, "length of the muscle, m");
  add_number(command, "--upstream", options.upstream_pa,
             "pressure before the valve, absolute, Pa; with --muscle: mass flow into the muscle, (11)");
  add_number(command, "--muscle", options.muscle_pa, "pressure in the muscle, absolute, Pa");
  command.add_flag("--sweep", options.sweep, "force without pressure and force per bar, from straight to flexed");
  add_output(command, options.output, "the sweep");
}

}  // namespace

void add_device_model(CommandTree& device) {
  CommandTree models = device.add_group("model", "Ask the models of the papers one question");
  add_rrs3_model(models);
  add_mckibben_model(models);
}

}  // namespace jnd
