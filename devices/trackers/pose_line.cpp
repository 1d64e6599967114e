#include "devices/trackers/pose_line.h"

#include <algorithm>
#include <cmath>

#include "protocols/input/number_from.h"

namespace jnd {

namespace {

constexpr double kMostFlexion_rad = 3.2;

bool blank(char byte) noexcept {
  return byte == ' ' || byte == '\t' || byte == '\r';
}

// The words of a line, one after the other.
class Words {
 public:
  explicit Words(std::string_view line) noexcept : rest_(line) {}

  // Empty: no more.
  std::string_view next() noexcept {
    while (!rest_.empty() && blank(rest_.front())) rest_.remove_prefix(1);
    std::size_t length = 0;
    while (length < rest_.size() && !blank(rest_[length])) ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }

 private:
  std::string_view rest_;
};

bool to_number(std::string_view word, double& value) noexcept {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const std::optional<double> number = number_from<double>(word);
  value = number.value_or(value);
  return number && std::isfinite(*number);
}

// "n=17"
bool to_sequence(std::string_view word, std::uint32_t& value) noexcept {
  if (!word.starts_with("n=")) return false;
  const std::optional<std::uint32_t> number = number_from<std::uint32_t>(word.substr(2));
  value = number.value_or(value);
  return number.has_value();
}

// What may follow a pose or "lost": at most the number of the line. False where anything else does.
bool read_end(std::string_view word, Words& words, PoseLine& line) noexcept {
  if (word.empty()) return true;
  std::uint32_t sequence = 0;
  if (!to_sequence(word, sequence) || !words.next().empty()) return false;
  line.sequence = sequence;
  return true;
}

// Position and orientation; null, or what is wrong.
const char* read_pose(std::string_view word, Words& words, PoseLine& line) noexcept {
  std::array<double, 7> numbers{};
  for (double& number : numbers) {
    if (!to_number(word, number)) return "seven finite numbers (x y z qw qx qy qz) must follow the time";
    word = words.next();
  }
  for (int axis = 0; axis < 3; ++axis) {
    line.position_m[axis] = numbers[static_cast<std::size_t>(axis)];
    if (std::abs(line.position_m[axis]) > kFarthestPose_m) return "the position is beyond 10 m: is it in metres?";
  }
  line.orientation = Eigen::Quaterniond(numbers[3], numbers[4], numbers[5], numbers[6]);
  const double length = line.orientation.norm();
  if (!(std::abs(length - 1) <= kQuaternionSlack)) return "the quaternion (qw qx qy qz) is not of length 1";
  line.orientation.coeffs() /= length;
  if (!word.empty() && !word.starts_with("n=")) {
    if (!to_number(word, line.flexion_rad) || std::abs(line.flexion_rad) > kMostFlexion_rad)
      return "the flexion must be a number of radians";
    word = words.next();
  }
  return read_end(word, words, line) ? nullptr : "nothing may follow but n= and a number from 0 to 4294967295";
}

}  // namespace

bool is_blank_or_comment(std::string_view line) noexcept {
  const std::string_view word = Words(line).next();
  return word.empty() || word.front() == '#';
}

std::optional<PoseClock> parse_pose_header(std::string_view line, const char*& why) noexcept {
  Words words(line);
  if (words.next() != "jnd-poses") {
    why = "the first line must be: jnd-poses 1 units=m clock=monotonic (or clock=source)";
    return std::nullopt;
  }
  if (words.next() != "1") {
    why = "this version reads jnd-poses 1 only";
    return std::nullopt;
  }
  bool metres = false;
  std::optional<PoseClock> clock;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word == "units=m" && !metres) {
      metres = true;
    } else if ((word == "clock=monotonic" || word == "clock=source") && !clock) {
      clock = word == "clock=source" ? PoseClock::source : PoseClock::monotonic;
    } else {
      why = "after jnd-poses 1 come units=m, and clock=monotonic or clock=source";
      return std::nullopt;
    }
  }
  if (metres && clock) return clock;
  why = "jnd-poses 1 must be followed by units=m, and by clock=monotonic or clock=source";
  return std::nullopt;
}

std::optional<PoseLine> parse_pose_line(std::string_view text, const char*& why) noexcept {
  if (text.size() > kLongestPoseLine) {
    why = "longer than 256 bytes";
    return std::nullopt;
  }
  Words words(text);
  PoseLine line;
  const auto* const finger = std::find(kFingerNames.begin(), kFingerNames.end(), words.next());
  if (finger == kFingerNames.end()) {
    why = "must begin with thumb, index, middle, ring or little";
    return std::nullopt;
  }
  line.finger = static_cast<int>(finger - kFingerNames.begin());
  double time_s = 0;
  if (!to_number(words.next(), time_s) || std::abs(1e9 * time_s) > static_cast<double>(kLongestPoseTime_ns)) {
    why = "a time in seconds must follow the finger";
    return std::nullopt;
  }
  line.time_ns = std::llround(1e9 * time_s);
  const std::string_view word = words.next();
  if (word == "lost") {
    line.seen = false;
    if (read_end(words.next(), words, line)) return line;
    why = "nothing may follow \"lost\" but n= and a number from 0 to 4294967295";
    return std::nullopt;
  }
  if (const char* const wrong = read_pose(word, words, line)) {
    why = wrong;
    return std::nullopt;
  }
  return line;
}

}  // namespace jnd
