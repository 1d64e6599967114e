// The colours of the screen: explicit pairs of foreground and background, so that a state looks the same on light and on
// dark terminals. Never the only carrier of meaning.
#pragma once

#include <array>

#include "runner/console/console_display.h"

namespace jnd {

inline constexpr std::array kShades = {Shade::real, Shade::rehearsal, Shade::question,
                                       Shade::say,  Shade::warning,   Shade::stop};

struct ColourPair {
  short foreground = -1, background = -1;  // numbers of the terminal's palette
  bool operator==(const ColourPair&) const = default;
};

namespace shade_colours {
// xterm's 256.
inline constexpr short kBlack = 16, kWhite = 231, kGreen = 22, kPurple = 90, kBlue = 25, kSlate = 236, kYellow = 220,
                       kRed = 160;
// The first eight of every terminal.
inline constexpr short kBlack8 = 0, kRed8 = 1, kGreen8 = 2, kYellow8 = 3, kBlue8 = 4, kMagenta8 = 5, kWhite8 = 7;
inline constexpr int kFixedPalette = 256;

constexpr ColourPair of_fixed(Shade shade) noexcept {
  switch (shade) {
    case Shade::real:
      return {kWhite, kGreen};
    case Shade::rehearsal:
      return {kWhite, kPurple};
    case Shade::question:
      return {kWhite, kBlue};
    case Shade::say:
      return {kWhite, kSlate};
    case Shade::warning:
      return {kBlack, kYellow};
    case Shade::stop:
      return {kWhite, kRed};
    case Shade::none:
      break;
  }
  return {};
}

constexpr ColourPair of_eight(Shade shade) noexcept {
  switch (shade) {
    case Shade::real:
      return {kBlack8, kGreen8};
    case Shade::rehearsal:
      return {kWhite8, kMagenta8};
    case Shade::question:
      return {kWhite8, kBlue8};
    case Shade::say:
      return {kWhite8, kBlack8};
    case Shade::warning:
      return {kBlack8, kYellow8};
    case Shade::stop:
      return {kWhite8, kRed8};
    case Shade::none:
      break;
  }
  return {};
}
}  // namespace shade_colours

// palette: how many colours the terminal has. From 256 on those above 15, whose values are fixed (xterm's cube and greys);
// below the eight of old terminals, whose values are the terminal's.
constexpr ColourPair colours_of(Shade shade, int palette) noexcept {
  return palette >= shade_colours::kFixedPalette ? shade_colours::of_fixed(shade) : shade_colours::of_eight(shade);
}

}  // namespace jnd
