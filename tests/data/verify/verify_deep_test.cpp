// What hashes cannot find: a program that wrote something else than what it delivered, or left the protocol's course.
#include "data/verify/verify_deep.h"

#include <sys/stat.h>

#include "tests/data/damage_fixture.h"

namespace jnd {
namespace {

std::string deep_problems(const Study& study) {
  std::string all;
  for (const Problem& problem : verify_deep(study).problems) all += problem.text + "\n";
  return all;
}

// One trial of the tutorial, its devices' ticks beside it and what they delivered computed from them by hand.
nlohmann::ordered_json delivered(const Trial& trial, int ticks) {
  TrialRecord record = record_of(tutorial(), trial, usual_answer(trial));
  for (Presentation& presentation : record.presentations) {
    presentation.ticks = ticks;
    presentation.fingers.resize(2);
    for (int channel = 0; channel < 2; ++channel) {
      FingerPresentation& finger = presentation.fingers[static_cast<std::size_t>(channel)];
      finger = {};
      finger.channel = channel == 0 ? Channel::cutaneous : Channel::kinaesthetic;
      double travel = 0, before = 0;
      for (const TickRecord& tick : press(ticks).ticks) {
        if (tick.channel != channel) continue;
        finger.peak_force_n = std::max(finger.peak_force_n, tick.measured_n);
        if (!(tick.penetration > 0)) continue;
        if (finger.contacts == 0) finger.contacts = 1;
        if (before > 0) travel += std::abs(tick.penetration - before);
        before = tick.penetration;
        finger.dwell_s += 0.001;
        finger.deepest_penetration = std::max(finger.deepest_penetration, tick.penetration);
        if (tick.limits != 0) finger.saturated_share += 0.001;
      }
      finger.saturated_share /= finger.dwell_s;
      finger.mean_speed = travel / (finger.dwell_s - 0.001);
    }
  }
  return to_body(record);
}

std::string problems_with(const std::function<void(nlohmann::ordered_json&)>& change) {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  const Trial trial = make_plan(tutorial(), 1, kSeed).trials[0];
  std::vector<TelemetryBlob> blobs = {encode_telemetry(0, press(50)), encode_telemetry(1, press(50))};
  auto body = delivered(trial, 50);
  change(body);
  body["telemetry"] = telemetry_body(blobs);
  log->append(event_kind::kTrialCompleted, body, stamp_of(trial), blobs);
  return deep_problems(*study);
}

TEST_CASE("what the ticks give agrees with the event, or is told", "[data]") {
  CHECK(problems_with([](auto&) {}) == "");
  for (const std::string key : {"peak_force_n", "deepest_penetration_m", "contacts", "dwell_s", "mean_speed_m_per_s",
                                "saturated_share", "fit_samples"}) {
    CAPTURE(key);
    const std::string problems = problems_with([&](auto& body) { body["presentations"][1]["fingers"][0][key] = 17; });
    CHECK_THAT(problems, Catch::Contains("event 2 (trial.completed): interval 2: of the stimulus delivered"));
    CHECK_THAT(problems, Catch::Contains(" 17; its ticks give"));
  }
  CHECK_THAT(problems_with([](auto& body) { body["presentations"][0]["ticks"] = 49; }),
             Catch::Contains("interval 1") && Catch::Contains("ticks 49"));
  CHECK_THAT(problems_with([](auto& body) { body["presentations"][0]["fingers"][0]["channel"] = "kinaesthetic"; }),
             Catch::Contains("of other devices"));
}

// A session of the tutorial up to a trial, with a change on the way.
class Told {
 public:
  Told() : study_(new_study(folder_ / "study.jnd")), log_(study_->open_session(new_session(1))) {}
  void answer(const Trial& trial, int attempt = 1, double time_s = 0.5) {
    TrialRecord record = record_of(tutorial(), trial, usual_answer(trial));
    record.attempt = attempt;
    record.answer.response_time_s = time_s;
    record.duration_s = time_s + 5;
    log_->append(event_kind::kTrialCompleted, to_body(record), stamp_of(trial));
  }
  void append(std::string_view kind, const nlohmann::ordered_json& body) { log_->append(kind, body, kLater); }
  std::string problems() const { return deep_problems(*study_); }
  const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;

 private:
  TemporaryFolder folder_;
  std::unique_ptr<Study> study_;
  std::unique_ptr<SessionLog> log_;
};

TEST_CASE("attempts rise by one, and a trial that is over does not come again", "[data]") {
  Told right;
  right.append(event_kind::kTrialVoided, voided_body(right.trials[0], 1, "no_answer"));
  right.answer(right.trials[0], 2);
  CHECK(right.problems() == "");

  Told skipped;
  skipped.answer(skipped.trials[0], 2);
  CHECK_THAT(skipped.problems(), Catch::Contains("is attempt 2, and the next one is 1"));

  Told again;
  again.answer(again.trials[0]);
  again.append(event_kind::kTrialBegan, {{"index", again.trials[0].index}, {"attempt", 2}});
  CHECK_THAT(again.problems(), Catch::Contains("comes again after it was answered"));

  Told endless;
  const int most = tutorial().timeline.max_attempts;
  for (int attempt = 1; attempt <= most; ++attempt)
    endless.append(event_kind::kTrialVoided, voided_body(endless.trials[0], attempt, "no_answer"));
  endless.answer(endless.trials[0], most + 1);
  CHECK_THAT(endless.problems(), Catch::Contains("attempts were used up"));
}

TEST_CASE("an answer after its time-out, and a block before its turn, are found", "[data]") {
  Told late;
  late.answer(late.trials[0], 1, tutorial().timeline.answer_time_out_s + 1);
  CHECK_THAT(late.problems(), Catch::Contains("the time-out is"));

  Told ahead;
  ahead.answer(ahead.trials.back());
  const std::string problems = ahead.problems();
  CHECK_THAT(problems, Catch::Contains("still has trials") || Catch::Contains("before practice had ended"));

  Told unfinished;
  unfinished.append(event_kind::kSessionClosed, {{"trials_completed", 0}, {"trials_voided", 0}});
  CHECK_THAT(unfinished.problems(), Catch::Contains("still to do"));
}

TEST_CASE("the file's mode and what was left beside it are told", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const auto findings = [&] { return verify_deep(*Study::open(path, Study::Access::read_only)).findings; };
  CHECK(findings().empty());
  ::chmod(path.c_str(), 0644);
  write_bytes(folder / "study.jnd.lock", "1");
  write_bytes(folder / "study.jnd.jnd-draft-abc123", "half");
  CHECK(findings().size() == 3);
  ::chmod(path.c_str(), 0666);
  CHECK_THAT(deep_problems(*Study::open(path, Study::Access::read_only)), Catch::Contains("others may write"));
}

}  // namespace
}  // namespace jnd
