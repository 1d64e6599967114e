// The codec: what it must give back, the test vectors, damaged reports and memory.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <rapidcheck.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tests/catch.h"
#include "tests/devices/hid/firmware/codec_generators.h"
#include "tests/devices/hid/firmware/codec_ranges.h"
#include "tests/devices/hid/firmware/codec_text.h"
#include "tests/devices/hid/firmware/codec_vector_file.h"

namespace {

// Whatever the protocol allows comes back from its bytes as it was.

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

// The codec in C against devices/hid/vectors.txt, which Python made from the tables of PROTOCOL.md.

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

// Damaged reports: what a CRC-32 promises for 64 bytes is looked at, not believed.

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

// Decoders read their `count` bytes and nothing else, encoders write their own and nothing else: the bytes stand at the
// very ends of a page of memory that has no neighbours, and in heap blocks of their own for the address sanitizer.

using jnd::codec::Vector;

// A page of memory between two that may not be touched.
class LonelyPage {
 public:
  LonelyPage() : size_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))) {
    void* all = mmap(nullptr, 3 * size_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (all == MAP_FAILED) throw std::runtime_error("no memory for three pages");
    first_ = static_cast<std::uint8_t*>(all);
    if (mprotect(begin(), size_, PROT_READ | PROT_WRITE) != 0) throw std::runtime_error("cannot open the page");
  }
  ~LonelyPage() { munmap(first_, 3 * size_); }
  LonelyPage(const LonelyPage&) = delete;
  LonelyPage& operator=(const LonelyPage&) = delete;

  std::uint8_t* begin() const { return first_ + size_; }
  // The last `count` bytes.
  std::uint8_t* tail(std::size_t count) const { return begin() + size_ - count; }

 private:
  std::size_t size_;
  std::uint8_t* first_ = nullptr;
};

TEST_CASE("a report of any length is judged without a look beyond its end", "[codec]") {
  const LonelyPage page;
  jnd::codec::for_each_report([&](auto codec, auto empty) {
    using Record = decltype(empty);
    const std::vector<std::uint8_t> whole = jnd::codec::right_vectors(std::string(codec.kKind)).front().bytes;
    for (std::size_t count = 0; count <= 2 * JND_REPORT_SIZE; ++count) {
      std::vector<std::uint8_t> bytes = whole;
      bytes.resize(count);  // cut, or with zeros after it
      std::uint8_t* at_end = std::copy(bytes.begin(), bytes.end(), page.tail(count)) - count;
      const auto block = std::make_unique<std::uint8_t[]>(count);
      std::copy(bytes.begin(), bytes.end(), block.get());
      const jnd_decode_result expected = count == JND_REPORT_SIZE ? JND_DECODE_OK : JND_DECODE_LENGTH;
      Record record{};
      INFO(codec.kKind << " of " << count << " bytes");
      CHECK(codec.decode(at_end, count, record) == expected);
      CHECK(codec.decode(block.get(), count, record) == expected);
      std::copy(bytes.begin(), bytes.end(), page.begin());
      CHECK(codec.decode(page.begin(), count, record) == expected);
    }
    Record record{};
    CHECK(codec.decode(nullptr, 0, record) == JND_DECODE_LENGTH);
  });
}

TEST_CASE("a page is read from its 52 bytes", "[codec]") {
  const LonelyPage page;
  jnd::codec::for_each_page([&](auto codec, auto empty) {
    using Record = decltype(empty);
    for (const bool right : {true, false}) {
      const auto kind = std::string(codec.kKind);
      for (const Vector& vector : right ? jnd::codec::right_vectors(kind) : jnd::codec::wrong_vectors(kind)) {
        INFO(vector.name);
        const auto block = std::make_unique<std::uint8_t[]>(JND_PAGE_SIZE);
        std::copy(vector.bytes.begin(), vector.bytes.end(), block.get());
        std::uint8_t* at_end = page.tail(JND_PAGE_SIZE);
        std::copy(vector.bytes.begin(), vector.bytes.end(), at_end);
        const jnd_decode_result expected = right ? JND_DECODE_OK : JND_DECODE_RANGE;
        Record record{};
        CHECK(codec.decode(at_end, JND_PAGE_SIZE, record) == expected);
        CHECK(codec.decode(block.get(), JND_PAGE_SIZE, record) == expected);
      }
    }
  });
}

TEST_CASE("encoders write their own bytes and no others, whatever the values", "[codec]") {
  const LonelyPage page;
  jnd::codec::for_each_kind([&](auto codec, auto empty) {
    using Record = decltype(empty);
    for (const int fill : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
      // Values of no protocol: 255 points of a force table, a text without an end. Of a bool only 0 and 1 are values.
      Record record{};
      jnd::codec::visit_members(record, [&](const char* /*name*/, auto& value) {
        if constexpr (std::is_same_v<std::remove_reference_t<decltype(value)>, bool>)
          value = fill % 2 == 1;
        else
          std::memset(&value, fill, sizeof value);
      });
      std::uint8_t* at_end = page.tail(codec.kSize);
      codec.encode(record, at_end);
      codec.encode(record, page.begin());
      const std::vector<std::uint8_t> block(at_end, at_end + codec.kSize);
      CHECK(std::equal(block.begin(), block.end(), page.begin()));
      // Out of range or not, what was written is judged, never believed.
      Record back{};
      if (codec.decode(at_end, codec.kSize, back) == JND_DECODE_OK) {
        std::vector<std::uint8_t> again(codec.kSize);
        codec.encode(back, again.data());
        CHECK(again == block);
      }
    }
  });
}

}  // namespace
