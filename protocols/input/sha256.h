// SHA-256 (FIPS 180-4) of bytes: identity of protocol files and links of the event log's chain.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace jnd {

using Sha256 = std::array<std::uint8_t, 32>;

Sha256 sha256(std::string_view bytes) noexcept;
std::string sha256_hex(std::string_view bytes);  // 64 lower-case hexadecimal digits
std::string to_hex(const Sha256& hash);

// Of bytes that come piece by piece.
class Sha256Stream {
 public:
  Sha256Stream();
  ~Sha256Stream();
  Sha256Stream(Sha256Stream&&) noexcept;
  Sha256Stream& operator=(Sha256Stream&&) noexcept;
  void add(std::string_view bytes) noexcept;
  Sha256 finish() noexcept;  // once, and last

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace jnd
