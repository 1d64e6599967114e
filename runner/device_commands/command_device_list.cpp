// jnd device list and info: which rigs there are, what each can do, and which real devices are connected.
#include <fmt/format.h>

#include "protocols/input/resources.h"
#include "runner/device_commands/command_device_hid.h"
#include "runner/device_commands/device_commands.h"
#include "runner/device_commands/device_output.h"
#include "runner/device_commands/hid_devices.h"
#include "runner/opening/rig_limits.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

struct ListOptions {
  std::string rig_file;  // whose devices that are programs are listed too; empty: none
  bool json = false;
};

struct InfoOptions {
  std::string rig;       // or a real device, by serial number or path
  std::string rig_file;  // whose devices that are programs are looked for too; empty: none
  bool json = false;
};

std::string what_it_is(const RigSpec& rig) {
  std::string text;
  for (const DeviceSpec& device : rig.devices)
    text += fmt::format("{}{}", text.empty() ? "" : "; ", facts_of(device.model).renders);
  return text + ", simulated";
}

nlohmann::ordered_json limits_json(const DeviceSpec& device) {
  const bool joint = facts_of(device.model).acts_on_joint;
  nlohmann::ordered_json limits = {
      {"max_force_n", device.max_force_n},
      {std::string("max_stiffness_") + std::string(name_suffix(device.unit)), device.max_stiffness},
      {joint ? "min_angle_rad" : "lowest_m", device.lowest_travel},
      {joint ? "max_angle_rad" : "highest_m", device.highest_travel}};
  if (joint) return limits;
  limits["stroke_m"] = device.stroke_m;
  limits["max_roll_rad"] = device.max_roll_rad;
  limits["max_pitch_rad"] = device.max_pitch_rad;
  limits["max_joint_speed_rad_per_s"] = device.max_joint_speed_rad_per_s;
  limits["vibration_g"] = {device.min_vibration_g, device.max_vibration_g};
  limits["vibration_hz"] = {device.min_vibration_hz, device.max_vibration_hz};
  return limits;
}

nlohmann::ordered_json finger_json(const MckibbenParameters& finger) {
  return {{"l1_m", finger.l1_m},
          {"l2_m", finger.l2_m},
          {"d2_m", finger.d2_m},
          {"g2_m", finger.g2_m},
          {"h2_m", finger.h2_m},
          {"l4_m", finger.l4_m},
          {"l5max_m", finger.l5max_m},
          {"h0_m", finger.h0_m},
          {"hx_m", finger.hx_m},
          {"hx1_m", finger.hx1_m},
          {"mc_kg", finger.mc_kg},
          {"km_n_per_m", finger.km_n_per_m},
          {"fm0_n", finger.fm0_n},
          {"catt1_m", finger.catt1_m},
          {"l0_m", finger.l0_m},
          {"li_m", finger.li_m},
          {"ri_m", finger.ri_m},
          {"si_m", finger.si_m},
          {"nt", finger.nt},
          {"h_fibre_m", finger.h_fibre_m},
          {"e_pa", finger.e_pa},
          {"kv_pa_per_v", finger.kv_pa_per_v},
          {"zeta", finger.zeta},
          {"sigma_n_rad_per_s", finger.sigma_n_rad_per_s},
          {"valve_min_v", finger.valve_min_v},
          {"valve_max_v", finger.valve_max_v},
          {"c_m3_per_s_pa", finger.c_m3_per_s_pa},
          {"b", finger.b},
          {"rho0_kg_per_m3", finger.rho0_kg_per_m3},
          {"r_j_per_kg_k", finger.r_j_per_kg_k},
          {"temperature_k", finger.temperature_k},
          {"p_atm_pa", finger.p_atm_pa},
          {"g_m_per_s2", finger.g_m_per_s2}};
}

nlohmann::ordered_json geometry_json(const DeviceSpec& device) {
  return {{"a_m", device.a_m},   {"b_m", device.b_m},   {"bh_m", device.bh_m},        {"bd_m", device.bd_m},
          {"l1_m", device.l1_m}, {"l2_m", device.l2_m}, {"rest_z_m", device.rest_z_m}};
}

nlohmann::ordered_json device_json(const DeviceSpec& device) {
  nlohmann::ordered_json out = {{"name", device.name},
                                {"title", device.title},
                                {"acts_on", facts_of(device.model).place},
                                {"limits", limits_json(device)}};
  switch (device.model) {
    case DeviceModel::rrs3:
      out["geometry"] = geometry_json(device);
      break;
    case DeviceModel::mckibben:
      out["finger"] = finger_json(device.finger);
      out["control"] = {{"kp", device.gains.kp}, {"ki", device.gains.ki}, {"kd", device.gains.kd}};
      out["tendon"] = to_string(device.tendon);
      out["lever_arm_m"] = device.lever_arm_m;
      break;
  }
  return out;
}

nlohmann::ordered_json rig_json(const RigSpec& rig, const std::string& file) {
  nlohmann::ordered_json out = {{"name", rig.name},           {"title", rig.title},
                                {"what", what_it_is(rig)},    {"simulated", true},
                                {"shipped", is_shipped(rig)}, {"file", file},
                                {"sha256", rig.sha256},       {"devices", nlohmann::ordered_json::array()}};
  for (const DeviceSpec& device : rig.devices) out["devices"].push_back(device_json(device));
  if (rig.devices.size() > 1) out["lever_arm_m"] = rig.lever_arm_m;
  return out;
}

// Numbers of a JSON object as "name value" pairs, a few a line.
void say_all(const char* what, const nlohmann::ordered_json& values) {
  std::string line;
  int count = 0;
  for (const auto& [key, value] : values.items()) {
    line += fmt::format("{}{} {:g}", line.empty() ? "" : ", ", key, value.get<double>());
    if (++count % 4 != 0) continue;
    print_field(22, count == 4 ? what : "", line);
    line.clear();
  }
  if (!line.empty()) print_field(22, count < 4 ? what : "", line);
}

void print_platform(const DeviceSpec& device) {
  print_field(22, "stroke",
              fmt::format("{:g} mm: platform at {:g} to {:g} mm, at rest {:g} mm", 1e3 * device.stroke_m,
                          1e3 * device.lowest_travel, 1e3 * device.highest_travel, 1e3 * device.rest_z_m));
  print_field(22, "roll", fmt::format("± {}", angle_text(device.max_roll_rad)));
  print_field(22, "pitch", fmt::format("± {}", angle_text(device.max_pitch_rad)));
  print_field(22, "joints",
              fmt::format("at most {:.3f} rad/s ({:.0f} deg/s)", device.max_joint_speed_rad_per_s,
                          device.max_joint_speed_rad_per_s * kDegreesPerRadian));
  print_field(22, "vibration",
              fmt::format("{:g} to {:g} g, {:g} to {:g} Hz", device.min_vibration_g, device.max_vibration_g,
                          device.min_vibration_hz, device.max_vibration_hz));
  say_all("geometry", geometry_json(device));
}

void print_joint(const DeviceSpec& device) {
  print_field(22, "joint",
              fmt::format("{} to {}", angle_text(device.lowest_travel), angle_text(device.highest_travel)));
  print_field(
      22, "control",
      fmt::format("kp {:g} V/N, ki {:g} V/(N s), kd {:g} V s/N", device.gains.kp, device.gains.ki, device.gains.kd));
  print_field(22, "tendon", std::string(to_string(device.tendon)));
  print_field(22, "lever arm", fmt::format("{:g} m: travel of the fingertip per angle", device.lever_arm_m));
  say_all("finger", finger_json(device.finger));
}

void print_device(const DeviceSpec& device) {
  fmt::print("\n{}\n", bold(printable(device.name)));
  print_field(22, "force", fmt::format("at most {:g} N on the finger", device.max_force_n));
  print_field(22, "stiffness", fmt::format("at most {:g} {}", device.max_stiffness, to_string(device.unit)));
  switch (device.model) {
    case DeviceModel::rrs3:
      print_platform(device);
      break;
    case DeviceModel::mckibben:
      print_joint(device);
      break;
  }
}

int command_device_list(const ListOptions& options) {
  nlohmann::ordered_json rigs = nlohmann::ordered_json::array();
  std::string text;
  for (const std::string& name : shipped_names(Resource::device_spec)) {
    const std::filesystem::path file = find_resource(Resource::device_spec, name);
    const RigSpec rig = load_rig_spec(file);
    rigs.push_back(rig_json(rig, file.string()));
    const std::string other = not_shipped_text(rig);
    text += fmt::format("  {}: {}{}\n", bold(printable(rig.name)), printable(rig.title),
                        other.empty() ? "" : warn(printable(" (" + other + ")")));
    for (const DeviceSpec& device : rig.devices)
      text += fmt::format("      {}; at most {}\n", facts_of(device.model).renders, limits_text(device));
  }
  const std::unique_ptr<HidBus> bus = bus_for("", options.rig_file);
  const nlohmann::ordered_json devices = hid_json(*bus);
  if (options.json) {
    print_json({{"rigs", rigs}, {"hid", devices}});
    return exit_code::kDone;
  }
  fmt::print("{}\n  All of them are simulated: models of the papers' devices. A study names one in $.rig.device.\n\n",
             text);
  fmt::print("{}\n{}", bold("Connected"), hid_text(devices));
  if (const std::string absent = bus->absent(); !absent.empty()) fmt::print("  {}\n", warn(printable(absent)));
  return exit_code::kDone;
}

int command_device_info(const InfoOptions& options) {
  if (!names_a_rig(options.rig)) {
    const std::unique_ptr<HidBus> bus = bus_for(options.rig, options.rig_file);
    return hid_device_info(*bus, options.rig, options.json);
  }
  const std::filesystem::path file = find_resource(Resource::device_spec, options.rig);
  const RigSpec rig = load_rig_spec(file);
  if (options.json) {
    print_json(rig_json(rig, file.string()));
    return exit_code::kDone;
  }
  fmt::print("{}: {}\n", bold(printable(rig.name)), printable(rig.title));
  print_field(22, "what", what_it_is(rig));
  print_field(22, "file", printable(file.string()));
  print_field(22, "description", is_shipped(rig) ? "as shipped" : warn(printable(not_shipped_text(rig))));
  print_field(22, "SHA-256", rig.sha256);
  if (rig.devices.size() > 1)
    print_field(22, "lever arm",
                fmt::format("{:g} m from the joint to the contact: 500 N/m there are {:g} N/rad of the joint",
                            rig.lever_arm_m, 500 * rig.lever_arm_m));
  for (const DeviceSpec& device : rig.devices) print_device(device);
  return exit_code::kDone;
}

}  // namespace

void add_device_list(CommandTree& device) {
  const auto [command, options] = device.add("list", "The rigs that there are, and the real devices that are connected",
                                             "jnd device list", command_device_list);
  command.add_option("--rig", options.rig_file, "a rig file: its devices that are programs are listed too");
  command.add_flag("--json", options.json, "machine-readable");
}

void add_device_info(CommandTree& device) {
  const auto [command, options] =
      device.add("info", "Everything a rig's description, or a connected device, says of itself",
                 "jnd device info rrs3\n  jnd device info FT-0001", command_device_info);
  command.add_option("RIG", options.rig, "a rig's name, a file that describes one, or a device's serial number or path")
      .required();
  command.add_option("--rig", options.rig_file, "a rig file: its devices that are programs are looked for too");
  command.add_flag("--json", options.json, "machine-readable");
}

}  // namespace jnd
