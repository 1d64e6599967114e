#include "protocols/rigs/device_description.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/input/number_from.h"
#include "protocols/input/read_file.h"
#include "protocols/rigs/device_models.h"

namespace jnd {

MckibbenParameters read_mckibben_parameters(const JsonNode& node, std::vector<Diagnostic>& diagnostics,
                                            const std::string& file) {
  constexpr NumberLimits kLength{.min = 0, .max = 0.5, .above = true, .unit = "m"};
  constexpr NumberLimits kOffset{.min = -0.5, .max = 0.5, .unit = "m"};
  MckibbenParameters p;
  JsonReader reader(node, diagnostics, file);
  p.l1_m = reader.number("l1_m", kLength);
  p.l2_m = reader.number("l2_m", kLength);
  p.d2_m = reader.number("d2_m", kLength);
  p.g2_m = reader.number("g2_m", kOffset);
  p.h2_m = reader.number("h2_m", kOffset);
  p.l4_m = reader.number("l4_m", kLength);
  p.l5max_m = reader.number("l5max_m", kLength);
  p.h0_m = reader.number("h0_m", kLength);
  p.hx_m = reader.number("hx_m", kOffset);
  p.hx1_m = reader.number("hx1_m", kOffset);
  p.mc_kg = reader.number("mc_kg", {.min = 0, .max = 2, .unit = "kg"});

  p.km_n_per_m = reader.number("km_n_per_m", {.min = 0, .max = 1e5, .unit = "N/m"});
  p.fm0_n = reader.number("fm0_n", {.min = 0, .max = 1000, .unit = "N"});
  p.catt1_m = reader.number("catt1_m", {.min = 0, .max = 0.5, .unit = "m"});

  p.l0_m = reader.number("l0_m", kLength);
  p.li_m = reader.number("li_m", kLength);
  p.ri_m = reader.number("ri_m", {.min = 0, .max = 0.1, .above = true, .unit = "m"});
  p.si_m = reader.number("si_m", {.min = 0, .max = 0.1, .above = true, .unit = "m"});
  p.nt = reader.number("nt", {.min = 0, .max = 100, .above = true, .unit = "turns"});
  p.h_fibre_m = reader.number("h_fibre_m", kLength);
  p.e_pa = reader.number("e_pa", {.min = 0, .max = 1e9, .above = true, .unit = "Pa"});

  p.kv_pa_per_v = reader.number("kv_pa_per_v", {.min = 0, .max = 1e6, .above = true, .unit = "Pa/V"});
  p.zeta = reader.number("zeta", {.min = 0, .max = 10, .above = true});
  p.sigma_n_rad_per_s = reader.number("sigma_n_rad_per_s", {.min = 0, .max = 1000, .above = true, .unit = "rad/s"});
  p.valve_min_v = reader.number("valve_min_v", {.min = 0, .max = 100, .unit = "V"});
  p.valve_max_v = reader.number("valve_max_v", {.min = 0, .max = 100, .above = true, .unit = "V"});
  p.c_m3_per_s_pa = reader.number("c_m3_per_s_pa", {.min = 0, .max = 1e-6, .above = true, .unit = "m3/(s Pa)"});
  p.b = reader.number("b", {.min = 0, .max = 0.9});

  p.rho0_kg_per_m3 = reader.number("rho0_kg_per_m3", {.min = 0, .max = 10, .above = true, .unit = "kg/m3"});
  p.r_j_per_kg_k = reader.number("r_j_per_kg_k", {.min = 0, .max = 5000, .above = true, .unit = "J/(kg K)"});
  p.temperature_k = reader.number("temperature_k", {.min = 200, .max = 400, .unit = "K"});
  p.p_atm_pa = reader.number("p_atm_pa", {.min = 3e4, .max = 1.2e5, .unit = "Pa"});
  p.g_m_per_s2 = reader.number("g_m_per_s2", {.min = 0, .max = 20, .unit = "m/s2"});
  if (p.valve_max_v <= p.valve_min_v && is_sound(diagnostics, node.path))
    reader.error("valve_max_v", "is not above valve_min_v", "swap them");
  if (p.h_fibre_m <= p.l0_m - p.catt1_m && is_sound(diagnostics, node.path))
    reader.error("h_fibre_m", "is not above l0_m - catt1_m, the muscle's greatest length", "check the lengths");
  reader.finish();
  return p;
}

namespace {

enum class Zero { refused, allowed };

// A limit of the device; one beyond the model's hard limit is an error.
double read_limit(JsonReader& reader, std::string_view key, double hard, std::string_view unit,
                  Zero zero = Zero::refused) {
  const double value = reader.number(key, {.min = 0, .above = zero == Zero::refused, .unit = unit});
  if (value > hard)
    reader.error(
        key, fmt::format("{:g} {} is more than a device of this model is ever given, {:g} {}", value, unit, hard, unit),
        fmt::format("a description may lower this limit and never raise it: give {:g} {} or less", hard, unit));
  return value;
}

void read_rrs3_limits(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file,
                      DeviceSpec& spec) {
  constexpr HardLimits kHard = hard_limits(DeviceModel::rrs3);
  JsonReader reader(node, diagnostics, file);
  spec.max_force_n = read_limit(reader, "max_force_n", kHard.force_n, "N");
  spec.stroke_m = read_limit(reader, "stroke_m", kHard.stroke_m, "m");
  spec.max_roll_rad = read_limit(reader, "max_roll_rad", kHard.roll_rad, "rad", Zero::allowed);
  spec.max_pitch_rad = read_limit(reader, "max_pitch_rad", kHard.pitch_rad, "rad", Zero::allowed);
  spec.max_joint_speed_rad_per_s =
      read_limit(reader, "max_joint_speed_rad_per_s", kHard.joint_speed_rad_per_s, "rad/s");
  spec.min_vibration_g = reader.number("min_vibration_g", {.min = 0, .max = 10, .unit = "g"});
  spec.max_vibration_g = read_limit(reader, "max_vibration_g", kHard.vibration_g, "g", Zero::allowed);
  spec.min_vibration_hz = reader.number("min_vibration_hz", {.min = 0, .max = 2000, .unit = "Hz"});
  spec.max_vibration_hz = read_limit(reader, "max_vibration_hz", kHard.vibration_hz, "Hz", Zero::allowed);
  spec.max_stiffness = read_limit(reader, "max_stiffness_n_per_m", kHard.stiffness, "N/m");
  if (spec.max_vibration_g < spec.min_vibration_g && is_sound(diagnostics, node.path))
    reader.error("max_vibration_g", "is below min_vibration_g", "swap them");
  if (spec.max_vibration_hz < spec.min_vibration_hz && is_sound(diagnostics, node.path))
    reader.error("max_vibration_hz", "is below min_vibration_hz", "swap them");
  reader.finish();
}

void read_geometry(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file,
                   DeviceSpec& spec) {
  constexpr NumberLimits kLength{.min = 0, .max = 0.2, .above = true, .unit = "m"};
  JsonReader reader(node, diagnostics, file);
  spec.a_m = reader.number("a_m", kLength);
  spec.b_m = reader.number("b_m", kLength);
  spec.bh_m = reader.number("bh_m", kLength);
  spec.bd_m = reader.number("bd_m", kLength);
  spec.l1_m = reader.number("l1_m", kLength);
  spec.l2_m = reader.number("l2_m", kLength);
  // The platform lies below the body.
  spec.rest_z_m = reader.number("rest_z_m", {.min = -0.2, .max = 0, .unit = "m"});
  reader.finish();
}

void read_rrs3(JsonReader& reader, std::vector<Diagnostic>& diagnostics, const std::string& file, DeviceSpec& spec) {
  spec.model = DeviceModel::rrs3;
  if (const JsonNode* limits = reader.object("limits")) read_rrs3_limits(*limits, diagnostics, file, spec);
  if (const JsonNode* geometry = reader.object("geometry")) read_geometry(*geometry, diagnostics, file, spec);
  spec.lowest_travel = spec.rest_z_m - spec.stroke_m / 2;
  spec.highest_travel = spec.rest_z_m + spec.stroke_m / 2;
}

void read_mckibben_limits(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file,
                          DeviceSpec& spec) {
  constexpr NumberLimits kAngle{.min = 0, .max = std::numbers::pi, .unit = "rad"};
  constexpr HardLimits kHard = hard_limits(DeviceModel::mckibben);
  JsonReader reader(node, diagnostics, file);
  spec.max_force_n = read_limit(reader, "max_force_n", kHard.force_n, "N");
  spec.lowest_travel = reader.number("min_angle_rad", kAngle);
  spec.highest_travel = reader.number("max_angle_rad", kAngle);
  spec.max_stiffness = read_limit(reader, "max_stiffness_n_per_rad", kHard.stiffness, "N/rad");
  if (spec.highest_travel <= spec.lowest_travel && is_sound(diagnostics, node.path))
    reader.error("max_angle_rad", "is not above min_angle_rad", "swap them");
  reader.finish();
}

void read_sensors(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file,
                  DeviceSpec& spec) {
  JsonReader reader(node, diagnostics, file);
  spec.sensors.force_noise_sd_n = reader.number_or("force_noise_sd_n", 0, {.min = 0, .max = 10, .unit = "N"});
  spec.sensors.force_resolution_n = reader.number_or("force_resolution_n", 0, {.min = 0, .max = 10, .unit = "N"});
  if (facts_of(spec.model).acts_on_joint)
    spec.sensors.encoder_pulses = reader.number_or("encoder_pulses", 0, {.min = 0, .max = 1e7});
  reader.finish();
}

// "2026-03-01", a day that exists.
std::optional<std::chrono::sys_days> date_from(std::string_view text) {
  constexpr std::string_view kForm = "0000-00-00";
  const bool formed = text.size() == kForm.size() &&
                      std::equal(text.begin(), text.end(), kForm.begin(),
                                 [](char c, char form) { return form == '0' ? c >= '0' && c <= '9' : c == form; });
  if (!formed) return std::nullopt;
  const auto number = [&](std::size_t from, std::size_t length) {
    return number_from<unsigned>(text.substr(from, length)).value_or(0);
  };
  const std::chrono::year_month_day day(std::chrono::year(static_cast<int>(number(0, 4))),
                                        std::chrono::month(number(5, 2)), std::chrono::day(number(8, 2)));
  if (!day.ok()) return std::nullopt;
  return std::chrono::sys_days(day);
}

void read_calibration(JsonReader& reader, DeviceSpec& spec) {
  const std::optional<std::string> date = reader.optional_text("calibrated", {.max_length = 10});
  const std::optional<double> valid_days =
      reader.optional_number("calibration_valid_days", {.min = 0, .max = 100'000, .above = true, .unit = "days"});
  if (!date) {
    if (valid_days) reader.error("calibration_valid_days", "counts from no day", "give \"calibrated\" too");
    return;
  }
  const std::optional<std::chrono::sys_days> day = date_from(*date);
  if (!day) {
    reader.error("calibrated", "is not a day", "write it as year, month and day, such as \"2026-03-01\"");
    return;
  }
  spec.calibration = Calibration{*day, valid_days};
}

void read_gains(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file, DeviceSpec& spec) {
  JsonReader reader(node, diagnostics, file);
  spec.gains.kp = reader.number("kp", {.min = 0, .max = 10, .unit = "V/N"});
  spec.gains.ki = reader.number("ki", {.min = 0, .max = 1000, .unit = "V/(N s)"});
  spec.gains.kd = reader.number("kd", {.min = 0, .max = 10, .unit = "V s/N"});
  if (spec.gains.kp + spec.gains.ki <= 0 && is_sound(diagnostics, node.path))
    reader.error("kp", "is 0, as is ki: the controller would do nothing", "give a positive kp, such as 0.28");
  reader.finish();
}

void read_mckibben(JsonReader& reader, std::vector<Diagnostic>& diagnostics, const std::string& file,
                   DeviceSpec& spec) {
  spec.model = DeviceModel::mckibben;
  if (const JsonNode* limits = reader.object("limits")) read_mckibben_limits(*limits, diagnostics, file, spec);
  if (const JsonNode* finger = reader.object("finger"))
    spec.finger = read_mckibben_parameters(*finger, diagnostics, file);
  if (const JsonNode* control = reader.object("control")) read_gains(*control, diagnostics, file, spec);
  spec.tendon = reader.one_of("tendon", kTendonWords);
  spec.lever_arm_m = reader.number("lever_arm_m", {.min = 0, .max = 0.3, .above = true, .unit = "m"});
}

}  // namespace

DeviceSpec load_device_spec(const std::filesystem::path& path) {
  const std::string file = path.string();
  const JsonNode root = parse_json(read_input_file(path), file);
  std::vector<Diagnostic> diagnostics;
  DeviceSpec spec;
  JsonReader reader(root, diagnostics, file);
  reader.ignore("$schema");
  reader.ignore("notes");
  reader.integer("format", {.min = 1, .max = 1});
  spec.name = reader.text("name", {.max_length = 16});
  spec.title = reader.text("title", {.max_length = 200});
  if (root.find("finger") != nullptr)
    read_mckibben(reader, diagnostics, file, spec);
  else
    read_rrs3(reader, diagnostics, file, spec);
  spec.unit = facts_of(spec.model).unit;
  if (const JsonNode* sensors = reader.object_or_null("sensors")) read_sensors(*sensors, diagnostics, file, spec);
  read_calibration(reader, spec);
  reader.finish();
  if (!diagnostics.empty()) throw InputError(std::move(diagnostics));
  return spec;
}

std::string_view to_string(Tendon tendon) noexcept {
  return word_of(kTendonWords, tendon);
}

}  // namespace jnd
