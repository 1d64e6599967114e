// Cuts a stream of bytes into lines, however the bytes come.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace jnd {

// Longest: bytes of a line, without its end. Nothing allocates.
template <std::size_t Longest>
class LineCutter {
 public:
  // Calls whole(std::string_view) for each line that ends within `bytes`, and too_long() for each longer than Longest
  // (once, at its end). Views are valid within the call.
  template <typename Whole, typename TooLong>
  void cut(std::string_view bytes, const Whole& whole, const TooLong& too_long) {
    for (const char byte : bytes) {
      if (byte != '\n') {
        if (length_ < line_.size()) line_[length_] = byte;
        ++length_;
        continue;
      }
      if (length_ > line_.size())
        too_long();
      else
        whole(std::string_view(line_.data(), length_));
      length_ = 0;
    }
  }
  // The line that has not ended yet; cut off where it is too long.
  std::string_view rest() const noexcept { return {line_.data(), length_ < line_.size() ? length_ : line_.size()}; }
  void clear() noexcept { length_ = 0; }

 private:
  std::array<char, Longest> line_{};
  std::size_t length_ = 0;  // may be beyond the array
};

}  // namespace jnd
