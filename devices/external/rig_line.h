// A line of an external rig to a message, or the reason why it is none. Any bytes may come.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "devices/external/rig_messages.h"

namespace jnd {

// How far a number of a rig may be from zero: what lies beyond is no measurement.
inline constexpr double kLargestRigNumber = 1e12;
// Longest time that a rig may tell, s.
inline constexpr double kLongestRigTime_s = 1e7;

struct ReadRigLine {
  std::optional<RigMessage> message;  // or else
  std::string refused;  // why: one line, without control characters; its quotes of the rig's text are short
  std::string type;     // the message's type where it could be read and is known, else empty
};

// Refused: a line above kLongestRigLine, bytes that are not UTF-8 or a control character in a text, what is no JSON
// object, an unknown type, an unknown, missing or repeated key, a number that is not finite or out of range, names that
// are none (a letter, then letters, digits, "_", "-" and ".") or occur twice. line: without its end; a carriage return
// before that does no harm.
ReadRigLine read_rig_line(std::string_view line);

// For messages: at most 120 bytes, and what is no printable ASCII becomes a question mark.
std::string ascii_quote(std::string_view text);

}  // namespace jnd
