// The bytes of a blob: integers little-endian, and one whole zstd frame with its checksum around them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "data/log/storage_error.h"

namespace jnd {

// "the telemetry cannot be read: why".
StorageError unreadable_blob(std::string_view why);

template <typename Integer>
void put_integer(std::string& bytes, Integer value) {
  for (std::size_t i = 0; i < sizeof value; ++i) bytes.push_back(static_cast<char>((value >> (8 * i)) & 0xFF));
}

// What put_integer wrote, from bytes whose size was checked.
template <typename Integer>
Integer integer_at(std::string_view bytes, std::size_t at) {
  Integer value = 0;
  for (std::size_t i = 0; i < sizeof value; ++i)
    value |= static_cast<Integer>(static_cast<Integer>(static_cast<unsigned char>(bytes[at + i])) << (8 * i));
  return value;
}

// Throws StorageError where there is too little memory.
std::string compressed_blob(std::string_view raw);
// One frame and nothing behind it. Memory grows with what really comes out, not with what a damaged header promises; more
// than `largest` bytes are refused. Throws StorageError.
std::string decompressed_blob(std::string_view bytes, std::size_t largest);

// The first so many bytes that come out, or fewer where there are not so many. Throws StorageError where none can.
std::string blob_beginning(std::string_view bytes, std::size_t size);

}  // namespace jnd
