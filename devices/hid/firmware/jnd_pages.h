/* Pages of description: PROTOCOL.md, "Pages". */
#ifndef JND_PAGES_H
#define JND_PAGES_H

#include "jnd_calibration.h"
#include "jnd_fingertip.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the answer to a request is. writable: pages may be written just now; what is written is stored. */
void jnd_answer_request(const struct jnd_fingertip_config* config, const struct jnd_hardware* hardware,
                        struct jnd_calibration* calibration, bool writable, const struct jnd_request* request,
                        struct jnd_answer* answer);

#ifdef __cplusplus
}
#endif

#endif
