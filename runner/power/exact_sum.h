// A sum of doubles without rounding: the same bits in whatever order, and from whatever parts, it was added up.
//
// A long accumulator (Kulisch 2013, Computer Arithmetic and Validity, chapter 8): a fixed-point number wide enough for
// every double, in digits of 32 bits with room for their carries.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace jnd {

class ExactSum {
 public:
  void add(double value) noexcept;  // finite
  ExactSum& operator+=(const ExactSum& other) noexcept;
  double value() const noexcept;  // rounded; the same for equal sums

  // Hexadecimal digits of the sum in two's complement, with where they begin; "" is 0. Equal sums have equal texts.
  std::string text() const;
  // Throws std::invalid_argument where it is not such a text.
  static ExactSum from_text(std::string_view text);

 private:
  static constexpr int kDigits = 68;  // 2^-1074 up to 2^1024, and sums of 2^31 of them
  using Digits = std::array<std::int64_t, kDigits>;
  Digits carried() const noexcept;  // every digit but the last in 0..2^32 - 1

  Digits digits_{};
  std::uint32_t pending_ = 0;  // additions since digits were last carried
};

}  // namespace jnd
