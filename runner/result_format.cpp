#include "runner/result_format.h"

#include <cmath>

#include <fmt/format.h>

namespace jnd {

std::string number_text(double value, int decimals) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return fmt::format("{:.{}f}", value, decimals);
}

std::string percent_text(double fraction) {
  return std::isfinite(fraction) ? fmt::format("{:.1f} %", 100 * fraction) : "-";
}

std::string p_text(double p) {
  if (std::isnan(p)) return "-";
  return p < 1e-4 ? fmt::format("{:.1e}", p) : fmt::format("{:.4f}", p);
}

std::string range_text(double low, double high, int decimals) {
  if (std::isnan(low) || std::isnan(high)) return "-";
  return number_text(low, decimals) + " .. " + number_text(high, decimals);
}

int stiffness_decimals(const Protocol& protocol) noexcept {
  return protocol.stimulus.unit == StiffnessUnit::n_per_m ? 1 : 2;
}

std::string stiffness_text(double value, const Protocol& protocol) {
  return number_text(value, stiffness_decimals(protocol));
}

std::string_view unit_of(const Protocol& protocol) noexcept {
  return to_string(protocol.stimulus.unit);
}

int slope_step(const Protocol& protocol) noexcept {
  return protocol.stimulus.unit == StiffnessUnit::n_per_m ? 100 : 10;
}

const std::string& condition_text(const Protocol& protocol, int place) {
  return protocol.conditions[static_cast<std::size_t>(place)].name;
}

std::string joined(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + ", " + b;
}

std::string source_remark(DifferenceSource source, const StudyAnalysis& analysis) {
  if (source == analysis.by) return {};
  return source == DifferenceSource::mixed ? "nominal differences in part" : "nominal difference";
}

}  // namespace jnd
