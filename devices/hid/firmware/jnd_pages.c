#include "jnd_pages.h"

#include <string.h>

static bool read_page(const struct jnd_fingertip_config* config, const struct jnd_calibration* calibration,
                      uint8_t page, uint8_t data[JND_PAGE_SIZE]) {
  struct jnd_identity identity = config->identity;
  switch (page) {
    case JND_PAGE_IDENTITY:
      if (calibration->certified) {
        memcpy(identity.calibration_id, calibration->certificate.calibration_id, JND_CALIBRATION_ID_SIZE);
        identity.calibration_date = calibration->certificate.date;
      }
      jnd_encode_identity(&identity, data);
      return true;
    case JND_PAGE_LIMITS:
      jnd_encode_limits(&config->limits, data);
      return true;
    case JND_PAGE_GEOMETRY:
      jnd_encode_geometry(&config->geometry, data);
      return true;
    case JND_PAGE_FORCE_TABLE:
      jnd_encode_force_table(&calibration->table, data);
      return true;
    case JND_PAGE_CERTIFICATE:
      jnd_encode_certificate(&calibration->certificate, data);
      return true;
    default:
      return false;
  }
}

static enum jnd_page_result write_page(const struct jnd_hardware* hardware, struct jnd_calibration* calibration,
                                       bool writable, const struct jnd_request* request) {
  struct jnd_calibration next = *calibration;
  if (request->page > JND_PAGE_CERTIFICATE) return JND_PAGE_UNKNOWN;
  if (request->page < JND_PAGE_FORCE_TABLE || !writable) return JND_PAGE_REFUSED;
  if (request->page == JND_PAGE_FORCE_TABLE) {
    if (!jnd_decode_force_table(request->data, &next.table)) return JND_PAGE_INVALID;
  } else {
    if (!jnd_decode_certificate(request->data, &next.certificate)) return JND_PAGE_INVALID;
    next.certified = true;
  }
  if (!jnd_calibration_store(&next, hardware)) return JND_PAGE_REFUSED;
  *calibration = next;
  return JND_PAGE_OK;
}

void jnd_answer_request(const struct jnd_fingertip_config* config, const struct jnd_hardware* hardware,
                        struct jnd_calibration* calibration, bool writable, const struct jnd_request* request,
                        struct jnd_answer* answer) {
  memset(answer, 0, sizeof *answer);
  answer->page = request->page;
  answer->token = request->token;
  answer->result = JND_PAGE_OK;
  if (request->operation == JND_WRITE_PAGE)
    answer->result = (uint8_t)write_page(hardware, calibration, writable, request);
  if (answer->result == JND_PAGE_OK && !read_page(config, calibration, request->page, answer->data))
    answer->result = JND_PAGE_UNKNOWN;
}
