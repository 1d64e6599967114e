// The structures of the report codec by the names of their members, and their encoders and decoders by one name: so
// that a test can be written once for all ten.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "devices/hid/firmware/jnd_report.h"

namespace jnd::codec {

template <typename Visit>
void visit_members(jnd_command& of, Visit&& visit) {
  visit("mode", of.mode);
  visit("touching", of.touching);
  visit("sequence", of.sequence);
  visit("contact_point_nm", of.contact_point_nm);
  visit("normal", of.normal);
  visit("penetration_nm", of.penetration_nm);
  visit("penetration_rate_um_per_s", of.penetration_rate_um_per_s);
  visit("stiffness_mn_per_m", of.stiffness_mn_per_m);
  visit("most_force_un", of.most_force_un);
  visit("damping_cn_s_per_m", of.damping_cn_s_per_m);
  visit("roll_dmrad", of.roll_dmrad);
  visit("pitch_dmrad", of.pitch_dmrad);
  visit("vibration_mg", of.vibration_mg);
  visit("vibration_dhz", of.vibration_dhz);
}

template <typename Visit>
void visit_members(jnd_telemetry& of, Visit&& visit) {
  visit("state", of.state);
  visit("buttons", of.buttons);
  visit("sequence", of.sequence);
  visit("command_sequence", of.command_sequence);
  visit("time_us", of.time_us);
  visit("joint_urad", of.joint_urad);
  visit("force_un", of.force_un);
  visit("height_nm", of.height_nm);
  visit("roll_dmrad", of.roll_dmrad);
  visit("pitch_dmrad", of.pitch_dmrad);
  visit("yaw_dmrad", of.yaw_dmrad);
  visit("vibration_mg", of.vibration_mg);
  visit("faults", of.faults);
  visit("limits", of.limits);
  visit("rejected", of.rejected);
  visit("command_age_us", of.command_age_us);
  visit("temperature_cdeg", of.temperature_cdeg);
  visit("battery_percent", of.battery_percent);
}

template <typename Visit>
void visit_members(jnd_pose& of, Visit&& visit) {
  visit("finger", of.finger);
  visit("seen", of.seen);
  visit("has_flexion", of.has_flexion);
  visit("sequence", of.sequence);
  visit("time_us", of.time_us);
  visit("position_nm", of.position_nm);
  visit("orientation", of.orientation);
  visit("flexion_urad", of.flexion_urad);
}

template <typename Visit>
void visit_members(jnd_request& of, Visit&& visit) {
  visit("operation", of.operation);
  visit("page", of.page);
  visit("token", of.token);
  visit("data", of.data);
}

template <typename Visit>
void visit_members(jnd_answer& of, Visit&& visit) {
  visit("result", of.result);
  visit("page", of.page);
  visit("token", of.token);
  visit("data", of.data);
}

template <typename Visit>
void visit_members(jnd_identity& of, Visit&& visit) {
  visit("lowest_version", of.lowest_version);
  visit("highest_version", of.highest_version);
  visit("model", of.model);
  visit("finger", of.finger);
  visit("degrees_of_freedom", of.degrees_of_freedom);
  visit("firmware", of.firmware);
  visit("loop_rate_hz", of.loop_rate_hz);
  visit("capabilities", of.capabilities);
  visit("serial", of.serial);
  visit("calibration_id", of.calibration_id);
  visit("calibration_date", of.calibration_date);
  visit("watchdog_ms", of.watchdog_ms);
}

template <typename Visit>
void visit_members(jnd_limits& of, Visit&& visit) {
  visit("most_force_un", of.most_force_un);
  visit("most_stiffness_mn_per_m", of.most_stiffness_mn_per_m);
  visit("most_force_rise_mn_per_s", of.most_force_rise_mn_per_s);
  visit("lowest_height_nm", of.lowest_height_nm);
  visit("highest_height_nm", of.highest_height_nm);
  visit("most_roll_dmrad", of.most_roll_dmrad);
  visit("most_pitch_dmrad", of.most_pitch_dmrad);
  visit("most_joint_speed_mrad_per_s", of.most_joint_speed_mrad_per_s);
  visit("least_vibration_mg", of.least_vibration_mg);
  visit("most_vibration_mg", of.most_vibration_mg);
  visit("least_vibration_dhz", of.least_vibration_dhz);
  visit("most_vibration_dhz", of.most_vibration_dhz);
  visit("most_burst_ms", of.most_burst_ms);
  visit("most_damping_cn_s_per_m", of.most_damping_cn_s_per_m);
  visit("most_temperature_cdeg", of.most_temperature_cdeg);
  visit("soft_start_ms", of.soft_start_ms);
}

template <typename Visit>
void visit_members(jnd_geometry& of, Visit&& visit) {
  visit("a_nm", of.a_nm);
  visit("b_nm", of.b_nm);
  visit("bh_nm", of.bh_nm);
  visit("bd_nm", of.bd_nm);
  visit("l1_nm", of.l1_nm);
  visit("l2_nm", of.l2_nm);
  visit("rest_height_nm", of.rest_height_nm);
}

template <typename Visit>
void visit_members(jnd_force_table& of, Visit&& visit) {
  visit("points", of.points);
  visit("sensor_un", of.sensor_un);
  visit("force_un", of.force_un);
}

template <typename Visit>
void visit_members(jnd_certificate& of, Visit&& visit) {
  visit("calibration_id", of.calibration_id);
  visit("date", of.date);
}

template <typename Record, auto kEncode, auto kDecode>
struct ReportCodec {
  static constexpr std::size_t kSize = JND_REPORT_SIZE;
  static constexpr bool kIsReport = true;
  static void encode(const Record& record, std::uint8_t* bytes) { kEncode(&record, bytes); }
  static jnd_decode_result decode(const std::uint8_t* bytes, std::size_t count, Record& record) {
    return kDecode(bytes, count, &record);
  }
};

// A page has no length of its own: `bytes` are JND_PAGE_SIZE.
template <typename Record, auto kEncode, auto kDecode>
struct PageCodec {
  static constexpr std::size_t kSize = JND_PAGE_SIZE;
  static constexpr bool kIsReport = false;
  static void encode(const Record& record, std::uint8_t* bytes) { kEncode(&record, bytes); }
  static jnd_decode_result decode(const std::uint8_t* bytes, std::size_t /*count*/, Record& record) {
    return kDecode(bytes, &record) ? JND_DECODE_OK : JND_DECODE_RANGE;
  }
};

template <typename Record>
struct Codec;

template <>
struct Codec<jnd_command> : ReportCodec<jnd_command, jnd_encode_command, jnd_decode_command> {
  static constexpr std::string_view kKind = "command";
  static constexpr std::uint8_t kId = JND_REPORT_COMMAND;
};
template <>
struct Codec<jnd_telemetry> : ReportCodec<jnd_telemetry, jnd_encode_telemetry, jnd_decode_telemetry> {
  static constexpr std::string_view kKind = "telemetry";
  static constexpr std::uint8_t kId = JND_REPORT_TELEMETRY;
};
template <>
struct Codec<jnd_pose> : ReportCodec<jnd_pose, jnd_encode_pose, jnd_decode_pose> {
  static constexpr std::string_view kKind = "pose";
  static constexpr std::uint8_t kId = JND_REPORT_TRACKER;
};
template <>
struct Codec<jnd_request> : ReportCodec<jnd_request, jnd_encode_request, jnd_decode_request> {
  static constexpr std::string_view kKind = "request";
  static constexpr std::uint8_t kId = JND_REPORT_REQUEST;
};
template <>
struct Codec<jnd_answer> : ReportCodec<jnd_answer, jnd_encode_answer, jnd_decode_answer> {
  static constexpr std::string_view kKind = "answer";
  static constexpr std::uint8_t kId = JND_REPORT_PAGE;
};
template <>
struct Codec<jnd_identity> : PageCodec<jnd_identity, jnd_encode_identity, jnd_decode_identity> {
  static constexpr std::string_view kKind = "identity";
};
template <>
struct Codec<jnd_limits> : PageCodec<jnd_limits, jnd_encode_limits, jnd_decode_limits> {
  static constexpr std::string_view kKind = "limits";
};
template <>
struct Codec<jnd_geometry> : PageCodec<jnd_geometry, jnd_encode_geometry, jnd_decode_geometry> {
  static constexpr std::string_view kKind = "geometry";
};
template <>
struct Codec<jnd_force_table> : PageCodec<jnd_force_table, jnd_encode_force_table, jnd_decode_force_table> {
  static constexpr std::string_view kKind = "force_table";
};
template <>
struct Codec<jnd_certificate> : PageCodec<jnd_certificate, jnd_encode_certificate, jnd_decode_certificate> {
  static constexpr std::string_view kKind = "certificate";
};

// Calls use(Codec<Record>{}, Record{}) for each kind.
template <typename Use>
void for_each_report(Use&& use) {
  use(Codec<jnd_command>{}, jnd_command{});
  use(Codec<jnd_telemetry>{}, jnd_telemetry{});
  use(Codec<jnd_pose>{}, jnd_pose{});
  use(Codec<jnd_request>{}, jnd_request{});
  use(Codec<jnd_answer>{}, jnd_answer{});
}

template <typename Use>
void for_each_page(Use&& use) {
  use(Codec<jnd_identity>{}, jnd_identity{});
  use(Codec<jnd_limits>{}, jnd_limits{});
  use(Codec<jnd_geometry>{}, jnd_geometry{});
  use(Codec<jnd_force_table>{}, jnd_force_table{});
  use(Codec<jnd_certificate>{}, jnd_certificate{});
}

template <typename Use>
void for_each_kind(Use&& use) {
  for_each_report(use);
  for_each_page(use);
}

}  // namespace jnd::codec
