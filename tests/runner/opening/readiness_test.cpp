// Readiness of a session and of its poses.
#include "runner/opening/readiness.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "devices/loop/telemetry_ring.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/task.h"
#include "runner/opening/readiness_items.h"
#include "tests/catch.h"
#include "tests/text_checks.h"

using namespace jnd;

namespace {

// Readiness of a session: every item on its own, and what blocks which kind of session.

namespace fs = std::filesystem;

constexpr std::int64_t kDay_ns = 86'400'000'000'000;
constexpr std::int64_t kToday_ns = 20'500 * kDay_ns + kDay_ns / 2;  // 2026-02-16, at noon

Protocol published() {
  return load_protocol(JND_SOURCE_DIR "/protocols/chinello2017-balanced.json");
}
RigSpec rrs3() {
  return load_rig_spec(JND_SOURCE_DIR "/devices/specs/rrs3.json");
}

// Answers at once, with the fault it is told.
class TestRig final : public Rig {
 public:
  const RigInfo& info() const noexcept override { return info_; }
  Presentation present(const PresentRequest& request) override {
    asked.push_back(request);
    ring.push({});
    Presentation given;
    given.ticks = 250;
    given.fault = fault;
    return given;
  }
  void neutral() noexcept override { ++neutrals; }
  TelemetryRing* telemetry() noexcept override { return keeps_ticks ? &ring : nullptr; }

  Fault fault = Fault::no_contact;
  bool keeps_ticks = false;
  TelemetryRing ring{16};
  std::vector<PresentRequest> asked;
  int neutrals = 0;

 private:
  RigInfo info_;
};

SessionInfo session(const char* participant, int number_in_plan, const char* state, SessionKind kind) {
  SessionInfo info;
  info.id = participant;
  info.participant = participant;
  info.participant_number = number_in_plan;
  info.state = state;
  info.kind = kind;
  info.started = "2026-02-10T10:00:00.000000000Z";
  if (info.state == "closed") info.ended = "2026-02-10T11:00:00.000000000Z";
  return info;
}

Plan plan_of(int participant, int number = 1) {
  Plan plan;
  plan.participant = participant;
  plan.session = number;
  return plan;
}

RigSpec calibrated(double days_ago, std::optional<double> valid_days) {
  RigSpec spec = rrs3();
  spec.devices.front().calibration =
      Calibration{std::chrono::sys_days(std::chrono::days(20'500 - static_cast<int>(days_ago))), valid_days};
  return spec;
}

class StudyFolder {
 public:
  StudyFolder() {
    std::string name = (fs::temp_directory_path() / "jnd-ready-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~StudyFolder() { fs::remove_all(path_); }
  StudyFolder(const StudyFolder&) = delete;
  StudyFolder& operator=(const StudyFolder&) = delete;
  const fs::path& path() const noexcept { return path_; }

 private:
  fs::path path_;
};

const Check& item(const Readiness& readiness, const char* name) {
  const auto found = std::find_if(readiness.items.begin(), readiness.items.end(),
                                  [&](const Check& check) { return check.what == name; });
  REQUIRE(found != readiness.items.end());
  return *found;
}

// A study in a folder of its own, and everything else of a session that is fit.
struct Setup {
  StudyFolder folder;
  Protocol protocol = published();
  RigSpec spec = rrs3();
  TestRig rig;
  std::unique_ptr<Study> study =
      Study::create(folder.path() / "study.sqlite", protocol.name, protocol.bytes, 1, {kToday_ns, 1});
  Plan plan = make_plan(protocol, 1, 1);
  bool fast = true;

  Readiness check(SessionKind kind, fs::path where = {}) {
    return check_readiness({.protocol = protocol,
                            .spec = spec,
                            .plan = plan,
                            .study = *study,
                            .study_path = where.empty() ? folder.path() / "study.sqlite" : where,
                            .participant = "P01",
                            .kind = kind,
                            .rig = rig,
                            .keyboard_is_terminal = true,
                            .fast = fast});
  }
};

TEST_CASE("a calibration holds for as long as the description says") {
  CHECK(check_calibration(rrs3(), kToday_ns).verdict == Verdict::ok);
  CHECK(contains(check_calibration(rrs3(), kToday_ns).found, "states none"));
  CHECK(check_calibration(calibrated(1000, {}), kToday_ns).verdict == Verdict::ok);
  CHECK(check_calibration(calibrated(30, 90), kToday_ns).verdict == Verdict::ok);
  CHECK(check_calibration(calibrated(85, 90), kToday_ns).verdict == Verdict::warn);
  CHECK(check_calibration(calibrated(90, 90), kToday_ns).verdict == Verdict::warn);
  const Check late = check_calibration(calibrated(91, 90), kToday_ns);
  CHECK(late.verdict == Verdict::bad);
  CHECK(contains(late.found, "rrs3: 2025-11-17, 91 days ago, holds 90, out of date"));
  CHECK(contains(late.what_to_do, "calibrate the rrs3"));
  // One that is renewed before every session is not always about to end.
  CHECK(check_calibration(calibrated(0, 1), kToday_ns).verdict == Verdict::ok);
  CHECK(check_calibration(calibrated(-1, 90), kToday_ns).verdict == Verdict::ok);
  const Check ahead = check_calibration(calibrated(-3, 90), kToday_ns);
  CHECK(ahead.verdict == Verdict::bad);
  CHECK(contains(ahead.found, "which is to come"));
}

TEST_CASE("every device of a rig has a calibration of its own") {
  RigSpec spec = load_rig_spec(JND_SOURCE_DIR "/devices/specs/rrs3+mckibben.json");
  spec.devices[1].calibration = Calibration{std::chrono::sys_days(std::chrono::days(20'000)), 100};
  const Check check = check_calibration(spec, kToday_ns);
  CHECK(check.verdict == Verdict::bad);
  CHECK(contains(check.found, "rrs3: its description states none; mckibben: "));
}

TEST_CASE("the plan is the participant's own, balanced, and within the cohort") {
  const Protocol protocol = published();
  const Plan plan = make_plan(protocol, 1, 7);
  CHECK(check_plan_balance(protocol, plan).verdict == Verdict::ok);
  const Check beyond = check_plan_balance(protocol, make_plan(protocol, protocol.design.participants + 1, 7));
  CHECK(beyond.verdict == Verdict::warn);
  CHECK(contains(beyond.found, "more participants than the protocol plans"));

  Plan tampered = plan;
  const auto main =
      std::find_if(tampered.trials.begin(), tampered.trials.end(), [](const Trial& trial) { return !trial.practice; });
  main->target = 1 - main->target;
  const Check unequal = check_plan_balance(protocol, tampered);
  CHECK(unequal.verdict == Verdict::bad);
  CHECK(contains(unequal.found, "1 of 9 cells"));
  // Practice does not count.
  for (Trial& trial : tampered.trials) trial.practice = true;
  CHECK(check_plan_balance(protocol, tampered).verdict == Verdict::ok);

  Protocol random = protocol;
  random.design.sampling = Sampling::random;
  Plan one_sided = plan;
  for (Trial& trial : one_sided.trials) trial.target = kClassSame;
  random.blinded = true;
  CHECK(check_plan_balance(random, one_sided).verdict == Verdict::ok);
  random.blinded = false;
  const Check lopsided = check_plan_balance(random, one_sided);
  CHECK(lopsided.verdict == Verdict::warn);
  CHECK(contains(lopsided.found, "9 of 9 cells have same or different trials only"));

  Protocol five = protocol;
  five.design.participants = 5;
  const Check uneven = check_plan_balance(five, plan);
  CHECK(uneven.verdict == Verdict::warn);
  CHECK(contains(uneven.what_to_do, "plan 6 participants"));
}

TEST_CASE("nothing about the plan tells the operator a condition's name") {
  Protocol protocol = published();
  for (Condition& condition : protocol.conditions) condition.name = condition.label = "secret";
  Plan plan = make_plan(protocol, 1, 7);
  for (Trial& trial : plan.trials) trial.target = kClassSame;
  const Check check = check_plan_balance(protocol, plan);
  CHECK(check.verdict == Verdict::bad);
  CHECK_FALSE(contains(check.found + check.what_to_do, "secret"));
}

TEST_CASE("who has finished, is excluded, or has another's number does not begin") {
  const auto check = [](const std::vector<SessionInfo>& sessions, int number = 1) {
    return check_participant(sessions, "P01", SessionKind::real, plan_of(1, number), 2);
  };
  CHECK(check({}).verdict == Verdict::ok);
  CHECK(check({session("P01", 1, "open", SessionKind::real)}).verdict == Verdict::ok);
  const Check done = check({session("P01", 1, "closed", SessionKind::real)});
  CHECK(done.verdict == Verdict::bad);
  CHECK(contains(done.found, "has finished session 1 of 2"));
  CHECK(contains(done.what_to_do, "next session"));
  // The second of two sessions.
  CHECK(check({session("P01", 1, "closed", SessionKind::real)}, 2).verdict == Verdict::ok);
  // Other kinds have numbers and sessions of their own.
  CHECK(
      check({session("P01", 1, "closed", SessionKind::pilot), session("P02", 1, "open", SessionKind::pilot)}).verdict ==
      Verdict::ok);

  SessionInfo excluded = session("P01", 1, "open", SessionKind::real);
  excluded.excluded = true;
  CHECK(check({excluded}).verdict == Verdict::bad);
  CHECK(contains(check({excluded}).found, "excluded"));

  SessionInfo other = session("P02", 1, "closed", SessionKind::real);
  CHECK(check({other}).verdict == Verdict::bad);
  CHECK(contains(check({other}).found, "number 1 is P02's"));
  other.excluded = other.replaced = true;  // its number is free again
  CHECK(check({other}).verdict == Verdict::ok);

  const Check unfinished = check({session("P03", 3, "open", SessionKind::real)});
  CHECK(unfinished.verdict == Verdict::warn);
  CHECK(contains(unfinished.found, "the session of P03 is not finished"));
}

TEST_CASE("a clock that is far behind, or behind the study, is told") {
  const std::vector<SessionInfo> sessions = {session("P01", 1, "closed", SessionKind::real)};
  CHECK(check_clock({}, kToday_ns).verdict == Verdict::ok);
  CHECK(check_clock(sessions, kToday_ns).verdict == Verdict::ok);
  CHECK(contains(check_clock(sessions, kToday_ns).found, "2026-02-16T12:00:00 UTC"));
  CHECK(check_clock(sessions, kToday_ns - 7 * kDay_ns).verdict == Verdict::warn);
  CHECK(contains(check_clock(sessions, kToday_ns - 7 * kDay_ns).found, "2026-02-10T11:00:00, which is to come"));
  CHECK(check_clock({}, 0).verdict == Verdict::bad);
}

TEST_CASE("telemetry of every tick has room") {
  const Protocol protocol = published();
  Plan plan = make_plan(protocol, 1, 1);
  // 2 fingers at 1 kHz: data/README.md measures 80 kB a second; an estimate that was below it would be of no use.
  const double seconds = 2 * protocol.timeline.explore_s * static_cast<double>(plan.trials.size());
  CHECK(telemetry_bytes(protocol, plan, rrs3()) > 80'000 * seconds);
  CHECK(telemetry_bytes(protocol, plan, rrs3()) < 4 * 80'000 * seconds);
  plan.trials.clear();
  plan.explorations.push_back({.index = 1, .block = 1, .condition = 0, .object = 0, .duration_s = 60});
  CHECK(telemetry_bytes(protocol, plan, rrs3()) > 80'000 * 60);
}

TEST_CASE("the rig itself is tried, without a cue, and leaves no ticks behind") {
  TestRig rig;
  rig.keeps_ticks = true;
  const Check check = check_devices(rrs3(), rig);
  CHECK(check.verdict == Verdict::ok);
  CHECK(contains(check.found, "checks of its description passed"));
  CHECK(contains(check.found, "250 ticks without a fault"));
  REQUIRE(rig.asked.size() == 1);
  CHECK_FALSE(rig.asked[0].stimulus.cues.force);
  CHECK_FALSE(rig.asked[0].stimulus.cues.vibration);
  CHECK_FALSE(rig.asked[0].stimulus.cues.kinaesthetic);
  CHECK(rig.asked[0].no_contact_time_out_s <= 0.5);
  CHECK(rig.neutrals == 1);
  std::vector<TickRecord> left;
  CHECK(rig.ring.drain(left) == 0);
  CHECK(rig.ring.enabled());
}

TEST_CASE("a rig that does not answer, one that is stopped, and one that is not what it says are not used") {
  TestRig rig;
  rig.fault = Fault::device_lost;
  const Check lost = check_devices(rrs3(), rig);
  CHECK(lost.verdict == Verdict::bad);
  CHECK(contains(lost.found, "device_lost"));
  CHECK(contains(lost.what_to_do, "cables"));

  TestRig stopped;
  stopped.stop.latch(StopSource::button);
  CHECK(check_devices(rrs3(), stopped).verdict == Verdict::bad);
  CHECK(stopped.asked.empty());
  CHECK(stopped.stop.latched());  // not ours to clear

  RigSpec wrong = rrs3();
  wrong.devices[0].l1_m *= 1.2;
  TestRig other;
  const Check check = check_devices(wrong, other);
  CHECK(check.verdict == Verdict::bad);
  CHECK(contains(check.what_to_do, "do not use this rig"));
}

TEST_CASE("a keyboard that is no terminal is a warning") {
  CHECK(check_keyboard(true).verdict == Verdict::ok);
  CHECK(check_keyboard(false).verdict == Verdict::warn);
}

TEST_CASE("in a quick rehearsal neither devices nor loop are tried, and it says so") {
  Setup setup;
  const Readiness readiness = setup.check(SessionKind::pilot);
  CHECK_FALSE(readiness.blocked);
  CHECK(setup.rig.asked.empty());
  for (const char* name : {"devices", "loop", "clock"})
    CHECK(item(readiness, name).found == "not tested in a quick rehearsal");
  CHECK(item(readiness, "plan").verdict == Verdict::ok);
  CHECK(item(readiness, "participant").verdict == Verdict::ok);
}

TEST_CASE("what is bad blocks a real session; a pilot one only where data could be lost") {
  Setup setup;
  setup.spec.devices[0].calibration = Calibration{std::chrono::sys_days(std::chrono::days(19'000)), 30};
  const Readiness pilot = setup.check(SessionKind::pilot);
  CHECK(item(pilot, "calibration").verdict == Verdict::bad);
  CHECK_FALSE(pilot.blocked);
  CHECK(contains(readiness_text(pilot), "BAD calibration: rrs3"));
  const Readiness nowhere = setup.check(SessionKind::pilot, setup.folder.path() / "no such folder" / "study.sqlite");
  CHECK(item(nowhere, "study folder").verdict == Verdict::bad);
  CHECK(nowhere.blocked);
  CHECK_FALSE(nowhere.overridable);
  CHECK(contains(readiness_text(nowhere), "No reason sets this aside"));
  const Readiness finished = [&] {
    NewSession session;
    session.id = "one";
    session.participant = "P01";
    session.participant_number = 1;
    session.kind = SessionKind::pilot;
    session.responder = "keyboard";
    session.trials_total = 1;
    session.stamp = {kToday_ns, 2};
    (void)setup.study->open_session(session);
    setup.study->close_session("one", {kToday_ns, 3});
    return setup.check(SessionKind::pilot);
  }();
  CHECK(finished.blocked);
  CHECK_FALSE(finished.overridable);
}

TEST_CASE("a real session is looked at with everything, and what a reason sets aside is logged with it") {
  Setup setup;
  setup.fast = false;
  setup.spec.devices[0].calibration = Calibration{std::chrono::sys_days(std::chrono::days(19'000)), 30};
  const Readiness readiness = setup.check(SessionKind::real);
  CHECK(readiness.blocked);
  CHECK(item(readiness, "calibration").verdict == Verdict::bad);
  CHECK(setup.rig.asked.size() == 1);
  CHECK(contains(item(readiness, "loop").found, "ticks of 1 ms"));
  // Where the folder of the test is memory, the data could be lost, and no reason helps.
  if (item(readiness, "study folder").verdict != Verdict::bad) {
    CHECK(readiness.overridable);
    CHECK_FALSE(contains(readiness_text(readiness), "No reason"));
  }
  const nlohmann::ordered_json body = readiness_body(readiness, "calibrated by hand");
  CHECK(body["items"].size() == readiness.items.size());
  CHECK(body["items"][0]["what"] == "study folder");
  CHECK(body["blocked"] == true);
  CHECK(body["overridden"] == "calibrated by hand");
  CHECK(readiness_body(readiness, "")["overridden"].is_null());
}

TEST_CASE("the text is one line where all is well, and never a command to the terminal") {
  Readiness readiness;
  readiness.items = {{.what = "plan", .verdict = Verdict::ok, .found = "fine"},
                     {.what = "loop", .verdict = Verdict::ok, .found = "fine"}};
  CHECK(readiness_text(readiness) == "Ready: plan, loop.\n");
  // What the devices may do is said in any case.
  readiness.items.push_back({.what = "limits", .verdict = Verdict::ok, .found = "rrs3 at most 4.7 N"});
  CHECK(readiness_text(readiness) == "Ready: plan, loop, limits.\nLimits: rrs3 at most 4.7 N.\n");
  readiness.items.pop_back();
  readiness.items[1] = {.what = "loop", .verdict = Verdict::warn, .found = "\x1b[2Jlate", .what_to_do = "be\x07 quiet"};
  const std::string text = readiness_text(readiness);
  CHECK(contains(text, "late"));
  CHECK_FALSE(contains(text, "\x1b[2J"));
  CHECK_FALSE(contains(text, "\x07"));
}

// Readiness of the stream of poses: what comes, what does not, and what it means for a session.

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

}  // namespace
