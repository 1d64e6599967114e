// Readiness of the stream of poses: what comes, what does not, and what it means for a session.
#include <string>

#include "runner/opening/readiness_items.h"
#include "tests/catch.h"
#include "tests/text_checks.h"

using namespace jnd;

namespace {

TrackerReport bridge() {
  TrackerReport report;
  report.kind = "process";
  report.source = "bridge";
  report.connected = true;
  report.rate_hz = 200;
  return report;
}

// Its tracker is what a test says; every `misses_each`-th look finds something missing.
class TrackedRig final : public Rig {
 public:
  const RigInfo& info() const noexcept override { return info_; }
  Presentation present(const PresentRequest& /*request*/) override { return {}; }
  void neutral() noexcept override {}
  std::string missing() override {
    ++looks;
    if (misses_each > 0 && looks > misses_first && looks % misses_each == 0)
      return "the tracker does not see the thumb";
    return looks <= misses_first ? "no pose of the thumb has come yet" : "";
  }
  RigConnections connections() const override { return {.devices = {}, .tracker = report}; }

  TrackerReport report = bridge();
  int looks = 0, misses_first = 0, misses_each = 0;

 private:
  RigInfo info_;
};

}  // namespace

TEST_CASE("a stream for every finger is ready, even where it begins late") {
  TrackedRig rig;
  rig.misses_first = 20;
  rig.report.latency_p99_ms = 4.25;
  const Check check = check_tracker(rig);
  CHECK(check.what == "tracker");
  CHECK(check.verdict == Verdict::ok);
  CHECK(contains(check.found, "process bridge: 200 poses a second"));
  CHECK(check.what_to_do.empty());
}

TEST_CASE("a stream that never comes, or mostly does not, is bad") {
  TrackedRig never;
  never.misses_first = 1'000'000;
  const Check check = check_tracker(never);
  CHECK(check.verdict == Verdict::bad);
  CHECK(contains(check.found, "no pose of the thumb has come yet"));
  CHECK(contains(check.what_to_do, "hold the fingers"));
  TrackedRig often;
  often.misses_each = 3;
  const Check third = check_tracker(often);
  CHECK(third.verdict == Verdict::bad);
  CHECK(contains(third.found, "does not see the thumb"));
}

TEST_CASE("a stream that fails now and then is a warning") {
  TrackedRig rig;
  rig.misses_each = 15;
  const Check check = check_tracker(rig);
  CHECK(check.verdict == Verdict::warn);
  CHECK(contains(check.found, "now and then"));
}

TEST_CASE("a stream below 50 poses a second is bad") {
  TrackedRig rig;
  rig.report.rate_hz = 49.9;
  const Check check = check_tracker(rig);
  CHECK(check.verdict == Verdict::bad);
  CHECK(contains(check.found, "fewer than 50 poses a second"));
  rig.report.rate_hz = 50;
  CHECK(check_tracker(rig).verdict == Verdict::ok);
}

TEST_CASE("refused lines are a warning, with the first of them") {
  TrackedRig rig;
  rig.report.refused = 3;
  rig.report.trouble = "of bridge this line was refused: \"x\"";
  const Check check = check_tracker(rig);
  CHECK(check.verdict == Verdict::warn);
  CHECK(contains(check.found, "3 lines or reports were refused: of bridge"));
  CHECK(contains(check.what_to_do, "trackers/README.md"));
}
