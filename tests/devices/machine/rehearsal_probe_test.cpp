// A rehearsal in real time, judged by what it lost: on made-up rigs, so that no test waits for a machine to be late.
#include <vector>

#include "devices/machine/machine_checks.h"
#include "devices/rigs/rig_factory.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

constexpr double kTrial_s = 6;

// Presentations that end as they are told to, in no time.
class ScriptedRig final : public Rig {
 public:
  explicit ScriptedRig(std::vector<Presentation> given) : given_(std::move(given)) {}
  const RigInfo& info() const noexcept override { return info_; }
  Presentation present(const PresentRequest& request) override {
    asked.push_back(request);
    return given_[std::min(asked.size(), given_.size()) - 1];
  }
  void neutral() noexcept override { rested = true; }

  std::vector<PresentRequest> asked;
  bool rested = false;

 private:
  RigInfo info_;
  std::vector<Presentation> given_;
};

Presentation presentation(Fault fault, double largest_us = 90) {
  Presentation given;
  given.fault = fault;
  given.duration_s = 1.25;
  given.ticks = 1200;
  given.overruns = 2;
  given.lateness_p99_us = 20;
  given.lateness_max_us = largest_us;
  return given;
}

RehearsalReport report_of(int presentations, int gaps, double largest_us = 90, std::int64_t overruns = 0) {
  RehearsalReport report;
  report.presentations = presentations;
  report.gaps = gaps;
  report.presented_s = 1.25 * presentations;
  report.ticks = 1200 * presentations;
  report.overruns = overruns;
  report.p99_us = 20;
  report.largest_us = largest_us;
  return report;
}

}  // namespace

TEST_CASE("a rehearsal is fit where it keeps its trials, by the limits of every loop") {
  const Check fine = judge_rehearsal(report_of(3, 0), kTrial_s);
  CHECK(fine.verdict == Verdict::ok);
  CHECK(
      fine.found ==
      "0 of 3 presentations lost to a gap between commands, in real time on a simulated rig; p99 20 us, largest 90 us "
      "over 3600 ticks of 1 ms, 0 skipped (0 %)");
  CHECK(fine.what_to_do.empty());
  const Check lost = judge_rehearsal(report_of(3, 1), kTrial_s);
  CHECK(lost.verdict == Verdict::bad);
  CHECK(lost.found.starts_with("1 of 3 presentations lost"));
  CHECK_FALSE(lost.what_to_do.empty());
  CHECK(judge_rehearsal(report_of(1, 0), kTrial_s).found.starts_with("0 of 1 presentation lost"));
  // The same figures get the same verdict as those of the loop alone.
  for (const double largest_us : {90.0, 900.0, 1100.0, 9400.0, 9600.0, 25'000.0}) {
    const RehearsalReport report = report_of(3, 0, largest_us, largest_us >= 1000 ? 1 : 0);
    CHECK(judge_rehearsal(report, kTrial_s).verdict == judge_loop({.what = "",
                                                                   .fifo = false,
                                                                   .p99_us = report.p99_us,
                                                                   .largest_us = report.largest_us,
                                                                   .ticks = report.ticks,
                                                                   .overruns = report.overruns})
                                                           .verdict);
  }
  CHECK(judge_rehearsal(RehearsalReport{}, kTrial_s).verdict == Verdict::warn);
  CHECK(judge_rehearsal(RehearsalReport{}, kTrial_s).found == "not measured");
  RehearsalReport broken = report_of(1, 0);
  broken.fault = "stale_pose";
  CHECK(judge_rehearsal(broken, kTrial_s).verdict == Verdict::bad);
  CHECK(judge_rehearsal(broken, kTrial_s).found.ends_with("ended by stale_pose"));
}

TEST_CASE("a rehearsal says how many trials of usual length would have been lost") {
  // A gap in 4 presentations of 1.25 s, trials that present for 6 s: 1 - exp(-6/5) = 0.6988.
  CHECK(lost_trials(report_of(4, 1), 6).value() == Approx(0.698805788));
  CHECK(lost_trials(report_of(4, 1), 0.001).value() == Approx(0.00019998));
  CHECK(lost_trials(report_of(4, 4), 600).value() == Approx(1));
  CHECK(lost_trials(report_of(4, 0), 6).value() == 0);
  CHECK_FALSE(lost_trials(RehearsalReport{}, 6));
  CHECK(judge_rehearsal(report_of(4, 1), 6)
            .found.starts_with("1 of 4 presentations lost to a gap between commands (at this rate some 70 of 100 "
                               "trials, which present for 6 s each), in real time"));
  CHECK_FALSE(contains(judge_rehearsal(report_of(4, 0), 6).found, "trials"));
}

TEST_CASE("a rehearsal counts what was lost, and presents at least once") {
  const std::atomic<bool> go_on{false}, stop{true};
  ScriptedRig once({presentation(Fault::command_gap, 25'000)});
  const RehearsalReport lost = probe_rehearsal(once, {.stiffness = 700, .cues = {}}, 1e-9, go_on);
  CHECK(lost.presentations == 1);
  CHECK(lost.gaps == 1);
  CHECK(lost.largest_us == 25'000);
  CHECK(lost.presented_s == 1.25);
  CHECK(lost.ticks == 1200);
  CHECK(lost.overruns == 2);
  CHECK(once.asked.front().stimulus.stiffness == 700);
  CHECK(once.rested);

  // Gaps are counted and it goes on; anything else ends it.
  ScriptedRig several({presentation(Fault::none), presentation(Fault::command_gap), presentation(Fault::stale_pose)});
  const RehearsalReport all = probe_rehearsal(several, {.stiffness = 700, .cues = {}}, 60, go_on);
  CHECK(all.presentations == 3);
  CHECK(all.gaps == 1);
  CHECK(all.fault == "stale_pose");

  ScriptedRig stopped({presentation(Fault::emergency_stop)});
  CHECK(probe_rehearsal(stopped, {.stiffness = 700, .cues = {}}, 60, stop).presentations == 0);

  // The program's own rig keeps what it presents where its loop is never late.
  SimulatedClock clock(0);
  const auto rig = make_simulated_rig(small_protocol(), rrs3_rig(), shipped_profile("chinello2017"), 1, 1, clock);
  const RehearsalReport kept = probe_rehearsal(*rig, {.stiffness = 500, .cues = kForce}, 1e-9, go_on);
  CHECK(kept.presentations == 1);
  CHECK(kept.gaps == 0);
  CHECK(kept.fault.empty());
  CHECK(kept.ticks > 500);
  CHECK(judge_rehearsal(kept, kTrial_s).verdict == Verdict::ok);
}
