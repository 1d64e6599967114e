#include "analysis/detection/counts.h"

#include "analysis/numerics/words.h"

namespace jnd {

namespace {

constexpr auto kCorrectionWords =
    words<Correction>({{"none", Correction::none}, {"loglinear", Correction::loglinear}, {"half", Correction::half}});

}  // namespace

std::string_view to_string(Correction correction) noexcept {
  return word_of(kCorrectionWords, correction);
}

std::optional<Correction> correction_from(std::string_view name) noexcept {
  return value_of(kCorrectionWords, name);
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
