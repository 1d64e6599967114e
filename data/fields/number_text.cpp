#include "data/fields/number_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace jnd {

namespace {

constexpr int kMostDecimals = 6;

// digits: that count.
int decimals_for(double size, int digits) noexcept {
  if (!(size > 0) || !std::isfinite(size)) return digits - 1;
  return std::clamp(digits - 1 - static_cast<int>(std::floor(std::log10(size))), 0, kMostDecimals);
}

bool is_zero(std::string_view text) noexcept {
  return text.find_first_not_of("-0.") == std::string_view::npos;
}

}  // namespace

int decimals_of_spread(double spread) noexcept {
  return decimals_for(spread, 2);
}

int decimals_of_size(double size) noexcept {
  return decimals_for(size, 3);
}

std::string number_text(double value, int decimals) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (!is_zero(text)) return text;
  return value == 0 ? fmt::format("{:.{}f}", 0.0, decimals) : fmt::format("{:.1g}", value);
}

std::string percent_text(double fraction) {
  return std::isfinite(fraction) ? number_text(100 * fraction, 1) + " %" : "-";
}

std::string p_value_text(double p) {
  if (std::isnan(p)) return "-";
  if (p < 0.001) return "< .001";
  std::string text = fmt::format("{:.3f}", p);
  if (p >= 1) return text;
  return text.front() == '1' ? "> .999" : text.substr(1);
}

std::string p_text(double p) {
  if (std::isnan(p)) return "no p";
  const std::string text = p_value_text(p);
  return text.front() == '<' || text.front() == '>' ? "p " + text : "p = " + text;
}

std::string range_text(double low, double high, int decimals) {
  return range_text(number_text(low, decimals), number_text(high, decimals));
}

std::string range_text(std::string_view low, std::string_view high) {
  return low.empty() || low == "-" || high.empty() || high == "-" ? "-" : fmt::format("{} to {}", low, high);
}

std::string counted(std::int64_t count, std::string_view thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

}  // namespace jnd
