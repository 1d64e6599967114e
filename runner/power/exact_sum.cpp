#include "runner/power/exact_sum.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>

namespace jnd {

namespace {

constexpr int kLowestExponent = -1074;  // of the last bit of a double
constexpr std::int64_t kBase = std::int64_t{1} << 32U;
constexpr std::uint32_t kMostPending = 1U << 29U;

}  // namespace

void ExactSum::add(double value) noexcept {
  if (value == 0) return;
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  auto mantissa = static_cast<std::int64_t>(std::ldexp(fraction, 53));
  exponent -= 53;
  if (exponent < kLowestExponent) {  // a subnormal number: its last bits are zeros
    mantissa >>= kLowestExponent - exponent;
    exponent = kLowestExponent;
  }
  const bool negative = mantissa < 0;
  const auto size = static_cast<std::uint64_t>(negative ? -mantissa : mantissa);
  const auto place = static_cast<unsigned>(exponent - kLowestExponent);
  const unsigned shift = place % 32;
  // The mantissa's 53 bits, shifted, cover up to three digits.
  const std::uint64_t low = (size & 0xffffffffU) << shift, high = (size >> 32U) << shift;
  const std::int64_t sign = negative ? -1 : 1;
  std::int64_t* digit = &digits_[place / 32];
  digit[0] += sign * static_cast<std::int64_t>(low & 0xffffffffU);
  digit[1] += sign * static_cast<std::int64_t>((low >> 32U) + (high & 0xffffffffU));
  digit[2] += sign * static_cast<std::int64_t>(high >> 32U);
  if (++pending_ < kMostPending) return;
  digits_ = carried();
  pending_ = 0;
}

ExactSum& ExactSum::operator+=(const ExactSum& other) noexcept {
  const Digits own = carried(), others = other.carried();
  for (std::size_t i = 0; i < own.size(); ++i) digits_[i] = own[i] + others[i];
  pending_ = 1;
  return *this;
}

ExactSum::Digits ExactSum::carried() const noexcept {
  Digits digits = digits_;
  std::int64_t carry = 0;
  for (std::size_t i = 0; i + 1 < digits.size(); ++i) {
    const std::int64_t sum = digits[i] + carry;
    carry = sum >> 32U;  // rounds down, of negative ones too
    digits[i] = sum - carry * kBase;
  }
  digits.back() += carry;
  return digits;
}

double ExactSum::value() const noexcept {
  Digits digits = carried();
  const bool negative = digits.back() < 0;
  if (negative) {
    ExactSum turned;
    for (std::size_t i = 0; i < digits.size(); ++i) turned.digits_[i] = -digits[i];
    digits = turned.carried();
  }
  // The four leading digits hold more than a double does; what is below them is less than half its last bit.
  int top = kDigits - 1;
  while (top > 0 && digits[static_cast<std::size_t>(top)] == 0) --top;
  double sum = 0;
  for (int i = std::max(0, top - 3); i <= top; ++i)
    sum += std::ldexp(static_cast<double>(digits[static_cast<std::size_t>(i)]), 32 * i + kLowestExponent);
  return negative ? -sum : sum;
}

std::string ExactSum::text() const {
  const Digits digits = carried();
  int first = 0, last = kDigits - 1;
  while (first < kDigits && digits[static_cast<std::size_t>(first)] == 0) ++first;
  if (first == kDigits) return "";
  const std::int64_t fill = digits.back() < 0 ? kBase - 1 : 0;
  const auto shown = [&](int i) {  // the last one keeps its sign by itself
    return i == kDigits - 1 ? digits[static_cast<std::size_t>(i)] & (kBase - 1) : digits[static_cast<std::size_t>(i)];
  };
  while (last > first && shown(last) == fill) --last;
  std::string text = fmt::format("{}{}:", fill == 0 ? '+' : '-', first);
  for (int i = first; i <= last; ++i) text += fmt::format("{:08x}", shown(i));
  return text;
}

ExactSum ExactSum::from_text(std::string_view text) {
  ExactSum sum;
  if (text.empty()) return sum;
  const auto fail = [] { return std::invalid_argument("not an exact sum"); };
  const std::size_t colon = text.find(':');
  if ((text[0] != '+' && text[0] != '-') || colon == std::string_view::npos || (text.size() - colon - 1) % 8 != 0)
    throw fail();
  int first = 0;
  const auto head = std::from_chars(text.data() + 1, text.data() + colon, first);
  const std::size_t count = (text.size() - colon - 1) / 8;
  if (head.ec != std::errc() || head.ptr != text.data() + colon || first < 0 || count < 1 ||
      static_cast<std::size_t>(first) + count > kDigits)
    throw fail();
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t digit = 0;
    const char* const begin = text.data() + colon + 1 + i * 8;
    const auto read = std::from_chars(begin, begin + 8, digit, 16);
    if (read.ec != std::errc() || read.ptr != begin + 8) throw fail();
    sum.digits_[static_cast<std::size_t>(first) + i] = digit;
  }
  if (text[0] == '-') {
    for (std::size_t i = static_cast<std::size_t>(first) + count; i < sum.digits_.size(); ++i)
      sum.digits_[i] = kBase - 1;
    sum.digits_.back() -= kBase;  // two's complement
  }
  return sum;
}

}  // namespace jnd
