#include "devices/hid/report_units.h"

namespace jnd {

namespace {

constexpr double kNano = 1e-9, kMicro = 1e-6, kMilli = 1e-3, kCenti = 1e-2, kDeci = 1e-1;
constexpr double kTenthMilli = 1e-4;
constexpr double kUnitPart = 1.0 / static_cast<double>(static_cast<int>(JND_NORMAL_ONE));
constexpr double kPlainContact_n_per_m = 1000;

bool finite(const DeviceCommand& command) noexcept {
  const double sum = command.force_n + command.stiffness_n_per_m + command.normal.sum() + command.roll_rad +
                     command.pitch_rad + command.vibration_g + command.vibration_hz + command.penetration_m +
                     command.penetration_rate_m_per_s + command.damping_n_s_per_m + command.contact_point_m.sum();
  return std::isfinite(sum);
}

void put_contact(const DeviceCommand& command, jnd_command& out, bool& number) noexcept {
  out.touching = true;
  for (int i = 0; i < 3; ++i) {
    out.contact_point_nm[i] = to_field<std::int32_t>(command.contact_point_m[i], kNano, number);
    out.normal[i] = to_field<std::int32_t>(command.normal[i], kUnitPart, number);
  }
  out.penetration_nm = to_field<std::uint32_t>(command.penetration_m, kNano, number);
  out.penetration_rate_um_per_s = to_field<std::int32_t>(command.penetration_rate_m_per_s, kMicro, number);
  out.stiffness_mn_per_m = to_field<std::uint32_t>(command.stiffness_n_per_m, kMilli, number);
  out.most_force_un = to_field<std::uint32_t>(command.force_n, kMicro, number);
  out.damping_cn_s_per_m = to_field<std::uint16_t>(command.damping_n_s_per_m, kCenti, number);
}

}  // namespace

jnd_mode report_mode(RenderingMode mode) noexcept {
  switch (mode) {
    case RenderingMode::wrench:
      return JND_MODE_WRENCH;
    case RenderingMode::pd:
      return JND_MODE_PD;
    case RenderingMode::pd_literal:
      return JND_MODE_PD_LITERAL;
  }
  return JND_MODE_REST;
}

bool to_report(const DeviceCommand& command, RenderingMode mode, jnd_command& out) noexcept {
  out = jnd_command{};
  bool number = finite(command);
  if (!number) return false;
  out.mode = static_cast<std::uint8_t>(report_mode(mode));
  if (command.stiffness_n_per_m > 0 && command.penetration_m > 0) {
    put_contact(command, out, number);
  } else if (command.force_n > 0) {
    DeviceCommand plain = command;
    plain.stiffness_n_per_m = kPlainContact_n_per_m;
    plain.penetration_m = command.force_n / kPlainContact_n_per_m;
    plain.penetration_rate_m_per_s = plain.damping_n_s_per_m = 0;
    put_contact(plain, out, number);
  }
  out.roll_dmrad = to_field<std::int16_t>(command.roll_rad, kTenthMilli, number);
  out.pitch_dmrad = to_field<std::int16_t>(command.pitch_rad, kTenthMilli, number);
  out.vibration_mg = to_field<std::uint16_t>(command.vibration_g, kMilli, number);
  out.vibration_dhz = to_field<std::uint16_t>(command.vibration_hz, kDeci, number);
  if (!number) out = jnd_command{};
  return number;
}

DeviceReading to_reading(const jnd_telemetry& telemetry, std::int64_t time_ns) noexcept {
  DeviceReading reading;
  reading.time_ns = time_ns;
  reading.force_n = kMicro * telemetry.force_un;
  reading.vibration_g = kMilli * telemetry.vibration_mg;
  reading.travel = kNano * telemetry.height_nm;
  const double yaw_rad = kTenthMilli * telemetry.yaw_dmrad;
  reading.platform = {.pz_m = reading.travel,
                      .roll_rad = kTenthMilli * telemetry.roll_dmrad,
                      .pitch_rad = kTenthMilli * telemetry.pitch_dmrad,
                      .sin_yaw = std::sin(yaw_rad),
                      .cos_yaw = std::cos(yaw_rad)};
  return reading;
}

}  // namespace jnd
