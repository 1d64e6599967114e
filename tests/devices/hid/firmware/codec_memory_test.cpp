// Decoders read their `count` bytes and nothing else, encoders write their own and nothing else: the bytes stand at the
// very ends of a page of memory that has no neighbours, and in heap blocks of their own for the address sanitizer.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "tests/catch.h"
#include "tests/devices/hid/firmware/codec_vector_file.h"

namespace {

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
