// The lines of poses: what the format promises is read to the last digit, everything else is refused and crashes
// nothing.
#include "devices/trackers/pose_line.h"

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <rapidcheck.h>

#include "tests/catch.h"

using namespace jnd;

namespace {

const std::vector<std::string> kGoodLines = {
    "index 1 0 0 0 1 0 0 0",     "thumb -2.5 0.01 -0.02 0.03 0.5 0.5 0.5 0.5 0.7",          "little 1e-3 lost",
    "ring 3 0 0 0 -1 0 0 0 n=7", "middle 81234.117250123 0 0 0 0 0 0 1 -0.25 n=4294967295", "index 4 lost n=0"};

double small_number() {
  return *rc::gen::inRange(-1'000'000'000, 1'000'000'001) * 1e-9;
}

// Any pose that is none is refused by both readers or says something sensible.
void read_anything(const std::string& text) {
  const char* why = nullptr;
  if (const auto line = parse_pose_line(text, why)) {
    RC_ASSERT(line->finger >= 0 && line->finger < 5);
    RC_ASSERT(std::abs(line->orientation.norm() - 1) < 1e-12);
    for (int axis = 0; axis < 3; ++axis) RC_ASSERT(std::abs(line->position_m[axis]) <= kFarthestPose_m);
    RC_ASSERT(std::isfinite(line->flexion_rad));
    RC_ASSERT(line->time_ns <= kLongestPoseTime_ns && line->time_ns >= -kLongestPoseTime_ns);
  } else {
    RC_ASSERT(why != nullptr);
  }
  why = nullptr;
  RC_ASSERT(parse_pose_header(text, why) || why != nullptr);
}

}  // namespace

TEST_CASE("the lines of the documentation are read") {
  const char* why = nullptr;
  CHECK(parse_pose_header("jnd-poses 1 units=m clock=monotonic", why) == PoseClock::monotonic);
  CHECK(parse_pose_header("  jnd-poses\t1 clock=source units=m \r", why) == PoseClock::source);
  const auto pose = parse_pose_line("thumb 81234.117250 0.0652 -0.0011 0.0004 0 0.6 0 -0.8 0.31 n=17\r", why);
  REQUIRE(pose);
  CHECK(pose->finger == 0);
  CHECK(pose->time_ns == 81'234'117'250'000);
  CHECK(pose->seen);
  CHECK(pose->position_m == Eigen::Vector3d(0.0652, -0.0011, 0.0004));
  CHECK(pose->orientation.w() == 0);
  CHECK(pose->orientation.x() == Approx(0.6).epsilon(1e-15));
  CHECK(pose->orientation.z() == Approx(-0.8).epsilon(1e-15));
  CHECK(pose->flexion_rad == 0.31);
  CHECK(pose->sequence == 17U);
  const auto lost = parse_pose_line("little -1 lost", why);
  REQUIRE(lost);
  CHECK(lost->finger == 4);
  CHECK(lost->time_ns == -1'000'000'000);
  CHECK_FALSE(lost->seen);
  CHECK_FALSE(lost->sequence);
  for (const std::string& line : kGoodLines) {
    CAPTURE(line);
    CHECK(parse_pose_line(line, why));
  }
  for (const char* const line : {"", "  \t\r", "# a comment", "   # another"}) CHECK(is_blank_or_comment(line));
  CHECK_FALSE(is_blank_or_comment("index 1 lost # no comment here"));
}

TEST_CASE("the lines that the README shows are what it says") {
  std::ifstream readme(JND_SOURCE_DIR "/devices/trackers/README.md");
  int headers = 0, poses = 0, lost = 0;
  for (std::string line; std::getline(readme, line);) {
    if (!line.starts_with("    ")) continue;
    const char* why = "";
    if (parse_pose_header(line, why)) ++headers;
    if (const auto pose = parse_pose_line(line, why)) {
      CHECK(pose->sequence == static_cast<std::uint32_t>(poses + lost));
      ++(pose->seen ? poses : lost);
    }
  }
  CHECK(headers == 1);
  CHECK(poses == 2);
  CHECK(lost == 1);
}

TEST_CASE("what is no pose is refused, and it is said why") {
  const std::vector<std::pair<const char*, const char*>> bad = {
      {"", "thumb"},
      {"Index 1 0 0 0 1 0 0 0", "thumb"},
      {"index", "time"},
      {"index now 0 0 0 1 0 0 0", "time"},
      {"index nan 0 0 0 1 0 0 0", "time"},
      {"index 1e300 0 0 0 1 0 0 0", "time"},
      {"index 5e9 0 0 0 1 0 0 0", "time"},
      {"index 1,5 0 0 0 1 0 0 0", "time"},
      {"index 1 0,1 0 0 1 0 0 0", "seven"},
      {"index 1", "seven"},
      {"index 1 0 0 0 1 0 0", "seven"},
      {"index 1 nan 0 0 1 0 0 0", "seven"},
      {"index 1 0 inf 0 1 0 0 0", "seven"},
      {"index 1 0 0 0 1 0 0 -nan", "seven"},
      {"index 1 0x1 0 0 1 0 0 0", "seven"},
      {"index 1 0.1m 0 0 1 0 0 0", "seven"},
      {"index 1 65 0 0 1 0 0 0", "metres"},
      {"index 1 0 0 -10.1 1 0 0 0", "metres"},
      {"index 1 0 0 0 0 0 0 0", "quaternion"},
      {"index 1 0 0 0 1.02 0 0 0", "quaternion"},
      {"index 1 0 0 0 0.7 0.7 0.7 0", "quaternion"},
      {"index 1 0 0 0 1 0 0 0 bent", "flexion"},
      {"index 1 0 0 0 1 0 0 0 40", "flexion"},
      {"index 1 0 0 0 1 0 0 0 nan", "flexion"},
      {"index 1 0 0 0 1 0 0 0 0.1 7", "n="},
      {"index 1 0 0 0 1 0 0 0 n=", "n="},
      {"index 1 0 0 0 1 0 0 0 n=-1", "n="},
      {"index 1 0 0 0 1 0 0 0 n=4294967296", "n="},
      {"index 1 0 0 0 1 0 0 0 n=1 n=2", "n="},
      {"index 1 lost 0 0 0", "lost"},
      {"index 1 LOST", "seven"},
  };
  for (const auto& [line, reason] : bad) {
    CAPTURE(line);
    const char* why = "";
    CHECK_FALSE(parse_pose_line(line, why));
    CHECK(std::string(why).find(reason) != std::string::npos);
  }
  const char* why = "";
  CHECK_FALSE(parse_pose_line("index 1 lost" + std::string(300, ' '), why));
  CHECK(std::string(why).find("256") != std::string::npos);
}

TEST_CASE("a header says version, units and clock, each once") {
  for (const char* const line :
       {"", "jnd-poses", "jnd-poses 2 units=m clock=source", "jnd-poses 1", "jnd-poses 1 units=m",
        "jnd-poses 1 clock=source", "jnd-poses 1 units=mm clock=source", "jnd-poses 1 units=m clock=utc",
        "jnd-poses 1 units=m units=m clock=source", "jnd-poses 1 units=m clock=source clock=source",
        "jnd-poses 1 units=m clock=source rate=200", "JND-POSES 1 units=m clock=source", "index 1 lost"}) {
    CAPTURE(line);
    const char* why = nullptr;
    CHECK_FALSE(parse_pose_header(line, why));
    REQUIRE(why != nullptr);
    CHECK(std::string(why).find("jnd-poses 1") < 60);
  }
}

TEST_CASE("any pose comes back as it was written") {
  constexpr std::int64_t kLongest_ns = kLongestPoseTime_ns - 1'000'000;  // a double of seconds is no finer there
  REQUIRE(rc::check("round trip", [] {
    Eigen::Quaterniond orientation(small_number(), small_number(), small_number(), small_number());
    RC_PRE(orientation.norm() > 1e-3);
    orientation.normalize();
    const Eigen::Vector3d position = 9.9 * Eigen::Vector3d(small_number(), small_number(), small_number());
    const double time_s = 1e-9 * static_cast<double>(*rc::gen::inRange<std::int64_t>(-kLongest_ns, kLongest_ns));
    const double flexion = 3 * small_number();
    const auto finger = *rc::gen::inRange<std::size_t>(0, 5);
    const auto sequence = *rc::gen::arbitrary<std::uint32_t>();
    const bool with_flexion = *rc::gen::arbitrary<bool>(), with_sequence = *rc::gen::arbitrary<bool>();
    std::string text =
        fmt::format("{} {} {} {} {} {} {} {} {}", kFingerNames[finger], time_s, position.x(), position.y(),
                    position.z(), orientation.w(), orientation.x(), orientation.y(), orientation.z());
    if (with_flexion) text += fmt::format(" {}", flexion);
    if (with_sequence) text += fmt::format(" n={}", sequence);
    const char* why = "";
    const auto line = parse_pose_line(text, why);
    RC_ASSERT(line.has_value());
    RC_ASSERT(line->finger == static_cast<int>(finger));
    RC_ASSERT(line->time_ns == std::llround(1e9 * time_s));
    RC_ASSERT(line->position_m == position);
    RC_ASSERT((line->orientation.coeffs() - orientation.coeffs()).norm() < 1e-14);
    RC_ASSERT(line->flexion_rad == (with_flexion ? flexion : 0));
    RC_ASSERT(line->sequence.has_value() == with_sequence);
    if (with_sequence) RC_ASSERT(*line->sequence == sequence);
  }));
}

TEST_CASE("garbage is refused or read as what it says, and never more") {
  REQUIRE(rc::check("bytes", [] { read_anything(*rc::gen::arbitrary<std::string>()); }));
  REQUIRE(rc::check("damaged lines", [] {
    std::string text = *rc::gen::elementOf(kGoodLines);
    const int changes = *rc::gen::inRange(1, 6);
    for (int i = 0; i < changes && !text.empty(); ++i) {
      const auto at = *rc::gen::inRange<std::size_t>(0, text.size());
      const char letter =
          *rc::gen::oneOf(rc::gen::elementOf(std::string("0123456789.eE+- n=\t#")), rc::gen::arbitrary<char>());
      switch (*rc::gen::inRange(0, 3)) {
        case 0:
          text[at] = letter;
          break;
        case 1:
          text.insert(at, 1, letter);
          break;
        default:
          text.erase(at, 1);
      }
    }
    read_anything(text);
  }));
}

TEST_CASE("lines are cut alike however their bytes come, and too long ones are counted") {
  REQUIRE(rc::check("chunks", [] {
    const auto lengths = *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 400));
    std::string bytes;
    std::vector<std::string> expected;
    int long_ones = 0;
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      const std::string line(static_cast<std::size_t>(lengths[i]), static_cast<char>('a' + i % 26));
      bytes += line + "\n";
      if (line.size() <= kLongestPoseLine)
        expected.push_back(line);
      else
        ++long_ones;
    }
    const std::string tail(*rc::gen::inRange<std::size_t>(0, 300), 'z');
    bytes += tail;
    PoseLineCutter cutter;
    std::vector<std::string> lines;
    int too_long = 0;
    std::string_view rest = bytes;
    while (!rest.empty()) {
      const auto size = *rc::gen::inRange<std::size_t>(1, rest.size() + 1);
      cutter.cut(
          rest.substr(0, size), [&](std::string_view line) { lines.emplace_back(line); }, [&] { ++too_long; });
      rest.remove_prefix(size);
    }
    RC_ASSERT(lines == expected);
    RC_ASSERT(too_long == long_ones);
    RC_ASSERT(cutter.rest() == std::string_view(tail).substr(0, kLongestPoseLine));
  }));
}
