#include "devices/hid/report_words.h"

#include <array>
#include <cstring>
#include <span>

#include <fmt/format.h>

namespace jnd {

namespace {

// A field of a report: filled up with zeros, without one where it is full.
std::string field_text(std::span<const char> field) {
  return {field.data(), strnlen(field.data(), field.size())};
}

std::string_view word(std::span<const std::string_view> words, unsigned index) noexcept {
  return index < words.size() ? words[index] : std::string_view("unknown");
}

std::string words_of(std::span<const std::string_view> words, unsigned bits) {
  std::string text;
  for (unsigned bit = 0; bit < words.size(); ++bit)
    if ((bits & (1U << bit)) != 0) text += (text.empty() ? "" : ", ") + std::string(words[bit]);
  return text;
}

constexpr std::array<std::string_view, 6> kFingers = {"any", "thumb", "index", "middle", "ring", "little"};
constexpr std::array<std::string_view, 3> kModels = {"unknown", "3RRS fingertip device", "tracker"};
constexpr std::array<std::string_view, 3> kStates = {"at rest", "active", "stopped"};
constexpr std::array<std::string_view, 5> kPages = {"identity", "limits", "geometry", "force table", "certificate"};
constexpr std::array<std::string_view, 7> kFaults = {"no commands in time (its watchdog)",
                                                     "a sensor does not answer",
                                                     "an actuator does not follow",
                                                     "too hot",
                                                     "battery too low",
                                                     "its stop button",
                                                     "an internal error"};
constexpr std::array<std::string_view, 9> kLimits = {
    "force", "rise of the force", "tilt", "direction", "workspace", "vibration", "burst", "stiffness", "soft start"};
constexpr std::array<std::string_view, 8> kCapabilities = {
    "force", "tilt", "vibration", "damping", "tracking", "buttons", "keeps its calibration", "a model in software"};

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

std::string serial_of(const jnd_identity& identity) {
  return field_text(identity.serial);
}

std::string calibration_id_of(const jnd_identity& identity) {
  return field_text(identity.calibration_id);
}

std::string calibration_id_of(const jnd_certificate& certificate) {
  return field_text(certificate.calibration_id);
}

std::string date_text(std::uint32_t yyyymmdd) {
  if (yyyymmdd == 0) return {};
  return fmt::format("{:04}-{:02}-{:02}", yyyymmdd / 10000, yyyymmdd / 100 % 100, yyyymmdd % 100);
}

std::string firmware_text(const jnd_identity& identity) {
  return fmt::format("{}.{}.{}", identity.firmware[0], identity.firmware[1], identity.firmware[2]);
}

std::string_view finger_word(unsigned finger) noexcept {
  return word(kFingers, finger);
}

std::string_view model_word(unsigned model) noexcept {
  return word(kModels, model);
}

std::string_view state_word(unsigned state) noexcept {
  return word(kStates, state);
}

std::string_view page_word(unsigned page) noexcept {
  return word(kPages, page);
}

std::string fault_words(unsigned bits) {
  return words_of(kFaults, bits);
}

std::string limit_words(unsigned bits) {
  return words_of(kLimits, bits);
}

std::string capability_words(unsigned bits) {
  return words_of(kCapabilities, bits);
}

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
