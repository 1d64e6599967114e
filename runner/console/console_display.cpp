#include "runner/console/console_display.h"

#include <fmt/format.h>

namespace jnd {

std::string trial_heading(const TrialOutline& outline) {
  if (outline.practice) return fmt::format("Practice {} of {}", outline.number, outline.total);
  return fmt::format("Trial {} of {}{}", outline.number, outline.at_most ? "at most " : "", outline.total);
}

}  // namespace jnd
