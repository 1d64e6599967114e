// Reports of devices: whatever the bytes, a decoder takes only what the protocol allows, and that is encoded to the
// same bytes again. Each input is looked at as it is, and once more for every kind of report with its id, version and
// CRC put right, so that the fields behind them are reached.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "tests/devices/hid/firmware/codec_members.h"
#include "tests/devices/hid/firmware/codec_ranges.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using Report = std::array<std::uint8_t, JND_REPORT_SIZE>;

// Bit by bit from the definition, not the codec's own.
std::uint32_t crc32_of(const std::uint8_t* bytes, std::size_t count) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (std::size_t i = 0; i < 8 * count; ++i) {
    const bool odd = ((crc ^ static_cast<std::uint32_t>(bytes[i / 8] >> i % 8)) & 1U) != 0;
    crc = (crc >> 1U) ^ (odd ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

// The same bytes as a report that only its fields can be wrong in.
Report sealed(const std::uint8_t* data, std::size_t size, std::uint8_t id) {
  Report report{};
  std::copy_n(data, std::min(size, report.size()), report.begin());
  report[0] = id;
  report[1] = JND_PROTOCOL_VERSION;
  const std::uint32_t crc = crc32_of(report.data(), 60);
  for (unsigned i = 0; i < 4; ++i) report.at(60 + i) = static_cast<std::uint8_t>(crc >> 8 * i);
  return report;
}

template <typename ThisCodec, typename Record>
jnd_decode_result check(ThisCodec codec, Record record, const std::uint8_t* data, std::size_t size) {
  std::array<std::uint8_t, sizeof record> before{}, after{};
  before.fill(0xA5);
  std::memcpy(&record, before.data(), sizeof record);
  const jnd_decode_result result = codec.decode(data, size, record);
  if (result != JND_DECODE_OK) {
    std::memcpy(after.data(), &record, sizeof record);
    jnd::fuzz::require(after == before, "a refused report changes nothing");
    return result;
  }
  jnd::fuzz::require(jnd::codec::allowed(record), "what is decoded is what the protocol allows");
  std::array<std::uint8_t, ThisCodec::kSize> again{};
  codec.encode(record, again.data());
  jnd::fuzz::require(std::equal(again.begin(), again.end(), data), "what is decoded is encoded to the same bytes");
  return result;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  int taken = 0;
  jnd::codec::for_each_report([&](auto codec, auto record) {
    const jnd_decode_result as_it_is = check(codec, record, data, size);
    if (as_it_is == JND_DECODE_OK) ++taken;
    jnd::fuzz::require((size == JND_REPORT_SIZE) != (as_it_is == JND_DECODE_LENGTH), "a report has 64 bytes");
    const Report report = sealed(data, size, codec.kId);
    const jnd_decode_result result = check(codec, record, report.data(), report.size());
    jnd::fuzz::require(result == JND_DECODE_OK || result == JND_DECODE_RANGE, "only the fields can be wrong");
  });
  jnd::fuzz::require(taken <= 1, "a report is of one kind");
  // Pages: the bytes of a report behind its header, as in requests and answers.
  std::array<std::uint8_t, JND_PAGE_SIZE> page{};
  if (size > 8) std::copy_n(data + 8, std::min(size - 8, page.size()), page.begin());
  jnd::codec::for_each_page([&](auto codec, auto record) { check(codec, record, page.data(), page.size()); });
  return 0;
}
