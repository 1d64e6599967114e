// The lines in which a program or a file tells where the fingers are: version 1 of the format, as
// devices/trackers/README.md describes it. Text to numbers, nothing else.
//
//   jnd-poses 1 units=m clock=monotonic
//   index 81234.117250 0.0652 -0.0011 0.0004 1 0 0 0
//   thumb 81234.117250 lost
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <Eigen/Geometry>

#include "devices/machine/line_cutter.h"

namespace jnd {

// Longest line, bytes, without its end.
inline constexpr std::size_t kLongestPoseLine = 256;
// The names of fingers, thumb first, in the order of enum jnd_finger.
inline constexpr std::array<std::string_view, 5> kFingerNames = {"thumb", "index", "middle", "ring", "little"};
// Farthest from the tracker's origin along an axis, m: what lies beyond was mostly meant in millimetres.
inline constexpr double kFarthestPose_m = 10;
// Farthest time either way, ns: differences then fit in 64 bits.
inline constexpr std::int64_t kLongestPoseTime_ns = 4'000'000'000'000'000'000;
// A quaternion's length may differ from 1 by so much, and is then made 1.
inline constexpr double kQuaternionSlack = 0.01;

// Whose seconds the times are.
enum class PoseClock {
  monotonic,  // CLOCK_MONOTONIC of this machine
  source      // the source's own
};

struct PoseLine {
  int finger = 0;            // into kFingerNames
  std::int64_t time_ns = 0;  // when it was true, on the clock of the header
  bool seen = true;          // false: the tracker has lost the finger; the pose below is then none
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();             // of the fingertip, tracker frame
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // unit; device frame to tracker frame
  double flexion_rad = 0;                                           // 0 where none is given
  std::optional<std::uint32_t> sequence;
};

// Without the end of the line; a carriage return before it is allowed. `why` (static text) says what is wrong where the
// result is none. Locale-independent; any bytes may come.
std::optional<PoseClock> parse_pose_header(std::string_view line, const char*& why) noexcept;
std::optional<PoseLine> parse_pose_line(std::string_view text, const char*& why) noexcept;
// An empty line, or a comment.
bool is_blank_or_comment(std::string_view line) noexcept;

using PoseLineCutter = LineCutter<kLongestPoseLine>;

}  // namespace jnd
