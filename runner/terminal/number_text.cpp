#include "runner/terminal/number_text.h"

#include <cmath>

#include <fmt/format.h>

namespace jnd {

std::string number_text(double value, int decimals) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  // A rounding -0.000 is nothing.
  return text.find_first_not_of("-0.") == std::string::npos ? fmt::format("{:.{}f}", 0.0, decimals) : text;
}

std::string percent_text(double fraction) {
  return std::isfinite(fraction) ? fmt::format("{:.1f} %", 100 * fraction) : "-";
}

std::string p_value_text(double p) {
  if (std::isnan(p)) return "-";
  if (p == 0) return "0";  // below what a double holds
  return p < 1e-4 ? fmt::format("{:.1e}", p) : fmt::format("{:.4f}", p);
}

std::string range_text(double low, double high, int decimals) {
  return range_text(number_text(low, decimals), number_text(high, decimals));
}

std::string range_text(std::string_view low, std::string_view high) {
  return low == "-" || high == "-" ? "-" : fmt::format("{} to {}", low, high);
}

std::string counted(std::int64_t count, std::string_view thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

}  // namespace jnd
