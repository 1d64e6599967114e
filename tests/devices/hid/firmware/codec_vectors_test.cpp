// The codec in C against devices/hid/vectors.txt, which Python made from the tables of PROTOCOL.md.
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/catch.h"
#include "tests/devices/hid/firmware/codec_vector_file.h"

namespace {

using jnd::codec::Codec;
using jnd::codec::Vector;

const std::map<std::string, jnd_decode_result> kReasons = {{"length", JND_DECODE_LENGTH},
                                                           {"id", JND_DECODE_ID},
                                                           {"version", JND_DECODE_VERSION},
                                                           {"crc", JND_DECODE_CRC},
                                                           {"range", JND_DECODE_RANGE}};

TEST_CASE("every right vector decodes to the stated values and encodes to the same bytes", "[codec]") {
  jnd::codec::for_each_kind([](auto codec, auto empty) {
    using Record = decltype(empty);
    const std::vector<Vector> vectors = jnd::codec::right_vectors(std::string(codec.kKind));
    REQUIRE(vectors.size() >= 3);
    for (const Vector& vector : vectors) {
      INFO(vector.kind << " " << vector.name);
      REQUIRE(vector.bytes.size() == codec.kSize);
      Record record{};
      REQUIRE(codec.decode(vector.bytes.data(), vector.bytes.size(), record) == JND_DECODE_OK);
      CHECK(jnd::codec::members_of(record) == vector.members);
      std::vector<std::uint8_t> again(codec.kSize, 0xEE), from_text(codec.kSize, 0xEE);
      codec.encode(record, again.data());
      CHECK(again == vector.bytes);
      codec.encode(jnd::codec::record_of<Record>(vector.members), from_text.data());
      CHECK(from_text == vector.bytes);
    }
  });
}

TEST_CASE("every wrong vector is refused for its reason and leaves the structure as it was", "[codec]") {
  jnd::codec::for_each_kind([](auto codec, auto empty) {
    using Record = decltype(empty);
    const std::vector<Vector> vectors = jnd::codec::wrong_vectors(std::string(codec.kKind));
    REQUIRE(vectors.size() >= 3);
    std::set<std::string> reasons;
    for (const Vector& vector : vectors) {
      INFO(vector.reason << " " << vector.name);
      reasons.insert(vector.reason);
      Record record;
      std::memset(&record, 0xA5, sizeof record);
      CHECK(codec.decode(vector.bytes.data(), vector.bytes.size(), record) == kReasons.at(vector.reason));
      std::array<std::uint8_t, sizeof record> before{}, after{};
      before.fill(0xA5);
      std::memcpy(after.data(), &record, sizeof record);
      CHECK(after == before);
    }
    CHECK(reasons.size() == (codec.kIsReport ? kReasons.size() : 1));
  });
}

TEST_CASE("the vectors are of no other kinds and hold what a firmware must show", "[codec]") {
  std::set<std::string> known, kinds;
  jnd::codec::for_each_kind([&](auto codec, auto /*empty*/) { known.insert(std::string(codec.kKind)); });
  std::set<std::string> names;
  std::size_t right = 0, wrong = 0;
  for (const Vector& vector : jnd::codec::read_vectors()) {
    kinds.insert(vector.kind);
    CHECK(names.insert(vector.kind + " " + vector.reason + " " + vector.name).second);
    (vector.reason.empty() ? right : wrong) += 1;
  }
  CHECK(kinds == known);
  CHECK(right >= 200);
  CHECK(wrong >= 150);
  for (const char* name : {"before_wrap", "after_wrap", "lowest", "highest", "typical"})
    for (const char* kind : {"command", "telemetry", "pose"}) CHECK(names.contains(std::string(kind) + "  " + name));
}

TEST_CASE("the CRC is that of IEEE 802.3", "[codec]") {
  const std::string digits = "123456789";
  CHECK(jnd_crc32(reinterpret_cast<const std::uint8_t*>(digits.data()), digits.size()) == 0xCBF43926U);
  CHECK(jnd_crc32(nullptr, 0) == 0);
}

}  // namespace
