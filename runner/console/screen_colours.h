// The colours of the screen: explicit pairs of foreground and background, so that a state looks the same on light and on
// dark terminals. Never the only carrier of meaning.
#pragma once

#include <array>

namespace jnd {

// What a colour stands for.
enum class Shade {
  none,       // the terminal's own colours
  real,       // a session that counts as data
  rehearsal,  // one that does not
  question,   // an answer is due
  say,        // words for the participant
  warning,    // something is to be seen to
  stop        // the devices give nothing
};
inline constexpr std::array kShades = {Shade::real, Shade::rehearsal, Shade::question,
                                       Shade::say,  Shade::warning,   Shade::stop};

struct ColourPair {
  short foreground = -1, background = -1;  // numbers of the terminal's palette
  bool operator==(const ColourPair&) const = default;
};

// palette: how many colours the terminal has. From 256 on those above 15, whose values are fixed (xterm's cube and greys);
// below the eight of old terminals, whose values are the terminal's.
ColourPair colours_of(Shade shade, int palette) noexcept;

}  // namespace jnd
