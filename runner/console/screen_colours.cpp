#include "runner/console/screen_colours.h"

namespace jnd {

namespace {

// xterm's 256.
constexpr short kBlack = 16, kWhite = 231, kGreen = 22, kPurple = 90, kBlue = 25, kSlate = 236, kYellow = 220,
                kRed = 160;
// The first eight of every terminal.
constexpr short kBlack8 = 0, kRed8 = 1, kGreen8 = 2, kYellow8 = 3, kBlue8 = 4, kMagenta8 = 5, kWhite8 = 7;
constexpr int kFixedPalette = 256;

ColourPair of_fixed(Shade shade) noexcept {
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

ColourPair of_eight(Shade shade) noexcept {
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

}  // namespace

ColourPair colours_of(Shade shade, int palette) noexcept {
  return palette >= kFixedPalette ? of_fixed(shade) : of_eight(shade);
}

}  // namespace jnd
