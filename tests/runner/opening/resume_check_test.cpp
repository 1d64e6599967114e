// Names, files and interruptions at a session's opening.
#include "runner/opening/resume_check.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "devices/clock.h"
#include "devices/machine/boot_id.h"
#include "protocols/input/resources.h"
#include "protocols/rigs/rig_description.h"
#include "runner/opening/participant_names.h"
#include "runner/opening/readiness_items.h"
#include "runner/opening/rig_limits.h"
#include "runner/terminal/exit_code.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// What an interruption was, and what the protocol asks for after it: whatever the clocks say.

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kLastUtc = 1'790'000'000 * kSecond, kLastMonotonic = 5000 * kSecond;

SessionState left_behind(const char* boot = "boot a", bool left = false) {
  SessionState state;
  state.opened = true;
  state.left = left;
  state.boot_id = boot;
  state.last_utc_ns = kLastUtc;
  state.last_monotonic_ns = kLastMonotonic;
  return state;
}

// The same run of the machine, some seconds later by the monotonic and by the wall clock.
ResumeMoment later(double monotonic_s, double wall_s, double suspended_s = 0) {
  ResumeMoment now;
  now.boot_id = "boot a";
  now.monotonic_ns = kLastMonotonic + static_cast<std::int64_t>(monotonic_s * 1e9);
  now.since_boot_ns = now.monotonic_ns + static_cast<std::int64_t>(suspended_s * 1e9);
  now.utc_ns = kLastUtc + static_cast<std::int64_t>(wall_s * 1e9);
  return now;
}

ResumeMoment after_restart(double wall_s) {
  ResumeMoment now = later(-4000, wall_s);
  now.boot_id = "boot b";
  return now;
}

ResumePolicy policy(std::optional<double> longest_s, std::optional<double> practice_s = {}, bool redo = false) {
  ResumePolicy policy;
  policy.longest_gap_s = longest_s;
  policy.practice_after_s = practice_s;
  policy.redo_block = redo;
  return policy;
}

TEST_CASE("the cause is what the log and the machine's identity tell") {
  const ResumePolicy any;
  CHECK(check_resume(left_behind("boot a", true), any, later(60, 60)).cause == "left by the operator");
  CHECK(check_resume(left_behind("boot a", true), any, after_restart(60)).cause == "left by the operator");
  CHECK(check_resume(left_behind(), any, later(60, 60)).cause == "the program was killed");
  CHECK(check_resume(left_behind(), any, after_restart(60)).cause == "the machine was restarted");
  CHECK(check_resume(left_behind(""), any, later(60, 60)).cause == "the program was killed");
}

TEST_CASE("within one run of the machine the monotonic clock decides, whatever the wall clock was set to") {
  const ResumePolicy limit = policy(600);
  for (const double wall_s : {300.0, 301.5, 298.5}) {
    const ResumeCheck check = check_resume(left_behind(), limit, later(300, wall_s));
    CHECK(check.clock == GapClock::monotonic);
    CHECK(*check.gap_s == Approx(300));
    CHECK(check.warning.empty());
    CHECK(check.clock_set_back_s == 0);
    CHECK_FALSE(check.too_long);
  }
  const ResumeCheck back = check_resume(left_behind(), limit, later(300, -3300));
  CHECK(*back.gap_s == Approx(300));
  CHECK(back.clock_set_back_s == Approx(3600));
  CHECK(back.warning.find("set back by about 1 h") != std::string::npos);
  CHECK_FALSE(back.too_long);
  // Set back so far that the wall clock alone would call a day a minute.
  const ResumeCheck hidden = check_resume(left_behind(), limit, later(86'400, 60));
  CHECK(*hidden.gap_s == Approx(86'400));
  CHECK(hidden.too_long);
  const ResumeCheck forward = check_resume(left_behind(), limit, later(300, 90'000));
  CHECK(*forward.gap_s == Approx(300));
  CHECK_FALSE(forward.too_long);
  CHECK(forward.clock_set_back_s == 0);
  CHECK(forward.warning.find("set forward") != std::string::npos);
}

TEST_CASE("a night of a suspended machine is a gap, though the monotonic clock stood still") {
  const ResumePolicy limit = policy(600);
  const double night = 8 * 3600;
  const ResumeCheck check = check_resume(left_behind(), limit, later(120, night + 120, night));
  CHECK(*check.gap_s == Approx(night + 120));
  CHECK(check.clock == GapClock::wall);
  CHECK(check.warning.empty());
  CHECK(check.too_long);
  // Suspended before the session: the wall clock tells that it was not in this gap.
  const ResumeCheck before = check_resume(left_behind(), limit, later(120, 120, night));
  CHECK(*before.gap_s == Approx(120));
  CHECK(before.clock == GapClock::monotonic);
  CHECK_FALSE(before.too_long);
  // With a wall clock that was set as well, the longest that it can have been.
  const ResumeCheck set = check_resume(left_behind(), limit, later(120, -500, night));
  CHECK(*set.gap_s == Approx(night + 120));
  CHECK(set.clock == GapClock::monotonic);
  CHECK(set.clock_set_back_s == Approx(620));
  CHECK(set.too_long);
}

TEST_CASE("after a restart the wall clock tells, and where it was set back nobody does") {
  const ResumePolicy limits = policy(600, 60);
  const ResumeCheck check = check_resume(left_behind(), limits, after_restart(500));
  CHECK(check.clock == GapClock::wall);
  CHECK(*check.gap_s == Approx(500));
  CHECK_FALSE(check.too_long);
  CHECK(check.practice_again);
  const ResumeCheck back = check_resume(left_behind(), limits, after_restart(-30));
  CHECK(back.clock == GapClock::none);
  CHECK_FALSE(back.gap_s.has_value());
  CHECK(back.clock_set_back_s == Approx(30));
  CHECK(back.too_long);
  CHECK(back.practice_again);
  CHECK(back.warning.find("longer than any limit") != std::string::npos);
  // Without limits nothing is too long.
  CHECK_FALSE(check_resume(left_behind(), {}, after_restart(-30)).too_long);
  CHECK_FALSE(check_resume(left_behind(), {}, after_restart(-30)).practice_again);
}

TEST_CASE("a log that does not know its run of the machine is measured by the wall clock") {
  for (const char* boot : {"", "boot a"}) {
    ResumeMoment now = later(100, 200);
    if (*boot != '\0') now.boot_id.clear();
    const ResumeCheck check = check_resume(left_behind(boot), policy(150), now);
    CHECK(check.clock == GapClock::wall);
    CHECK(*check.gap_s == Approx(200));
    CHECK(check.too_long);
  }
}

TEST_CASE("a monotonic clock that went back is another one, and does not decide") {
  const ResumeCheck check = check_resume(left_behind(), policy(600), later(-10, 100));
  CHECK(check.clock == GapClock::wall);
  CHECK(*check.gap_s == Approx(100));
}

TEST_CASE("limits are what the protocol allows, inclusive") {
  CHECK_FALSE(check_resume(left_behind(), policy(300), later(300, 300)).too_long);
  CHECK(check_resume(left_behind(), policy(300), later(301, 301)).too_long);
  CHECK_FALSE(check_resume(left_behind(), policy({}, 300), later(300, 300)).practice_again);
  CHECK(check_resume(left_behind(), policy({}, 300), later(301, 301)).practice_again);
  CHECK(check_resume(left_behind(), policy({}, {}, true), later(1, 1)).redo_block);
  CHECK_FALSE(check_resume(left_behind(), policy({}), later(1, 1)).redo_block);
}

TEST_CASE("in a quick rehearsal, whose log is ahead of the clocks, no clock is blamed") {
  ResumeMoment now = later(-1000, -1000);
  now.fast = true;
  const ResumeCheck check = check_resume(left_behind(), policy(600), now);
  CHECK(*check.gap_s == 0);
  CHECK(check.warning.empty());
  CHECK_FALSE(check.too_long);
}

TEST_CASE("the body and the text say all of it") {
  ResumeCheck check = check_resume(left_behind(), policy(600, 60, true), after_restart(-30));
  const auto body = resumed_body(check, after_restart(-30), 12, "clock battery");
  CHECK(body["cause"] == "the machine was restarted");
  CHECK(body["gap_s"].is_null());
  CHECK(body["gap_clock"] == "none");
  CHECK(body["boot_id"] == "boot b");
  CHECK(body["trials_done"] == 12);
  CHECK(body["clock_set_back_s"] == Approx(30));
  CHECK(body["reason"] == "clock battery");
  CHECK(body["too_long"] == true);
  const std::string text = resume_text(check, policy(600, 60, true));
  for (const char* part : {"for an unknown time", "Warning: the wall clock", "longer than the protocol allows (10 min)",
                           "practice round comes again", "block begins anew"})
    CHECK(text.find(part) != std::string::npos);
  check = check_resume(left_behind("boot a", true), {}, later(75, 75));
  CHECK(resume_text(check, {}) == "Interrupted for 1 min 15 s (left by the operator).\n");
  CHECK(resumed_body(check, later(75, 75), 3, "")["gap_s"] == Approx(75));
  CHECK_FALSE(resumed_body(check, later(75, 75), 3, "").contains("reason"));
}

TEST_CASE("gaps are told in the two units that matter") {
  CHECK(gap_text(0.2) == "0 s");
  CHECK(gap_text(-5) == "0 s");
  CHECK(gap_text(59.4) == "59 s");
  CHECK(gap_text(59.6) == "1 min");
  CHECK(gap_text(200) == "3 min 20 s");
  CHECK(gap_text(7500) == "2 h 5 min");
  CHECK(gap_text(86'400) == "1 day");
  CHECK(gap_text(97'200) == "1 day 3 h");
  CHECK(gap_text(2 * 86'400.0) == "2 days");
  CHECK(gap_text(1e300) == gap_text(1e12));
}

TEST_CASE("the moment is this machine's") {
  const ResumeMoment now = resume_moment(true);
  CHECK(now.fast);
  CHECK(now.boot_id == boot_id());
  CHECK(now.monotonic_ns <= SteadyClock().now_ns());
  CHECK(now.since_boot_ns <= since_boot_ns());
  // Suspended time is never negative; the two clocks were read one after the other.
  CHECK(now.since_boot_ns >= now.monotonic_ns);
}

// Which file a name means: a shipped one by its name, the user's own by a path.

namespace fs = std::filesystem;

// The working folder for as long as it lives, with files of the given names in it.
class WorkingFolder {
 public:
  WorkingFolder() : before_(fs::current_path()) {
    std::string name = (fs::temp_directory_path() / "jnd-names-XXXXXX").string();
    path_ = mkdtemp(name.data());
    fs::current_path(path_);
  }
  ~WorkingFolder() {
    fs::current_path(before_);
    fs::remove_all(path_);
  }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;
  static void put(const char* name, const std::string& text) { std::ofstream(name) << text; }

 private:
  fs::path before_, path_;
};

std::string shipped_rrs3() {
  std::ifstream file(JND_SOURCE_DIR "/devices/specs/rrs3.json");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string refusal(Resource resource, const std::string& name) {
  try {
    find_resource(resource, name);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("a file in the working folder never takes the place of a shipped one") {
  const WorkingFolder folder;
  WorkingFolder::put("rrs3", "{}");
  WorkingFolder::put("rrs3.json", "{}");
  WorkingFolder::put("mine", "{}");
  for (const Resource resource : {Resource::protocol, Resource::profile, Resource::device_spec, Resource::object})
    for (const std::string& name : shipped_names(resource)) {
      WorkingFolder::put(name.c_str(), "{}");
      CHECK(find_resource(resource, name).is_absolute());
    }
  CHECK(find_resource(Resource::device_spec, "rrs3.json") == "rrs3.json");
  CHECK(find_resource(Resource::device_spec, "./rrs3") == "./rrs3");
  CHECK_THAT(refusal(Resource::device_spec, "mine"),
             Catch::Contains("no device called 'mine' is shipped") && Catch::Contains("write ./mine"));
  CHECK_THAT(refusal(Resource::protocol, "tutorial.json"),
             Catch::Contains("there is no protocol file 'tutorial.json'") && Catch::Contains("tutorial"));
}

TEST_CASE("a description that is not the shipped one to the byte is called so, wherever it lies") {
  const WorkingFolder folder;
  WorkingFolder::put("same.json", shipped_rrs3());
  const RigSpec same = load_rig_spec("same.json");
  CHECK(is_shipped(same));
  CHECK(check_description(same).verdict == Verdict::ok);
  CHECK(check_description(same).found == "rrs3 at most 4.7 N, 2000 N/m");
  CHECK(is_shipped(load_rig_spec(JND_SOURCE_DIR "/devices/specs/rrs3+mckibben.json")));

  std::string weaker = shipped_rrs3();
  weaker.replace(weaker.find("4.7"), 3, "3.0");
  WorkingFolder::put("other.json", weaker);
  const Check other = check_description(load_rig_spec("other.json"));
  CHECK(other.verdict == Verdict::warn);
  CHECK(other.found == "rrs3 at most 3 N, 2000 N/m; not the shipped rrs3");
  CHECK_FALSE(other.what_to_do.empty());
  weaker.replace(weaker.find("\"name\": \"rrs3\""), 14, "\"name\": \"mine\"");
  WorkingFolder::put("mine.json", weaker);
  CHECK(not_shipped_text(load_rig_spec("mine.json")) == "not a shipped device");
}

// Codes of people and numbers of the plan, where a command line may give either.

SessionInfo session(const std::string& code, int number, bool replaced = false) {
  SessionInfo info;
  info.participant = code;
  info.participant_number = number;
  info.replaced = replaced;
  return info;
}

TEST_CASE("a person is meant by the code, or by the number that jnd writes as a code") {
  const std::vector<SessionInfo> study = {session("P01", 1), session("12", 2), session("4711", 3)};
  CHECK(participant_meant("P01", study) == "P01");
  CHECK(participant_meant("1", study) == "P01");
  CHECK(participant_meant("01", study) == "P01");
  CHECK(participant_meant("12", study) == "12");  // somebody is called so
  CHECK(participant_meant("13", study) == "P13");
  CHECK(participant_meant("4711", study) == "4711");
  CHECK(participant_meant("4712", study) == "4712");  // a laboratory's own codes
  CHECK(participant_meant("0", study) == "0");
  CHECK(participant_meant("AB7", study) == "AB7");
  CHECK(participant_meant("7", {}) == "P07");
}

TEST_CASE("a place in the plan is meant by its number, or by who has it") {
  const std::vector<SessionInfo> study = {session("P07", 1), session("P02", 2), session("8", 3), session("9", 9)};
  CHECK(plan_number_meant("7", {}) == 7);
  CHECK(plan_number_meant("P07", {}) == 7);
  CHECK(plan_number_meant("P07", study) == 1);
  CHECK(plan_number_meant("7", study) == 7);
  CHECK(plan_number_meant("9", study) == 9);
  CHECK_THROWS_AS(plan_number_meant("8", study), UsageError);    // the code of number 3
  CHECK_THROWS_AS(plan_number_meant("P05", study), UsageError);  // has no place yet
  for (const char* wrong : {"0", "-1", "100001", "many", "P", "P0", "", "7x"})
    CHECK_THROWS_AS(plan_number_meant(wrong, {}), UsageError);
  const std::vector<SessionInfo> twice = {session("P01", 1), session("P01", 4)};
  CHECK_THROWS_AS(plan_number_meant("P01", twice), UsageError);
}

TEST_CASE("a plan's heading says the code, and of a study who has the place") {
  CHECK(participant_title(7, nullptr) == "participant P07");
  const std::vector<SessionInfo> study = {session("P07", 1, true), session("Q1", 1)};
  CHECK(participant_title(1, &study) == "participant Q1, number 1 of the plan");
  CHECK(participant_title(5, &study) == "number 5 of the plan, which nobody has yet");
}

}  // namespace
}  // namespace jnd
