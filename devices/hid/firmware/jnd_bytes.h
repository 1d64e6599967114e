/* Little-endian numbers and texts, into bytes and out of them: what the codec's two files share. Nothing else includes
 * this. Each returns the place behind what it wrote or read. */
#ifndef JND_BYTES_H
#define JND_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline uint8_t* put_u8(uint8_t* at, uint8_t value) {
  *at = value;
  return at + 1;
}

static inline uint8_t* put_u16(uint8_t* at, uint16_t value) {
  at[0] = (uint8_t)(value & 0xFFU);
  at[1] = (uint8_t)(value >> 8);
  return at + 2;
}

static inline uint8_t* put_u32(uint8_t* at, uint32_t value) {
  at = put_u16(at, (uint16_t)(value & 0xFFFFU));
  return put_u16(at, (uint16_t)(value >> 16));
}

static inline uint8_t* put_u64(uint8_t* at, uint64_t value) {
  at = put_u32(at, (uint32_t)(value & 0xFFFFFFFFU));
  return put_u32(at, (uint32_t)(value >> 32));
}

static inline uint8_t* put_i16(uint8_t* at, int16_t value) {
  return put_u16(at, (uint16_t)value);
}
static inline uint8_t* put_i32(uint8_t* at, int32_t value) {
  return put_u32(at, (uint32_t)value);
}

static inline uint8_t* put_text(uint8_t* at, const char* text, size_t size) {
  memcpy(at, text, size);
  return at + size;
}

static inline const uint8_t* get_u8(const uint8_t* at, uint8_t* value) {
  *value = at[0];
  return at + 1;
}

static inline const uint8_t* get_u16(const uint8_t* at, uint16_t* value) {
  *value = (uint16_t)(at[0] | (uint16_t)(at[1] << 8));
  return at + 2;
}

static inline const uint8_t* get_u32(const uint8_t* at, uint32_t* value) {
  *value = (uint32_t)at[0] | ((uint32_t)at[1] << 8) | ((uint32_t)at[2] << 16) | ((uint32_t)at[3] << 24);
  return at + 4;
}

static inline const uint8_t* get_u64(const uint8_t* at, uint64_t* value) {
  uint32_t low, high;
  at = get_u32(at, &low);
  at = get_u32(at, &high);
  *value = (uint64_t)low | ((uint64_t)high << 32);
  return at;
}

/* Two's complement without relying on the conversion of large unsigned numbers. */
static inline const uint8_t* get_i16(const uint8_t* at, int16_t* value) {
  uint16_t bits;
  at = get_u16(at, &bits);
  *value = bits < 0x8000U ? (int16_t)bits : (int16_t)((int32_t)bits - 0x10000);
  return at;
}

static inline const uint8_t* get_i32(const uint8_t* at, int32_t* value) {
  uint32_t bits;
  at = get_u32(at, &bits);
  *value = bits < 0x80000000U ? (int32_t)bits : -(int32_t)(0xFFFFFFFFU - bits) - 1;
  return at;
}

static inline const uint8_t* get_text(const uint8_t* at, char* text, size_t size) {
  memcpy(text, at, size);
  return at + size;
}

/* All from `at` to before `end` is 0. */
static inline bool zero(const uint8_t* at, const uint8_t* end) {
  while (at != end)
    if (*at++ != 0) return false;
  return true;
}

#endif
