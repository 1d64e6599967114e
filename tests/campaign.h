// The size of random campaigns. JND_CAMPAIGN is a factor on the usual size of each: 1 by default, 0.2 for a fifth.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace jnd::test {

// Throws std::runtime_error if JND_CAMPAIGN is set to anything but a number above 0.
inline double campaign_factor() {
  const char* text = std::getenv("JND_CAMPAIGN");
  if (text == nullptr) return 1;
  char* end = nullptr;
  const double factor = std::strtod(text, &end);
  if (end == text || *end != '\0' || !(factor > 0 && factor <= 1e6))
    throw std::runtime_error("JND_CAMPAIGN must be a number above 0");
  return factor;
}

// How many cases to try; at least 1.
inline int campaign(int usual) {
  return std::max(1, static_cast<int>(std::lround(usual * campaign_factor())));
}

// How many steps lie from one case to the next where cases are steps of a session; JND_CAMPAIGN=7 makes 7 to 1.
inline int campaign_stride(int usual) {
  return std::max(1, static_cast<int>(std::lround(usual / campaign_factor())));
}

}  // namespace jnd::test
