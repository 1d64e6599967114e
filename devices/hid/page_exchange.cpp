#include "devices/hid/page_exchange.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/report_words.h"

namespace jnd {

namespace {

using SteadyTime = std::chrono::steady_clock::time_point;

SteadyTime now() {
  return std::chrono::steady_clock::now();
}

int milliseconds_until(SteadyTime deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - now()).count();
  return static_cast<int>(std::max<std::int64_t>(left, 0));
}

std::string name_of(jnd_page_number page) {
  return fmt::format("page {} ({})", static_cast<int>(page), page_word(page));
}

}  // namespace

PageExchange::PageExchange(HidHandle& handle, std::string device, Listener others, PagePatience patience)
    : handle_(handle),
      device_(std::move(device)),
      others_(std::move(others)),
      patience_(patience),
      // Not what another program, or this one a moment ago, has asked with: late answers then match nothing.
      token_(static_cast<std::uint32_t>(now().time_since_epoch().count())) {}

int PageExchange::read_report(std::span<std::uint8_t> bytes, int wait_ms) {
  const int count = handle_.read(bytes, wait_ms);
  if (count == kHidGone)
    throw DeviceError(
        fmt::format("{}: is gone ({}); look at the cable and connect it again", device_, handle_.error()));
  return count;
}

// Reports that waited unread may have filled the system's queue, which then drops the answer.
void PageExchange::drain() {
  std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
  constexpr int kMostWaiting = 256;
  for (int i = 0; i < kMostWaiting; ++i) {
    const int count = read_report(bytes, 0);
    if (count == kHidTimeOut) return;
    if (others_) others_(std::span(bytes).first(static_cast<std::size_t>(count)));
  }
}

bool PageExchange::take_answer(const jnd_request& request, int wait_ms, jnd_answer& answer) {
  const SteadyTime deadline = now() + std::chrono::milliseconds(wait_ms);
  std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
  do {
    const auto count = static_cast<std::size_t>(read_report(bytes, milliseconds_until(deadline)));
    if (count == 0) continue;
    const jnd_decode_result result = jnd_decode_answer(bytes.data(), count, &answer);
    if (result == JND_DECODE_OK && answer.token == request.token && answer.page == request.page) return true;
    if (result == JND_DECODE_VERSION) other_version_ = bytes[1];
    if (result != JND_DECODE_OK && others_) others_(std::span(bytes).first(count));
  } while (now() < deadline);
  return false;
}

PageData PageExchange::ask(jnd_operation operation, jnd_page_number page, const PageData& data, int wait_ms) {
  other_version_ = 0;
  drain();
  for (int attempt = 0; attempt < patience_.tries; ++attempt) {
    jnd_request request{.operation = static_cast<std::uint8_t>(operation),
                        .page = static_cast<std::uint8_t>(page),
                        .token = ++token_,
                        .data = {}};
    std::copy(data.begin(), data.end(), request.data);
    std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
    jnd_encode_request(&request, bytes.data());
    if (!handle_.write(bytes))
      throw DeviceError(fmt::format("{}: takes no requests ({}); connect it again", device_, handle_.error()));
    jnd_answer answer{};
    if (!take_answer(request, wait_ms, answer)) continue;
    if (answer.result == JND_PAGE_OK) {
      PageData out;
      std::copy(std::begin(answer.data), std::end(answer.data), out.begin());
      return out;
    }
    if (answer.result == JND_PAGE_UNKNOWN)
      throw DeviceError(fmt::format("{}: knows no {}; update its firmware", device_, name_of(page)));
    if (answer.result == JND_PAGE_REFUSED)
      throw DeviceError(fmt::format(
          "{}: refuses to {} {}; {}", device_, operation == JND_READ_PAGE ? "show" : "store", name_of(page),
          operation == JND_READ_PAGE ? "update its firmware"
                                     : "it stores at rest only: let no other program drive it, and try again"));
    throw DeviceError(fmt::format("{}: finds the contents of {} not valid", device_, name_of(page)));
  }
  if (other_version_ != 0)
    throw DeviceError(
        fmt::format("{}: speaks version {} of the report protocol, this program speaks versions {} to {}; update the "
                    "one that is older",
                    device_, other_version_, int{JND_PROTOCOL_VERSION}, int{JND_PROTOCOL_VERSION}));
  throw DeviceError(
      fmt::format("{}: did not answer {} requests for {}; switch it off and on, and look whether its firmware runs",
                  device_, patience_.tries, name_of(page)));
}

PageData PageExchange::read(jnd_page_number page) {
  return ask(JND_READ_PAGE, page, {}, patience_.read_ms);
}

void PageExchange::write(jnd_page_number page, const PageData& data) {
  (void)ask(JND_WRITE_PAGE, page, data, patience_.write_ms);
}

namespace {

template <typename Content>
Content decoded(const PageData& data, bool (*decode)(const std::uint8_t*, Content*), const std::string& device,
                jnd_page_number page) {
  Content content{};
  if (!decode(data.data(), &content))
    throw DeviceError(fmt::format("{}: its {} holds what the report protocol does not allow; update its firmware",
                                  device, name_of(page)));
  return content;
}

}  // namespace

jnd_identity PageExchange::identity() {
  const PageData data = read(JND_PAGE_IDENTITY);
  // Before the rest is looked at: another version may have another rest.
  const int lowest = data[0], highest = data[1];
  if (lowest > JND_PROTOCOL_VERSION || highest < JND_PROTOCOL_VERSION)
    throw DeviceError(
        fmt::format("{}: speaks versions {} to {} of the report protocol, this program speaks versions {} to {}; "
                    "update the one that is older",
                    device_, lowest, highest, int{JND_PROTOCOL_VERSION}, int{JND_PROTOCOL_VERSION}));
  return decoded<jnd_identity>(data, jnd_decode_identity, device_, JND_PAGE_IDENTITY);
}

jnd_limits PageExchange::limits() {
  return decoded<jnd_limits>(read(JND_PAGE_LIMITS), jnd_decode_limits, device_, JND_PAGE_LIMITS);
}

jnd_geometry PageExchange::geometry() {
  return decoded<jnd_geometry>(read(JND_PAGE_GEOMETRY), jnd_decode_geometry, device_, JND_PAGE_GEOMETRY);
}

jnd_force_table PageExchange::force_table() {
  return decoded<jnd_force_table>(read(JND_PAGE_FORCE_TABLE), jnd_decode_force_table, device_, JND_PAGE_FORCE_TABLE);
}

jnd_certificate PageExchange::certificate() {
  return decoded<jnd_certificate>(read(JND_PAGE_CERTIFICATE), jnd_decode_certificate, device_, JND_PAGE_CERTIFICATE);
}

void PageExchange::store(jnd_page_number page, const PageData& data) {
  write(page, data);
  if (read(page) != data)
    throw DeviceError(fmt::format("{}: gives back another {} than was stored; do not use it", device_, name_of(page)));
}

void PageExchange::store(const jnd_force_table& table) {
  PageData data{};
  jnd_encode_force_table(&table, data.data());
  store(JND_PAGE_FORCE_TABLE, data);
}

void PageExchange::store(const jnd_certificate& certificate) {
  PageData data{};
  jnd_encode_certificate(&certificate, data.data());
  store(JND_PAGE_CERTIFICATE, data);
}

}  // namespace jnd
