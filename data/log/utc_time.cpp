#include "data/log/utc_time.h"

#include <charconv>
#include <chrono>

#include <fmt/format.h>

#include "data/log/storage_error.h"

namespace jnd {

namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::string_view kPattern = "dddd-dd-ddTdd:dd:dd.dddddddddZ";

bool fits(std::string_view text) noexcept {
  if (text.size() != kPattern.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (kPattern[i] == 'd' ? !digit : text[i] != kPattern[i]) return false;
  }
  return true;
}

template <typename Number>
Number number_at(std::string_view text, std::size_t first, std::size_t length) noexcept {
  Number number = 0;
  std::from_chars(text.data() + first, text.data() + first + length, number);
  return number;
}

}  // namespace

std::string to_iso8601(std::int64_t utc_ns) {
  using std::chrono::nanoseconds;
  const std::chrono::sys_time<nanoseconds> time{nanoseconds{utc_ns}};
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date{day};
  const std::int64_t in_day = (time - day).count();
  const std::int64_t seconds = in_day / kNanosecondsPerSecond;
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:09}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), seconds / 3600,
                     seconds / 60 % 60, seconds % 60, in_day % kNanosecondsPerSecond);
}

std::int64_t utc_ns_from(std::string_view iso8601) {
  using namespace std::chrono;
  if (fits(iso8601)) {
    const year_month_day date{year{number_at<int>(iso8601, 0, 4)}, month{number_at<unsigned>(iso8601, 5, 2)},
                              day{number_at<unsigned>(iso8601, 8, 2)}};
    if (date.ok()) {
      const std::int64_t days = sys_days{date}.time_since_epoch().count();
      const std::int64_t seconds = number_at<std::int64_t>(iso8601, 11, 2) * 3600 +
                                   number_at<std::int64_t>(iso8601, 14, 2) * 60 +
                                   number_at<std::int64_t>(iso8601, 17, 2);
      return (days * 86400 + seconds) * kNanosecondsPerSecond + number_at<std::int64_t>(iso8601, 20, 9);
    }
  }
  throw StorageError(fmt::format("\"{}\" is not a time like 2026-01-31T09:30:00.000000000Z", iso8601));
}

}  // namespace jnd
