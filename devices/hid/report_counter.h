// What is missing of a numbered stream of reports.
#pragma once

#include <cstdint>

namespace jnd {

// Numbers are modulo 2^32. A report whose number is not above the last one's (it is within the 2^31 before it) is old:
// it came twice or out of order. A source that begins anew without leaving the bus sends old ones only: the
// kBeginsAnew-th in a row is taken as the first of a new numbering.
class ReportCounter {
 public:
  static constexpr int kBeginsAnew = 100;

  // A new connection: whatever comes next is its first.
  void begin() noexcept { begun_ = false; }

  // False: old, not to be shown.
  bool take(std::uint32_t number) noexcept {
    const std::uint32_t ahead = number - last_;
    if (begun_ && (ahead == 0 || ahead > kHalf)) {
      ++old_;
      if (++old_in_a_row_ < kBeginsAnew) return false;
      begun_ = false;
      --old_;
    }
    if (begun_) missing_ += ahead - 1;
    begun_ = true;
    last_ = number;
    old_in_a_row_ = 0;
    ++taken_;
    return true;
  }

  std::int64_t taken() const noexcept { return taken_; }
  std::int64_t missing() const noexcept { return missing_; }  // numbers between those taken
  std::int64_t old() const noexcept { return old_; }

 private:
  static constexpr std::uint32_t kHalf = 0x7FFFFFFFU;
  bool begun_ = false;
  std::uint32_t last_ = 0;
  int old_in_a_row_ = 0;
  std::int64_t taken_ = 0, missing_ = 0, old_ = 0;
};

}  // namespace jnd
