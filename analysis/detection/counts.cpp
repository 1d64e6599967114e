#include "analysis/detection/counts.h"

namespace jnd {

std::string_view to_string(Correction correction) noexcept {
  switch (correction) {
    case Correction::none:
      return "none";
    case Correction::loglinear:
      return "loglinear";
    case Correction::half:
      return "half";
  }
  return "";
}

std::optional<Correction> correction_from(std::string_view name) noexcept {
  for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half})
    if (name == to_string(correction)) return correction;
  return std::nullopt;
}

double corrected_rate(int k, int n, Correction correction) noexcept {
  const auto answers = static_cast<double>(k);
  const auto trials = static_cast<double>(n);
  switch (correction) {
    case Correction::none:
      break;
    case Correction::loglinear:
      return (answers + 0.5) / (trials + 1.0);
    case Correction::half:
      if (k == 0) return 0.5 / trials;
      if (k == n) return 1.0 - 0.5 / trials;
      break;
  }
  return answers / trials;
}

}  // namespace jnd
