// jnd device info SERIAL|PATH: what a connected device says of itself, and how it is just now.
#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/calibration/calibration.h"
#include "devices/hid/device_fit.h"
#include "devices/hid/report_words.h"
#include "protocols/input/resources.h"
#include "runner/device_commands/command_device_hid.h"
#include "runner/device_commands/device_output.h"
#include "runner/device_commands/hid_devices.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

struct Known {
  DeviceDescription device;
  double trip_median_ms = 0, trip_longest_ms = 0;
};

// Of requests for the identity page and their answers. They do not disturb a session.
void measure_trips(HidHandle& handle, const std::string& name, Known& known) {
  constexpr int kRequests = 20;
  using Clock = std::chrono::steady_clock;
  PageExchange pages(handle, name);
  std::vector<double> trips_ms;
  for (int i = 0; i < kRequests; ++i) {
    const auto start = Clock::now();
    known.device.identity = pages.identity();
    trips_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  std::sort(trips_ms.begin(), trips_ms.end());
  known.trip_median_ms = trips_ms[trips_ms.size() / 2];
  known.trip_longest_ms = trips_ms.back();
}

Json identity_json(const HidInfo& info, const Known& known) {
  const jnd_identity& identity = known.device.identity;
  return {{"serial", serial_of(identity)},
          {"path", info.path},
          {"usb", usb_id(info)},
          {"transport", info.transport},
          {"name", info.product_name},
          {"model", model_word(identity.model)},
          {"finger", finger_word(identity.finger)},
          {"protocol_versions", {identity.lowest_version, identity.highest_version}},
          {"firmware", firmware_text(identity)},
          {"loop_rate_hz", identity.loop_rate_hz},
          {"watchdog_ms", identity.watchdog_ms},
          {"capabilities", capability_words(identity.capabilities)},
          {"calibration_id", calibration_id_of(identity)},
          {"calibration_date", date_text(identity.calibration_date)},
          {"round_trip_ms", {{"median", known.trip_median_ms}, {"longest", known.trip_longest_ms}}}};
}

// What it lacks of what the shipped description asks of a 3RRS device.
std::string lacks(const DeviceDescription& device) {
  const RigSpec rig = rig_named("rrs3");
  return shortcomings(*rig.cutaneous(), false, device.identity, device.limits);
}

Json limits_json(const DeviceDescription& device) {
  const DeviceSpec spec = spec_of(device.limits, device.geometry, 1e9);
  return {{"max_force_n", spec.max_force_n},
          {"max_force_rise_n_per_s", 1e-3 * device.limits.most_force_rise_mn_per_s},
          {"soft_start_s", 1e-3 * device.limits.soft_start_ms},
          {"max_stiffness_n_per_m", spec.max_stiffness},
          {"max_damping_n_s_per_m", 1e-2 * device.limits.most_damping_cn_s_per_m},
          {"lowest_m", spec.lowest_travel},
          {"highest_m", spec.highest_travel},
          {"max_roll_rad", spec.max_roll_rad},
          {"max_pitch_rad", spec.max_pitch_rad},
          {"max_joint_speed_rad_per_s", spec.max_joint_speed_rad_per_s},
          {"vibration_g", {spec.min_vibration_g, spec.max_vibration_g}},
          {"vibration_hz", {spec.min_vibration_hz, spec.max_vibration_hz}},
          {"max_burst_s", 1e-3 * device.limits.most_burst_ms},
          {"max_temperature_c", 1e-2 * device.limits.most_temperature_cdeg}};
}

Json geometry_json(const jnd_geometry& geometry) {
  return {{"a_m", 1e-9 * geometry.a_nm},
          {"b_m", 1e-9 * geometry.b_nm},
          {"bh_m", 1e-9 * geometry.bh_nm},
          {"bd_m", 1e-9 * geometry.bd_nm},
          {"l1_m", 1e-9 * geometry.l1_nm},
          {"l2_m", 1e-9 * geometry.l2_nm},
          {"rest_z_m", 1e-9 * geometry.rest_height_nm}};
}

Json state_json(const DeviceDescription& device) {
  if (device.reports == 0) return nullptr;
  const jnd_telemetry& now = device.telemetry;
  return {{"state", state_word(now.state)},
          {"faults", fault_words(now.faults)},
          {"force_n", 1e-6 * now.force_un},
          {"temperature_c",
           now.temperature_cdeg == JND_TEMPERATURE_NONE ? Json(nullptr) : Json(0.01 * now.temperature_cdeg)},
          {"battery_percent", now.battery_percent == JND_BATTERY_NONE ? Json(nullptr) : Json(now.battery_percent)},
          {"commands_rejected", now.rejected}};
}

Json fingertip_json(const HidInfo& info, const Known& known) {
  Json out = identity_json(info, known);
  const ForceTable table = from_report(known.device.table);
  out["limits"] = limits_json(known.device);
  out["geometry"] = geometry_json(known.device.geometry);
  out["force_table"] = {{"sensor_n", table.sensor_n}, {"force_n", table.force_n}};
  out["now"] = state_json(known.device);
  out["lacks_for_rrs3"] = lacks(known.device);
  return out;
}

void print_identity(const HidInfo& info, const Known& known) {
  const jnd_identity& identity = known.device.identity;
  fmt::print("{}: {}, finger: {}\n", bold(printable(serial_of(identity))), model_word(identity.model),
             finger_word(identity.finger));
  print_field(15, "connected", printable(fmt::format("{}, {} {}", info.path, way_to(info), info.product_name)));
  print_field(15, "protocol",
              fmt::format("versions {} to {}; this program speaks {}", identity.lowest_version,
                          identity.highest_version, int{JND_PROTOCOL_VERSION}));
  print_field(
      15, "firmware",
      fmt::format("{}, {} Hz, watchdog {} ms", firmware_text(identity), identity.loop_rate_hz, identity.watchdog_ms));
  print_field(15, "can", capability_words(identity.capabilities));
  print_field(15, "round trip",
              fmt::format("median {:.2f} ms, longest {:.2f} ms, of a request and its answer", known.trip_median_ms,
                          known.trip_longest_ms));
}

void print_fingertip(const DeviceDescription& device) {
  const jnd_identity& identity = device.identity;
  const DeviceSpec spec = spec_of(device.limits, device.geometry, 1e9);
  const std::string id = calibration_id_of(identity);
  print_field(15, "calibrated",
              id.empty() ? "never" : fmt::format("{}, certificate {}", date_text(identity.calibration_date), id));
  print_field(15, "force table",
              device.table.points == 0 ? std::string("none: the force is as the sensor says")
                                       : fmt::format("{} points", device.table.points));
  print_field(15, "force",
              fmt::format("at most {:g} N, rising by at most {:g} N/s, let in over {} ms", spec.max_force_n,
                          1e-3 * device.limits.most_force_rise_mn_per_s, device.limits.soft_start_ms));
  print_field(15, "stiffness",
              fmt::format("at most {:g} N/m, damping {:g} N s/m", spec.max_stiffness,
                          1e-2 * device.limits.most_damping_cn_s_per_m));
  print_field(15, "stroke",
              fmt::format("{:g} mm: platform at {:g} to {:g} mm, at rest {:g} mm", 1e3 * spec.stroke_m,
                          1e3 * spec.lowest_travel, 1e3 * spec.highest_travel, 1e3 * spec.rest_z_m));
  print_field(15, "roll, pitch",
              fmt::format("± {}, ± {}", angle_text(spec.max_roll_rad), angle_text(spec.max_pitch_rad)));
  print_field(15, "vibration",
              fmt::format("{:g} to {:g} g, {:g} to {:g} Hz, at most {} ms", spec.min_vibration_g, spec.max_vibration_g,
                          spec.min_vibration_hz, spec.max_vibration_hz, device.limits.most_burst_ms));
  print_field(15, "geometry",
              fmt::format("a {:g}, b {:g}, bh {:g}, bd {:.4g}, l1 {:g}, l2 {:g} mm", 1e3 * spec.a_m, 1e3 * spec.b_m,
                          1e3 * spec.bh_m, 1e3 * spec.bd_m, 1e3 * spec.l1_m, 1e3 * spec.l2_m));
  const std::string lacking = lacks(device);
  print_field(15, "for rrs3", lacking.empty() ? "can do what a study with rrs3 asks" : "LACKS " + lacking);
  if (device.reports == 0) {
    print_field(15, "now", "no telemetry came");
    return;
  }
  const jnd_telemetry& now = device.telemetry;
  std::string text = fmt::format("{}, {:.3f} N", state_word(now.state), 1e-6 * now.force_un);
  if (now.temperature_cdeg != JND_TEMPERATURE_NONE) text += fmt::format(", {:.1f} C", 0.01 * now.temperature_cdeg);
  text +=
      now.battery_percent == JND_BATTERY_NONE ? ", on the cable" : fmt::format(", battery {} %", now.battery_percent);
  print_field(15, "now", text);
  print_field(15, "faults", now.faults == 0 ? "none" : fault_words(now.faults));
}

}  // namespace

int hid_device_info(HidBus& bus, const std::string& name, bool json) {
  const HidInfo info = find_device(bus, name);
  Known known;
  with_device(bus, info, [&](HidHandle& handle) {
    if (!is_tracker(info)) known.device = describe(handle, name);
    measure_trips(handle, name, known);
  });
  if (json) {
    print_json(is_tracker(info) ? identity_json(info, known) : fingertip_json(info, known));
    return exit_code::kDone;
  }
  print_identity(info, known);
  if (!is_tracker(info)) print_fingertip(known.device);
  return exit_code::kDone;
}

}  // namespace jnd
