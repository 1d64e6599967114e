#include "devices/hid/virtual/report_outlet.h"

#include <algorithm>
#include <utility>

namespace jnd {

namespace {

using Report = std::array<std::uint8_t, JND_REPORT_SIZE>;

constexpr std::uint8_t kOtherVersion = 9;
constexpr std::size_t kCrcAt = JND_REPORT_SIZE - 4;

Report copy_of(std::span<const std::uint8_t, JND_REPORT_SIZE> report) noexcept {
  Report copy{};
  std::copy(report.begin(), report.end(), copy.begin());
  return copy;
}

}  // namespace

Report in_version(std::span<const std::uint8_t, JND_REPORT_SIZE> report, std::uint8_t version) noexcept {
  Report changed = copy_of(report);
  jnd_answer answer{};
  if (jnd_decode_answer(changed.data(), changed.size(), &answer) == JND_DECODE_OK && answer.page == JND_PAGE_IDENTITY &&
      answer.result == JND_PAGE_OK) {
    answer.data[0] = answer.data[1] = version;
    jnd_encode_answer(&answer, changed.data());
    return changed;
  }
  changed[1] = version;
  const std::uint32_t crc = jnd_crc32(changed.data(), kCrcAt);
  for (std::size_t byte = 0; byte < 4; ++byte)
    changed[kCrcAt + byte] = static_cast<std::uint8_t>((crc >> (8 * byte)) & 0xFFU);
  return changed;
}

ReportOutlet::ReportOutlet(std::uint8_t stream, InputReport port) : stream_(stream), port_(std::move(port)) {}

bool ReportOutlet::send(std::span<const std::uint8_t, JND_REPORT_SIZE> report) {
  Report out = wrong_version_ ? in_version(report, kOtherVersion) : copy_of(report);
  if (out[0] != stream_) {
    if (!port_(out)) return false;
    ++answered_;
    return true;
  }
  if (to_drop_ > 0) {
    --to_drop_;
    ++dropped_;
    return true;
  }
  const bool damages = to_damage_ > 0;
  if (damages) out[kCrcAt] = static_cast<std::uint8_t>(out[kCrcAt] ^ 0x55U);
  if (!port_(out)) return false;
  ++sent_;
  if (damages) {
    --to_damage_;
    ++damaged_;
  }
  return true;
}

bool ReportOutlet::obey(const DeviceOrder& order) noexcept {
  switch (order.kind) {
    case OrderKind::drop:
      to_drop_ = static_cast<std::int64_t>(order.amount);
      return true;
    case OrderKind::damage:
      to_damage_ = static_cast<std::int64_t>(order.amount);
      return true;
    case OrderKind::wrong_version:
      wrong_version_ = order.on;
      return true;
    default:
      return false;
  }
}

}  // namespace jnd
