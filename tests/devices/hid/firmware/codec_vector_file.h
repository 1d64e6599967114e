// devices/hid/vectors.txt, read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/devices/hid/firmware/codec_text.h"

namespace jnd::codec {

struct Vector {
  std::string kind, name;
  std::string reason;  // to refuse it: "length", "id", "version", "crc", "range"; empty: it is right
  std::vector<std::uint8_t> bytes;
  Members members;  // of a right one
};

// Throws std::runtime_error where the file is not what PROTOCOL.md says.
std::vector<Vector> read_vectors();

// The right ones of a kind, or all wrong ones of it.
std::vector<Vector> right_vectors(const std::string& kind);
std::vector<Vector> wrong_vectors(const std::string& kind);

}  // namespace jnd::codec
