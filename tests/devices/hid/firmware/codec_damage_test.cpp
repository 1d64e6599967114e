// Damaged reports: what a CRC-32 promises for 64 bytes is looked at, not believed.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <rapidcheck.h>

#include "tests/catch.h"
#include "tests/devices/hid/firmware/codec_vector_file.h"

namespace {

using jnd::codec::Vector;

constexpr std::size_t kBits = 8 * JND_REPORT_SIZE;

void flip(std::vector<std::uint8_t>& bytes, std::size_t bit) {
  bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << bit % 8));
}

// By the order in which a receiver looks: the id is byte 0, the version byte 1.
jnd_decode_result expected(std::size_t lowest_flipped_bit) {
  if (lowest_flipped_bit < 8) return JND_DECODE_ID;
  return lowest_flipped_bit < 16 ? JND_DECODE_VERSION : JND_DECODE_CRC;
}

template <typename Record>
bool untouched(const Record& record) {
  std::vector<std::uint8_t> now(sizeof record);
  std::memcpy(now.data(), &record, sizeof record);
  return now == std::vector<std::uint8_t>(sizeof record, 0x5A);
}

TEST_CASE("every single flipped bit of every right report is found", "[codec]") {
  jnd::codec::for_each_report([](auto codec, auto empty) {
    using Record = decltype(empty);
    for (const Vector& vector : jnd::codec::right_vectors(std::string(codec.kKind))) {
      INFO(vector.kind << " " << vector.name);
      std::size_t wrong = 0, tried = 0;
      std::vector<std::uint8_t> bytes = vector.bytes;
      for (std::size_t bit = 0; bit < kBits; ++bit, ++tried) {
        Record record;
        std::memset(&record, 0x5A, sizeof record);
        flip(bytes, bit);
        if (codec.decode(bytes.data(), bytes.size(), record) != expected(bit) || !untouched(record)) ++wrong;
        flip(bytes, bit);
      }
      CHECK(tried == 512);
      CHECK(wrong == 0);
    }
  });
}

TEST_CASE("every pair of flipped bits is found", "[codec]") {
  jnd::codec::for_each_report([](auto codec, auto empty) {
    using Record = decltype(empty);
    const Vector vector = jnd::codec::right_vectors(std::string(codec.kKind)).front();
    INFO(vector.kind << " " << vector.name);
    std::vector<std::uint8_t> bytes = vector.bytes;
    Record record{};
    std::size_t wrong = 0, tried = 0;
    for (std::size_t first = 0; first < kBits; ++first) {
      flip(bytes, first);
      for (std::size_t second = first + 1; second < kBits; ++second, ++tried) {
        flip(bytes, second);
        if (codec.decode(bytes.data(), bytes.size(), record) != expected(first)) ++wrong;
        flip(bytes, second);
      }
      flip(bytes, first);
    }
    CHECK(tried == 130'816);
    CHECK(wrong == 0);
  });
}

TEST_CASE("every burst of up to 32 bits is found", "[codec]") {
  jnd::codec::for_each_report([](auto codec, auto empty) {
    using Record = decltype(empty);
    const Vector vector = jnd::codec::right_vectors(std::string(codec.kKind)).front();
    REQUIRE(rc::check("bursts", [&] {
      const auto pattern = *rc::gen::nonZero<std::uint32_t>();
      std::size_t wrong = 0;
      for (std::size_t at = 0; at + 32 <= kBits; ++at) {
        std::vector<std::uint8_t> bytes = vector.bytes;
        for (std::size_t bit = 0; bit < 32; ++bit)
          if ((pattern >> bit & 1U) != 0) flip(bytes, at + bit);
        Record record{};
        if (codec.decode(bytes.data(), bytes.size(), record) == JND_DECODE_OK) ++wrong;
      }
      RC_ASSERT(wrong == 0U);
    }));
  });
}

// Swapped, lost and doubled bytes, as a transport that shifts its packets would make them.
TEST_CASE("reports that were cut and glued are found", "[codec]") {
  jnd::codec::for_each_report([](auto codec, auto empty) {
    using Record = decltype(empty);
    const std::vector<Vector> vectors = jnd::codec::right_vectors(std::string(codec.kKind));
    std::size_t tried = 0, wrong = 0;
    for (std::size_t i = 1; i < vectors.size(); ++i)
      for (std::size_t cut = 1; cut < JND_REPORT_SIZE; ++cut) {
        std::vector<std::uint8_t> glued(vectors[i - 1].bytes);
        std::copy(vectors[i].bytes.begin() + static_cast<std::ptrdiff_t>(cut), vectors[i].bytes.end(),
                  glued.begin() + static_cast<std::ptrdiff_t>(cut));
        if (glued == vectors[i - 1].bytes || glued == vectors[i].bytes) continue;
        Record record{};
        ++tried;
        if (codec.decode(glued.data(), glued.size(), record) != JND_DECODE_CRC) ++wrong;
      }
    CHECK(tried >= 300);
    CHECK(wrong == 0);
  });
}

}  // namespace
