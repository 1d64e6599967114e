#include "jnd_calibration.h"

#include <string.h>

enum { TABLE_AT = 4, CERTIFICATE_AT = TABLE_AT + JND_PAGE_SIZE, CRC_AT = CERTIFICATE_AT + JND_PAGE_SIZE };

static bool decode(const uint8_t record[JND_CALIBRATION_SIZE], struct jnd_calibration* out) {
  const uint32_t crc = (uint32_t)record[CRC_AT] | (uint32_t)record[CRC_AT + 1] << 8 |
                       (uint32_t)record[CRC_AT + 2] << 16 | (uint32_t)record[CRC_AT + 3] << 24;
  if (record[0] != 'J' || record[1] != 'C' || record[2] != 1 || record[3] > 1 || crc != jnd_crc32(record, CRC_AT))
    return false;
  out->certified = record[3] == 1;
  return jnd_decode_force_table(record + TABLE_AT, &out->table) &&
         jnd_decode_certificate(record + CERTIFICATE_AT, &out->certificate);
}

void jnd_calibration_load(struct jnd_calibration* self, const struct jnd_hardware* hardware) {
  uint8_t record[JND_CALIBRATION_SIZE];
  memset(self, 0, sizeof *self);
  if (hardware->load == NULL || !hardware->load(hardware->context, record, sizeof record)) return;
  if (!decode(record, self)) memset(self, 0, sizeof *self);
}

bool jnd_calibration_store(const struct jnd_calibration* self, const struct jnd_hardware* hardware) {
  uint8_t record[JND_CALIBRATION_SIZE] = {'J', 'C', 1, self->certified ? 1 : 0};
  jnd_encode_force_table(&self->table, record + TABLE_AT);
  jnd_encode_certificate(&self->certificate, record + CERTIFICATE_AT);
  const uint32_t crc = jnd_crc32(record, CRC_AT);
  for (int i = 0; i < 4; ++i) record[CRC_AT + i] = (uint8_t)(crc >> (8 * i) & 0xFFU);
  return hardware->store != NULL && hardware->store(hardware->context, record, sizeof record);
}

float jnd_calibrated_n(const struct jnd_force_table* table, float sensor_n) {
  if (table->points < 2) return sensor_n;
  int i = 1;
  while (i + 1 < table->points && sensor_n > (float)table->sensor_un[i] * 1e-6F) ++i;
  const float x0 = (float)table->sensor_un[i - 1] * 1e-6F, y0 = (float)table->force_un[i - 1] * 1e-6F;
  /* Differences of the integers, which are above 0 and fit: two near points keep their digits. */
  const float run = (float)((uint32_t)table->sensor_un[i] - (uint32_t)table->sensor_un[i - 1]);
  const float rise = (float)((uint32_t)table->force_un[i] - (uint32_t)table->force_un[i - 1]);
  return y0 + (sensor_n - x0) * (rise / run);
}
