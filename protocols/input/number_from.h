// A text that is one number and nothing else.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace jnd {

// In decimals, without blanks and without a leading '+'; none for anything else, and where it is out of the type's
// range. A floating-point number may be "inf" or "nan".
template <typename Number>
std::optional<Number> number_from(std::string_view text) noexcept {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stopped != end) return std::nullopt;
  return value;
}

}  // namespace jnd
