/* The vectors of devices/hid/vectors.txt, as embed_vectors.awk writes them, and whether the codec passes them. */
#ifndef VECTORS_H
#define VECTORS_H

#include <stdint.h>

struct vector {
  const char* kind;
  const char* refused; /* the reason why a decoder must refuse it; null: it must not */
  const char* name;
  uint16_t count;
  const uint8_t* bytes;
};
extern const struct vector vectors[];
extern const unsigned vectors_count;

/* How many fail; each is named. */
unsigned check_vectors(void);

#endif
