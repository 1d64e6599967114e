/* The contents of pages: what an identity, limits, a geometry, a force table and a certificate are in bytes. */
#include "jnd_bytes.h"
#include "jnd_report.h"

/* Printable ASCII without spaces, then zeros. */
static bool text_field(const char* text, size_t size) {
  size_t i = 0;
  while (i < size && text[i] > ' ' && text[i] <= '~') ++i;
  while (i < size && text[i] == 0) ++i;
  return i == size;
}

static bool calendar_day(uint32_t yyyymmdd) {
  const uint32_t month = yyyymmdd / 100 % 100, day = yyyymmdd % 100, year = yyyymmdd / 10000;
  return yyyymmdd == 0 || (year >= 2000 && year <= 9999 && month >= 1 && month <= 12 && day >= 1 && day <= 31);
}

void jnd_encode_identity(const struct jnd_identity* identity, uint8_t data[JND_PAGE_SIZE]) {
  uint8_t* at = data;
  memset(data, 0, JND_PAGE_SIZE);
  at = put_u8(at, identity->lowest_version);
  at = put_u8(at, identity->highest_version);
  at = put_u8(at, identity->model);
  at = put_u8(at, identity->finger);
  at = put_u8(at, identity->degrees_of_freedom);
  for (int i = 0; i < 3; ++i) at = put_u8(at, identity->firmware[i]);
  at = put_u16(at, identity->loop_rate_hz);
  at = put_u16(at, identity->capabilities);
  at = put_text(at, identity->serial, JND_SERIAL_SIZE);
  at = put_text(at, identity->calibration_id, JND_CALIBRATION_ID_SIZE);
  at = put_u32(at, identity->calibration_date);
  put_u16(at, identity->watchdog_ms);
}

bool jnd_decode_identity(const uint8_t data[JND_PAGE_SIZE], struct jnd_identity* identity) {
  struct jnd_identity out;
  const uint8_t* at = data;
  at = get_u8(at, &out.lowest_version);
  at = get_u8(at, &out.highest_version);
  at = get_u8(at, &out.model);
  at = get_u8(at, &out.finger);
  at = get_u8(at, &out.degrees_of_freedom);
  for (int i = 0; i < 3; ++i) at = get_u8(at, &out.firmware[i]);
  at = get_u16(at, &out.loop_rate_hz);
  at = get_u16(at, &out.capabilities);
  at = get_text(at, out.serial, JND_SERIAL_SIZE);
  at = get_text(at, out.calibration_id, JND_CALIBRATION_ID_SIZE);
  at = get_u32(at, &out.calibration_date);
  at = get_u16(at, &out.watchdog_ms);
  if (out.lowest_version < 1 || out.lowest_version > out.highest_version || out.model < JND_MODEL_RRS3 ||
      out.model > JND_MODEL_TRACKER || out.finger > JND_LITTLE || out.loop_rate_hz == 0 ||
      (out.capabilities & ~JND_CAPABILITY_BITS) != 0 || out.serial[0] == 0 ||
      !text_field(out.serial, JND_SERIAL_SIZE) || !text_field(out.calibration_id, JND_CALIBRATION_ID_SIZE) ||
      !calendar_day(out.calibration_date) || !zero(at, data + JND_PAGE_SIZE))
    return false;
  *identity = out;
  return true;
}

void jnd_encode_limits(const struct jnd_limits* limits, uint8_t data[JND_PAGE_SIZE]) {
  uint8_t* at = data;
  memset(data, 0, JND_PAGE_SIZE);
  at = put_u32(at, limits->most_force_un);
  at = put_u32(at, limits->most_stiffness_mn_per_m);
  at = put_u32(at, limits->most_force_rise_mn_per_s);
  at = put_i32(at, limits->lowest_height_nm);
  at = put_i32(at, limits->highest_height_nm);
  at = put_u16(at, limits->most_roll_dmrad);
  at = put_u16(at, limits->most_pitch_dmrad);
  at = put_u16(at, limits->most_joint_speed_mrad_per_s);
  at = put_u16(at, limits->least_vibration_mg);
  at = put_u16(at, limits->most_vibration_mg);
  at = put_u16(at, limits->least_vibration_dhz);
  at = put_u16(at, limits->most_vibration_dhz);
  at = put_u16(at, limits->most_burst_ms);
  at = put_u16(at, limits->most_damping_cn_s_per_m);
  at = put_i16(at, limits->most_temperature_cdeg);
  put_u16(at, limits->soft_start_ms);
}

bool jnd_decode_limits(const uint8_t data[JND_PAGE_SIZE], struct jnd_limits* limits) {
  struct jnd_limits out;
  const uint8_t* at = data;
  at = get_u32(at, &out.most_force_un);
  at = get_u32(at, &out.most_stiffness_mn_per_m);
  at = get_u32(at, &out.most_force_rise_mn_per_s);
  at = get_i32(at, &out.lowest_height_nm);
  at = get_i32(at, &out.highest_height_nm);
  at = get_u16(at, &out.most_roll_dmrad);
  at = get_u16(at, &out.most_pitch_dmrad);
  at = get_u16(at, &out.most_joint_speed_mrad_per_s);
  at = get_u16(at, &out.least_vibration_mg);
  at = get_u16(at, &out.most_vibration_mg);
  at = get_u16(at, &out.least_vibration_dhz);
  at = get_u16(at, &out.most_vibration_dhz);
  at = get_u16(at, &out.most_burst_ms);
  at = get_u16(at, &out.most_damping_cn_s_per_m);
  at = get_i16(at, &out.most_temperature_cdeg);
  at = get_u16(at, &out.soft_start_ms);
  if (out.lowest_height_nm > out.highest_height_nm || out.least_vibration_mg > out.most_vibration_mg ||
      out.least_vibration_dhz > out.most_vibration_dhz || !zero(at, data + JND_PAGE_SIZE))
    return false;
  *limits = out;
  return true;
}

void jnd_encode_geometry(const struct jnd_geometry* geometry, uint8_t data[JND_PAGE_SIZE]) {
  uint8_t* at = data;
  memset(data, 0, JND_PAGE_SIZE);
  at = put_u32(at, geometry->a_nm);
  at = put_u32(at, geometry->b_nm);
  at = put_u32(at, geometry->bh_nm);
  at = put_u32(at, geometry->bd_nm);
  at = put_u32(at, geometry->l1_nm);
  at = put_u32(at, geometry->l2_nm);
  put_i32(at, geometry->rest_height_nm);
}

bool jnd_decode_geometry(const uint8_t data[JND_PAGE_SIZE], struct jnd_geometry* geometry) {
  struct jnd_geometry out;
  const uint8_t* at = data;
  at = get_u32(at, &out.a_nm);
  at = get_u32(at, &out.b_nm);
  at = get_u32(at, &out.bh_nm);
  at = get_u32(at, &out.bd_nm);
  at = get_u32(at, &out.l1_nm);
  at = get_u32(at, &out.l2_nm);
  at = get_i32(at, &out.rest_height_nm);
  if (out.a_nm == 0 || out.b_nm == 0 || out.bh_nm == 0 || out.bd_nm == 0 || out.l1_nm == 0 || out.l2_nm == 0 ||
      !zero(at, data + JND_PAGE_SIZE))
    return false;
  *geometry = out;
  return true;
}

void jnd_encode_force_table(const struct jnd_force_table* table, uint8_t data[JND_PAGE_SIZE]) {
  uint8_t* at = data + 4;
  memset(data, 0, JND_PAGE_SIZE);
  data[0] = table->points;
  for (int i = 0; i < JND_FORCE_POINTS && i < table->points; ++i) {
    at = put_i32(at, table->sensor_un[i]);
    at = put_i32(at, table->force_un[i]);
  }
}

bool jnd_decode_force_table(const uint8_t data[JND_PAGE_SIZE], struct jnd_force_table* table) {
  struct jnd_force_table out;
  const uint8_t* at = data + 4;
  memset(&out, 0, sizeof out);
  out.points = data[0];
  if (out.points == 1 || out.points > JND_FORCE_POINTS || !zero(data + 1, data + 4)) return false;
  for (int i = 0; i < out.points; ++i) {
    at = get_i32(at, &out.sensor_un[i]);
    at = get_i32(at, &out.force_un[i]);
    if (i > 0 && (out.sensor_un[i] <= out.sensor_un[i - 1] || out.force_un[i] <= out.force_un[i - 1])) return false;
  }
  if (!zero(at, data + JND_PAGE_SIZE)) return false;
  *table = out;
  return true;
}

void jnd_encode_certificate(const struct jnd_certificate* certificate, uint8_t data[JND_PAGE_SIZE]) {
  memset(data, 0, JND_PAGE_SIZE);
  put_u32(put_text(data, certificate->calibration_id, JND_CALIBRATION_ID_SIZE), certificate->date);
}

bool jnd_decode_certificate(const uint8_t data[JND_PAGE_SIZE], struct jnd_certificate* certificate) {
  struct jnd_certificate out;
  const uint8_t* at = get_text(data, out.calibration_id, JND_CALIBRATION_ID_SIZE);
  at = get_u32(at, &out.date);
  if (!text_field(out.calibration_id, JND_CALIBRATION_ID_SIZE) || !calendar_day(out.date) ||
      !zero(at, data + JND_PAGE_SIZE))
    return false;
  *certificate = out;
  return true;
}
