#include "vectors.h"

#include <stdbool.h>
#include <string.h>

#include "../jnd_report.h"
#include "semihosting.h"

#define REPORT(KIND)                                                  \
  if (strcmp(vector->kind, #KIND) == 0) {                             \
    struct jnd_##KIND value;                                          \
    result = jnd_decode_##KIND(vector->bytes, vector->count, &value); \
    if (result == JND_DECODE_OK) jnd_encode_##KIND(&value, again);    \
    return result;                                                    \
  }
#define PAGE(KIND)                                                          \
  if (strcmp(vector->kind, #KIND) == 0) {                                   \
    struct jnd_##KIND value;                                                \
    if (vector->count != JND_PAGE_SIZE) return JND_DECODE_LENGTH;           \
    if (!jnd_decode_##KIND(vector->bytes, &value)) return JND_DECODE_RANGE; \
    jnd_encode_##KIND(&value, again);                                       \
    return JND_DECODE_OK;                                                   \
  }

/* Decodes a vector, and encodes it again. */
static enum jnd_decode_result round_trip(const struct vector* vector, uint8_t again[JND_REPORT_SIZE], bool* known) {
  enum jnd_decode_result result;
  *known = true;
  REPORT(command)
  REPORT(telemetry)
  REPORT(pose)
  REPORT(request)
  REPORT(answer)
  PAGE(identity)
  PAGE(limits)
  PAGE(geometry)
  PAGE(force_table)
  PAGE(certificate)
  *known = false;
  return JND_DECODE_OK;
}

static enum jnd_decode_result reason(const char* name) {
  static const char* const names[] = {"", "length", "id", "version", "crc", "range"};
  int i = 1;
  while (i < 5 && strcmp(name, names[i]) != 0) ++i;
  return (enum jnd_decode_result)i;
}

static bool passes(const struct vector* vector) {
  uint8_t again[JND_REPORT_SIZE];
  bool known;
  const enum jnd_decode_result result = round_trip(vector, again, &known);
  if (!known) return false;
  if (vector->refused != NULL) return result == reason(vector->refused);
  return result == JND_DECODE_OK && memcmp(again, vector->bytes, vector->count) == 0;
}

unsigned check_vectors(void) {
  unsigned failed = 0;
  for (unsigned i = 0; i < vectors_count; ++i) {
    if (passes(&vectors[i])) continue;
    ++failed;
    semihosting_write("FAILED: vector ");
    semihosting_write(vectors[i].kind);
    semihosting_write(" ");
    semihosting_write(vectors[i].name);
    semihosting_write("\n");
  }
  return failed;
}
