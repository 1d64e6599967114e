// Whatever the protocol allows comes back from its bytes as it was.
#include <cstdint>
#include <string>
#include <vector>

#include <rapidcheck.h>

#include "tests/catch.h"
#include "tests/devices/hid/firmware/codec_generators.h"
#include "tests/devices/hid/firmware/codec_ranges.h"
#include "tests/devices/hid/firmware/codec_text.h"

namespace {

TEST_CASE("what is allowed goes through its bytes and back", "[codec]") {
  jnd::codec::for_each_kind([](auto codec, auto empty) {
    using Record = decltype(empty);
    REQUIRE(rc::check(std::string(codec.kKind), [&] {
      const auto record = jnd::codec::any_allowed<Record>();
      // Encoders write every byte, whatever was there.
      std::vector<std::uint8_t> bytes(codec.kSize, 0x00), over(codec.kSize, 0xFF);
      codec.encode(record, bytes.data());
      codec.encode(record, over.data());
      RC_ASSERT(bytes == over);
      Record back{};
      RC_ASSERT(codec.decode(bytes.data(), bytes.size(), back) == JND_DECODE_OK);
      RC_ASSERT(jnd::codec::members_of(back) == jnd::codec::members_of(record));
      std::vector<std::uint8_t> again(codec.kSize);
      codec.encode(back, again.data());
      RC_ASSERT(again == bytes);
    }));
  });
}

// Any value in one member, or in all: the decoder takes the report exactly where the tables of PROTOCOL.md let it.
TEST_CASE("what is not allowed is refused", "[codec]") {
  jnd::codec::for_each_kind([](auto codec, auto empty) {
    using Record = decltype(empty);
    int taken = 0, refused = 0;
    REQUIRE(rc::check(std::string(codec.kKind), [&] {
      for (int i = 0; i < 10; ++i) {  // of some kinds few values are refused
        auto record = jnd::codec::any_allowed<Record>();
        jnd::codec::spoil(record);
        std::vector<std::uint8_t> bytes(codec.kSize);
        codec.encode(record, bytes.data());
        Record back{};
        const jnd_decode_result result = codec.decode(bytes.data(), bytes.size(), back);
        RC_ASSERT(result == (jnd::codec::allowed(record) ? JND_DECODE_OK : JND_DECODE_RANGE));
        (result == JND_DECODE_OK ? taken : refused) += 1;
      }
    }));
    CHECK(taken + refused >= 1000);
    CHECK(refused > 0);
  });
}

TEST_CASE("no two kinds of report are taken for each other", "[codec]") {
  jnd::codec::for_each_report([](auto codec, auto empty) {
    using Record = decltype(empty);
    REQUIRE(rc::check(std::string(codec.kKind), [&] {
      const auto record = jnd::codec::any_allowed<Record>();
      std::vector<std::uint8_t> bytes(codec.kSize);
      codec.encode(record, bytes.data());
      int taken = 0;
      jnd::codec::for_each_report([&](auto other, auto out) {
        const jnd_decode_result result = other.decode(bytes.data(), bytes.size(), out);
        RC_ASSERT(result == (other.kKind == codec.kKind ? JND_DECODE_OK : JND_DECODE_ID));
        if (result == JND_DECODE_OK) ++taken;
      });
      RC_ASSERT(taken == 1);
    }));
  });
}

}  // namespace
