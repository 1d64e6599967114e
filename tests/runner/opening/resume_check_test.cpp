// What an interruption was, and what the protocol asks for after it: whatever the clocks say.
#include "runner/opening/resume_check.h"

#include "devices/clock.h"
#include "devices/machine/boot_id.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

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

}  // namespace

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
