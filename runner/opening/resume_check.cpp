#include "runner/opening/resume_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/words.h"
#include "devices/clock.h"
#include "devices/machine/boot_id.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

constexpr double kClockSet_s = 2;  // less is a clock that is being disciplined, not one that was set

double seconds(std::int64_t ns) noexcept {
  return 1e-9 * static_cast<double>(ns);
}

// Within one run of the machine.
void judge_gap_since_same_start(double went_on_s, double suspended_s, double wall_s, ResumeCheck& check) {
  const double most_s = went_on_s + suspended_s;
  check.clock = GapClock::monotonic;
  check.gap_s = went_on_s;
  if (wall_s < went_on_s - kClockSet_s) {
    check.gap_s = most_s;
    check.clock_set_back_s = went_on_s - wall_s;
    check.warning = fmt::format("the wall clock was set back by about {}; the monotonic clock decides",
                                gap_text(check.clock_set_back_s));
  } else if (wall_s > most_s + kClockSet_s) {
    check.gap_s = most_s;
    check.warning = fmt::format("the wall clock was set forward by about {}; the monotonic clock decides",
                                gap_text(wall_s - most_s));
  } else if (suspended_s > kClockSet_s) {
    check.gap_s = std::clamp(wall_s, went_on_s, most_s);
    if (*check.gap_s - went_on_s > kClockSet_s) check.clock = GapClock::wall;
  }
}

// Another run of the machine, or an unknown one: only the wall clock is left.
void judge_gap_by_wall_clock(double wall_s, ResumeCheck& check) {
  if (wall_s >= 0) {
    check.clock = GapClock::wall;
    check.gap_s = wall_s;
    return;
  }
  check.clock_set_back_s = -wall_s;
  check.warning = fmt::format(
      "the wall clock was set back by {} at least (the session's last event is later than now), and the monotonic "
      "clock began anew: how long the interruption was cannot be told, and it counts as longer than any limit; set "
      "the clock before you go on (date, or timedatectl set-ntp true)",
      gap_text(-wall_s));
}

}  // namespace

ResumeMoment resume_moment(bool fast) {
  const SteadyClock clock;
  return {.boot_id = boot_id(),
          .monotonic_ns = clock.now_ns(),
          .since_boot_ns = since_boot_ns(),
          .utc_ns = clock.utc_ns(),
          .fast = fast};
}

std::string_view to_string(GapClock clock) noexcept {
  constexpr auto kWords =
      words<GapClock>({{"monotonic", GapClock::monotonic}, {"wall", GapClock::wall}, {"none", GapClock::none}});
  return word_of(kWords, clock);
}

ResumeCheck check_resume(const SessionState& state, const ResumePolicy& policy, const ResumeMoment& now) {
  ResumeCheck check;
  const bool known = !state.boot_id.empty() && !now.boot_id.empty();
  const bool same_start = known && state.boot_id == now.boot_id;
  if (state.left)
    check.cause = word("left by the operator");
  else if (known && !same_start)
    check.cause = word("the machine was restarted");
  else
    check.cause = word("the program was killed");

  const double wall_s = seconds(now.utc_ns - state.last_utc_ns);
  const double went_on_s = seconds(now.monotonic_ns - state.last_monotonic_ns);
  if (now.fast) {
    check.clock = GapClock::wall;
    check.gap_s = std::max(wall_s, 0.0);
  } else if (same_start && went_on_s >= 0) {
    const double suspended_s = std::max(seconds(now.since_boot_ns - now.monotonic_ns), 0.0);
    judge_gap_since_same_start(went_on_s, suspended_s, wall_s, check);
  } else {
    judge_gap_by_wall_clock(wall_s, check);
  }

  const auto longer_than = [&](const std::optional<double>& limit_s) {
    return limit_s && (!check.gap_s || *check.gap_s > *limit_s);
  };
  check.too_long = longer_than(policy.longest_gap_s);
  check.practice_again = longer_than(policy.practice_after_s);
  check.redo_block = policy.redo_block;
  return check;
}

nlohmann::ordered_json resumed_body(const ResumeCheck& check, const ResumeMoment& now, int trials_done,
                                    const std::string& reason) {
  nlohmann::ordered_json body = {{"cause", check.cause},
                                 {"gap_s", nullptr},
                                 {"gap_clock", to_string(check.clock)},
                                 {"boot_id", now.boot_id},
                                 {"trials_done", trials_done},
                                 {"too_long", check.too_long},
                                 {"practice_again", check.practice_again},
                                 {"redo_block", check.redo_block}};
  if (check.gap_s) body["gap_s"] = *check.gap_s;
  if (check.clock_set_back_s > 0) body["clock_set_back_s"] = check.clock_set_back_s;
  if (!check.warning.empty()) body["warning"] = check.warning;
  if (!reason.empty()) body["reason"] = reason;
  return body;
}

std::string resume_text(const ResumeCheck& check, const ResumePolicy& policy) {
  const std::string_view cause = translated(check.cause);
  std::string text = (check.gap_s ? tr("Interrupted for {} ({}).", gap_text(*check.gap_s), cause)
                                  : tr("Interrupted for an unknown time ({}).", cause)) +
                     "\n";
  if (!check.warning.empty()) text += tr("Warning: {}.", check.warning) + "\n";
  if (check.too_long)
    text += tr("That is longer than the protocol allows ({}).", gap_text(policy.longest_gap_s.value_or(0))) + "\n";
  if (check.practice_again) text += tr("The last practice round comes again first, as the protocol asks.") + "\n";
  if (check.redo_block) text += tr("The interrupted block begins anew, as the protocol asks.") + "\n";
  return text;
}

std::string gap_text(double seconds) {
  struct Unit {
    const char* name;
    std::int64_t length_s;
  };
  constexpr std::array<Unit, 4> kUnits = {{{"day", 86'400}, {"h", 3600}, {"min", 60}, {"s", 1}}};
  constexpr double kMost_s = 1e12;
  const auto whole = static_cast<std::int64_t>(std::llround(std::clamp(seconds, 0.0, kMost_s)));
  // The largest unit that there is one of, and the next smaller one.
  for (std::size_t i = 0; i + 1 < kUnits.size(); ++i) {
    if (whole < kUnits[i].length_s) continue;
    const std::int64_t many = whole / kUnits[i].length_s;
    const std::int64_t rest = whole % kUnits[i].length_s / kUnits[i + 1].length_s;
    std::string text = fmt::format("{} {}{}", many, kUnits[i].name, i == 0 && many > 1 ? "s" : "");
    if (rest > 0) text += fmt::format(" {} {}", rest, kUnits[i + 1].name);
    return text;
  }
  return fmt::format("{} s", whole);
}

}  // namespace jnd
