#include "jnd_report.h"

#include <string.h>

#include "jnd_bytes.h"

uint32_t jnd_crc32(const uint8_t* bytes, size_t count) {
  uint32_t crc = 0xFFFFFFFFU;
  for (size_t i = 0; i < count; ++i) {
    crc ^= bytes[i];
    /* Four bits at a time, with 64 bytes of table. */
    static const uint32_t table[16] = {0x00000000U, 0x1DB71064U, 0x3B6E20C8U, 0x26D930ACU, 0x76DC4190U, 0x6B6B51F4U,
                                       0x4DB26158U, 0x5005713CU, 0xEDB88320U, 0xF00F9344U, 0xD6D6A3E8U, 0xCB61B38CU,
                                       0x9B64C2B0U, 0x86D3D2D4U, 0xA00AE278U, 0xBDBDF21CU};
    crc = (crc >> 4) ^ table[crc & 0xFU];
    crc = (crc >> 4) ^ table[crc & 0xFU];
  }
  return crc ^ 0xFFFFFFFFU;
}

enum { CRC_AT = JND_REPORT_SIZE - 4, PAGE_AT = 8 };

static uint8_t* begin(uint8_t* bytes, uint8_t id) {
  memset(bytes, 0, JND_REPORT_SIZE);
  bytes[0] = id;
  bytes[1] = JND_PROTOCOL_VERSION;
  return bytes + 2;
}

static void finish(uint8_t* bytes) {
  put_u32(bytes + CRC_AT, jnd_crc32(bytes, CRC_AT));
}

/* Everything but the fields. The version comes before the CRC, so that another version's CRC need not be ours. */
static enum jnd_decode_result check(const uint8_t* bytes, size_t count, uint8_t id) {
  uint32_t crc;
  if (count != JND_REPORT_SIZE) return JND_DECODE_LENGTH;
  if (bytes[0] != id) return JND_DECODE_ID;
  if (bytes[1] != JND_PROTOCOL_VERSION) return JND_DECODE_VERSION;
  get_u32(bytes + CRC_AT, &crc);
  return crc == jnd_crc32(bytes, CRC_AT) ? JND_DECODE_OK : JND_DECODE_CRC;
}

/* -- command --------------------------------------------------------------------------------------------------------
 */

void jnd_encode_command(const struct jnd_command* command, uint8_t bytes[JND_REPORT_SIZE]) {
  uint8_t* at = begin(bytes, JND_REPORT_COMMAND);
  at = put_u8(at, command->mode);
  at = put_u8(at, command->touching ? 1 : 0);
  at = put_u32(at, command->sequence);
  for (int i = 0; i < 3; ++i) at = put_i32(at, command->contact_point_nm[i]);
  for (int i = 0; i < 3; ++i) at = put_i32(at, command->normal[i]);
  at = put_u32(at, command->penetration_nm);
  at = put_i32(at, command->penetration_rate_um_per_s);
  at = put_u32(at, command->stiffness_mn_per_m);
  at = put_u32(at, command->most_force_un);
  at = put_u16(at, command->damping_cn_s_per_m);
  at = put_i16(at, command->roll_dmrad);
  at = put_i16(at, command->pitch_dmrad);
  at = put_u16(at, command->vibration_mg);
  put_u16(at, command->vibration_dhz);
  finish(bytes);
}

enum jnd_decode_result jnd_decode_command(const uint8_t* bytes, size_t count, struct jnd_command* command) {
  const enum jnd_decode_result result = check(bytes, count, JND_REPORT_COMMAND);
  struct jnd_command out;
  const uint8_t* at;
  uint8_t flags;
  if (result != JND_DECODE_OK) return result;
  at = bytes + 2;
  at = get_u8(at, &out.mode);
  at = get_u8(at, &flags);
  out.touching = (flags & 1U) != 0;
  at = get_u32(at, &out.sequence);
  for (int i = 0; i < 3; ++i) at = get_i32(at, &out.contact_point_nm[i]);
  for (int i = 0; i < 3; ++i) at = get_i32(at, &out.normal[i]);
  at = get_u32(at, &out.penetration_nm);
  at = get_i32(at, &out.penetration_rate_um_per_s);
  at = get_u32(at, &out.stiffness_mn_per_m);
  at = get_u32(at, &out.most_force_un);
  at = get_u16(at, &out.damping_cn_s_per_m);
  at = get_i16(at, &out.roll_dmrad);
  at = get_i16(at, &out.pitch_dmrad);
  at = get_u16(at, &out.vibration_mg);
  at = get_u16(at, &out.vibration_dhz);
  if (out.mode > JND_MODE_PD_LITERAL || flags > 1 || !zero(at, bytes + CRC_AT)) return JND_DECODE_RANGE;
  *command = out;
  return JND_DECODE_OK;
}

/* -- telemetry ------------------------------------------------------------------------------------------------------
 */

void jnd_encode_telemetry(const struct jnd_telemetry* telemetry, uint8_t bytes[JND_REPORT_SIZE]) {
  uint8_t* at = begin(bytes, JND_REPORT_TELEMETRY);
  at = put_u8(at, telemetry->state);
  at = put_u8(at, telemetry->buttons);
  at = put_u32(at, telemetry->sequence);
  at = put_u32(at, telemetry->command_sequence);
  at = put_u64(at, telemetry->time_us);
  for (int i = 0; i < 3; ++i) at = put_i32(at, telemetry->joint_urad[i]);
  at = put_i32(at, telemetry->force_un);
  at = put_i32(at, telemetry->height_nm);
  at = put_i16(at, telemetry->roll_dmrad);
  at = put_i16(at, telemetry->pitch_dmrad);
  at = put_i16(at, telemetry->yaw_dmrad);
  at = put_u16(at, telemetry->vibration_mg);
  at = put_u16(at, telemetry->faults);
  at = put_u16(at, telemetry->limits);
  at = put_u16(at, telemetry->rejected);
  at = put_u16(at, telemetry->command_age_us);
  at = put_i16(at, telemetry->temperature_cdeg);
  put_u8(at, telemetry->battery_percent);
  finish(bytes);
}

enum jnd_decode_result jnd_decode_telemetry(const uint8_t* bytes, size_t count, struct jnd_telemetry* telemetry) {
  const enum jnd_decode_result result = check(bytes, count, JND_REPORT_TELEMETRY);
  struct jnd_telemetry out;
  const uint8_t* at;
  if (result != JND_DECODE_OK) return result;
  at = bytes + 2;
  at = get_u8(at, &out.state);
  at = get_u8(at, &out.buttons);
  at = get_u32(at, &out.sequence);
  at = get_u32(at, &out.command_sequence);
  at = get_u64(at, &out.time_us);
  for (int i = 0; i < 3; ++i) at = get_i32(at, &out.joint_urad[i]);
  at = get_i32(at, &out.force_un);
  at = get_i32(at, &out.height_nm);
  at = get_i16(at, &out.roll_dmrad);
  at = get_i16(at, &out.pitch_dmrad);
  at = get_i16(at, &out.yaw_dmrad);
  at = get_u16(at, &out.vibration_mg);
  at = get_u16(at, &out.faults);
  at = get_u16(at, &out.limits);
  at = get_u16(at, &out.rejected);
  at = get_u16(at, &out.command_age_us);
  at = get_i16(at, &out.temperature_cdeg);
  at = get_u8(at, &out.battery_percent);
  if (out.state > JND_STATE_STOPPED || (out.faults & ~JND_FAULT_BITS) != 0 || (out.limits & ~JND_LIMIT_BITS) != 0 ||
      (out.battery_percent > 100 && out.battery_percent != JND_BATTERY_NONE) || !zero(at, bytes + CRC_AT))
    return JND_DECODE_RANGE;
  *telemetry = out;
  return JND_DECODE_OK;
}

/* -- pose -----------------------------------------------------------------------------------------------------------
 */

enum { POSE_SEEN = 1, POSE_FLEXION = 2 };

void jnd_encode_pose(const struct jnd_pose* pose, uint8_t bytes[JND_REPORT_SIZE]) {
  uint8_t* at = begin(bytes, JND_REPORT_TRACKER);
  at = put_u8(at, pose->finger);
  at = put_u8(at, (uint8_t)((pose->seen ? POSE_SEEN : 0) | (pose->has_flexion ? POSE_FLEXION : 0)));
  at = put_u32(at, pose->sequence);
  at = put_u64(at, pose->time_us);
  for (int i = 0; i < 3; ++i) at = put_i32(at, pose->position_nm[i]);
  for (int i = 0; i < 4; ++i) at = put_i32(at, pose->orientation[i]);
  put_i32(at, pose->flexion_urad);
  finish(bytes);
}

/* A unit quaternion to 1e-3: enough to be normalised, and far from anything else. */
static bool unit_quaternion(const int32_t q[4]) {
  uint64_t square = 0; /* in 2^-44: each term at most 2^46 */
  const uint64_t one = (uint64_t)1 << 44;
  for (int i = 0; i < 4; ++i) {
    const int64_t part = (int64_t)q[i] / 256; /* 2^-22 */
    square += (uint64_t)(part * part);
  }
  return square > one - one / 500 && square < one + one / 500;
}

enum jnd_decode_result jnd_decode_pose(const uint8_t* bytes, size_t count, struct jnd_pose* pose) {
  const enum jnd_decode_result result = check(bytes, count, JND_REPORT_TRACKER);
  struct jnd_pose out;
  const uint8_t *at, *measured;
  uint8_t flags;
  if (result != JND_DECODE_OK) return result;
  at = bytes + 2;
  at = get_u8(at, &out.finger);
  at = get_u8(at, &flags);
  out.seen = (flags & POSE_SEEN) != 0;
  out.has_flexion = (flags & POSE_FLEXION) != 0;
  at = get_u32(at, &out.sequence);
  at = get_u64(at, &out.time_us);
  measured = at;
  for (int i = 0; i < 3; ++i) at = get_i32(at, &out.position_nm[i]);
  for (int i = 0; i < 4; ++i) at = get_i32(at, &out.orientation[i]);
  at = get_i32(at, &out.flexion_urad);
  if (out.finger < JND_THUMB || out.finger > JND_LITTLE || flags > (POSE_SEEN | POSE_FLEXION) ||
      !zero(at, bytes + CRC_AT))
    return JND_DECODE_RANGE;
  if (out.seen ? !unit_quaternion(out.orientation) : (out.has_flexion || !zero(measured, at))) return JND_DECODE_RANGE;
  if (!out.has_flexion && out.flexion_urad != 0) return JND_DECODE_RANGE;
  *pose = out;
  return JND_DECODE_OK;
}

/* -- pages ----------------------------------------------------------------------------------------------------------
 */

static void encode_page(uint8_t* bytes, uint8_t id, uint8_t first, uint8_t page, uint32_t token, const uint8_t* data) {
  uint8_t* at = begin(bytes, id);
  at = put_u8(at, first);
  at = put_u8(at, page);
  at = put_u32(at, token);
  memcpy(at, data, JND_PAGE_SIZE);
  finish(bytes);
}

void jnd_encode_request(const struct jnd_request* request, uint8_t bytes[JND_REPORT_SIZE]) {
  encode_page(bytes, JND_REPORT_REQUEST, request->operation, request->page, request->token, request->data);
}

void jnd_encode_answer(const struct jnd_answer* answer, uint8_t bytes[JND_REPORT_SIZE]) {
  encode_page(bytes, JND_REPORT_PAGE, answer->result, answer->page, answer->token, answer->data);
}

enum jnd_decode_result jnd_decode_request(const uint8_t* bytes, size_t count, struct jnd_request* request) {
  const enum jnd_decode_result result = check(bytes, count, JND_REPORT_REQUEST);
  if (result != JND_DECODE_OK) return result;
  if (bytes[2] > JND_WRITE_PAGE) return JND_DECODE_RANGE;
  request->operation = bytes[2];
  request->page = bytes[3];
  get_u32(bytes + 4, &request->token);
  memcpy(request->data, bytes + PAGE_AT, JND_PAGE_SIZE);
  return JND_DECODE_OK;
}

enum jnd_decode_result jnd_decode_answer(const uint8_t* bytes, size_t count, struct jnd_answer* answer) {
  const enum jnd_decode_result result = check(bytes, count, JND_REPORT_PAGE);
  if (result != JND_DECODE_OK) return result;
  if (bytes[2] > JND_PAGE_INVALID) return JND_DECODE_RANGE;
  answer->result = bytes[2];
  answer->page = bytes[3];
  get_u32(bytes + 4, &answer->token);
  memcpy(answer->data, bytes + PAGE_AT, JND_PAGE_SIZE);
  return JND_DECODE_OK;
}
