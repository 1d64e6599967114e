// Whatever the protocol allows, for rapidcheck: every field over its whole range, the ends more often than chance.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <type_traits>

#include <rapidcheck.h>

#include "tests/devices/hid/firmware/codec_members.h"

namespace jnd::codec {

namespace detail {

// From least to most, both included, whatever size rapidcheck has come to.
inline int pick(int least, int most) {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(least, most + 1));
}

template <typename Number>
Number any_number() {
  using Limits = std::numeric_limits<Number>;
  if (pick(0, 7) == 0) return *rc::gen::element<Number>(Limits::min(), Limits::max(), Number{0}, Number{1});
  return static_cast<Number>(*rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint64_t>()));
}

template <typename Number>
void set_any(Number& value) {
  if constexpr (std::is_same_v<Number, bool>)
    value = pick(0, 1) == 1;
  else
    value = any_number<Number>();
}

template <typename Element, std::size_t kCount>
void set_any(Element (&values)[kCount]) {
  if constexpr (std::is_same_v<Element, char>) {
    const int length = pick(0, static_cast<int>(kCount));
    for (std::size_t i = 0; i < kCount; ++i)
      values[i] = static_cast<int>(i) < length ? static_cast<char>(pick('!', '~')) : '\0';
  } else {
    for (Element& value : values) set_any(value);
  }
}

inline std::uint8_t number_up_to(int most, int least = 0) {
  return static_cast<std::uint8_t>(pick(least, most));
}

inline std::uint32_t any_date() {
  if (pick(0, 3) == 0) return 0;
  return static_cast<std::uint32_t>(pick(2000, 9999) * 10000 + pick(1, 12) * 100 + pick(1, 31));
}

// Distinct and rising.
inline void rise(std::int32_t* values, int count) {
  std::sort(values, values + count);
  for (int i = 1; i < count; ++i)
    if (values[i] <= values[i - 1]) {
      for (int j = 0; j < count; ++j) values[j] = j - count;
      return;
    }
}

inline void within(jnd_command& of) {
  of.mode = number_up_to(JND_MODE_PD_LITERAL);
}

inline void within(jnd_telemetry& of) {
  of.state = number_up_to(JND_STATE_STOPPED);
  of.faults &= JND_FAULT_BITS;
  of.limits &= JND_LIMIT_BITS;
  if (of.battery_percent > 100) of.battery_percent = JND_BATTERY_NONE;
}

inline void within(jnd_pose& of) {
  of.finger = number_up_to(JND_LITTLE, JND_THUMB);
  if (!of.seen) of.has_flexion = false;
  if (!of.has_flexion) of.flexion_urad = 0;
  if (!of.seen) std::fill(std::begin(of.position_nm), std::end(of.position_nm), 0);
  constexpr double kOne = JND_NORMAL_ONE;
  double q[4] = {}, square = 0;
  for (double& part : q) {
    part = pick(-1000, 1000);
    square += part * part;
  }
  if (square == 0) q[0] = square = 1;
  const double length = 1 + 9e-4 * pick(-10, 10) / 10.0;  // nearly as far off as is allowed
  for (int i = 0; i < 4; ++i)
    of.orientation[i] = of.seen ? static_cast<std::int32_t>(std::lround(q[i] / std::sqrt(square) * length * kOne)) : 0;
}

inline void within(jnd_request& of) {
  of.operation = number_up_to(JND_WRITE_PAGE);
}

inline void within(jnd_answer& of) {
  of.result = number_up_to(JND_PAGE_INVALID);
}

inline void within(jnd_identity& of) {
  of.lowest_version = number_up_to(255, 1);
  of.highest_version = number_up_to(255, of.lowest_version);
  of.model = number_up_to(JND_MODEL_TRACKER, JND_MODEL_RRS3);
  of.finger = number_up_to(JND_LITTLE);
  if (of.loop_rate_hz == 0) of.loop_rate_hz = 1;
  of.capabilities &= JND_CAPABILITY_BITS;
  if (of.serial[0] == '\0') of.serial[0] = 'S';
  of.calibration_date = any_date();
}

template <typename Number>
void put_in_order(Number& low, Number& high) {
  if (low > high) std::swap(low, high);
}

inline void within(jnd_limits& of) {
  put_in_order(of.lowest_height_nm, of.highest_height_nm);
  put_in_order(of.least_vibration_mg, of.most_vibration_mg);
  put_in_order(of.least_vibration_dhz, of.most_vibration_dhz);
}

inline void within(jnd_geometry& of) {
  for (std::uint32_t* length : {&of.a_nm, &of.b_nm, &of.bh_nm, &of.bd_nm, &of.l1_nm, &of.l2_nm})
    *length = std::max<std::uint32_t>(*length, 1);
}

inline void within(jnd_force_table& of) {
  of.points = *rc::gen::element<std::uint8_t>(0, 2, 3, 4, 5, 6);
  rise(of.sensor_un, of.points);
  rise(of.force_un, of.points);
  for (int i = of.points; i < JND_FORCE_POINTS; ++i) of.sensor_un[i] = of.force_un[i] = 0;
}

inline void within(jnd_certificate& of) {
  of.date = any_date();
}

}  // namespace detail

// Within a property of rapidcheck only.
template <typename Record>
Record any_allowed() {
  Record record{};
  visit_members(record, [](const char* /*name*/, auto& value) { detail::set_any(value); });
  detail::within(record);
  return record;
}

// One member, or now and then all of them, at any value that its type holds, allowed or not.
template <typename Record>
void spoil(Record& record) {
  int members = 0;
  visit_members(record, [&](const char* /*name*/, auto& /*value*/) { ++members; });
  const int chosen = detail::pick(0, members - 1);
  const bool all = detail::pick(0, 9) == 0;
  int member = 0;
  visit_members(record, [&](const char* /*name*/, auto& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    if (member++ != chosen && !all) return;
    if constexpr (std::is_same_v<std::remove_all_extents_t<Value>, char>) {
      value[detail::pick(0, static_cast<int>(std::extent_v<Value>) - 1)] = static_cast<char>(detail::pick(-128, 127));
    } else {
      detail::set_any(value);
    }
  });
  // An encoder does not write points that are not used.
  if constexpr (std::is_same_v<Record, jnd_force_table>)
    for (int i = record.points; i < JND_FORCE_POINTS; ++i) record.sensor_un[i] = record.force_un[i] = 0;
}

}  // namespace jnd::codec
