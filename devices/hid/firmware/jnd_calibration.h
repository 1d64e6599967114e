/* The calibration that a device keeps: the table of its force sensor and the certificate, in one record with a CRC. */
#ifndef JND_CALIBRATION_H
#define JND_CALIBRATION_H

#include "jnd_hardware.h"
#include "jnd_report.h"

#ifdef __cplusplus
extern "C" {
#endif

struct jnd_calibration {
  struct jnd_force_table table;
  struct jnd_certificate certificate;
  bool certified; /* a certificate was stored, if an empty one */
};

/* "JC", 1, whether certified; page 3; page 4; CRC-32 of all before. */
enum { JND_CALIBRATION_SIZE = 4 + 2 * JND_PAGE_SIZE + 4 };

/* What is kept, or none where nothing is, or where it does not check out. */
void jnd_calibration_load(struct jnd_calibration* self, const struct jnd_hardware* hardware);

/* False where the board could not keep it. */
bool jnd_calibration_store(const struct jnd_calibration* self, const struct jnd_hardware* hardware);

/* The force, N, for a sensor's figure, N: PROTOCOL.md, page 3. */
float jnd_calibrated_n(const struct jnd_force_table* table, float sensor_n);

#ifdef __cplusplus
}
#endif

#endif
