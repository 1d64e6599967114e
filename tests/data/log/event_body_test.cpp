// Records survive the log exactly, and a replay says where a session goes on.
#include "data/log/event_body.h"

#include <rapidcheck.h>

#include "data/log/body_numbers.h"
#include "data/log/replay.h"
#include "data/log/storage_error.h"
#include "data/log/trial_body.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

bool equal(const FingerPresentation& a, const FingerPresentation& b) {
  return a.finger == b.finger && a.channel == b.channel && a.stiffness == b.stiffness &&
         a.stiffness_se == b.stiffness_se && a.joint_stiffness_n_m_per_rad == b.joint_stiffness_n_m_per_rad &&
         a.interventions == b.interventions && a.fit_samples == b.fit_samples && a.peak_force_n == b.peak_force_n &&
         a.deepest_penetration == b.deepest_penetration && a.work_j == b.work_j && a.mean_speed == b.mean_speed &&
         a.contacts == b.contacts && a.dwell_s == b.dwell_s && a.saturated_share == b.saturated_share &&
         a.vibration_g == b.vibration_g && a.vibration_clamped == b.vibration_clamped;
}

bool equal(const Presentation& a, const Presentation& b) {
  if (a.fingers.size() != b.fingers.size()) return false;
  for (std::size_t i = 0; i < a.fingers.size(); ++i)
    if (!equal(a.fingers[i], b.fingers[i])) return false;
  return a.first_contact_s == b.first_contact_s && a.duration_s == b.duration_s && a.ticks == b.ticks &&
         a.overruns == b.overruns && a.lateness_p50_us == b.lateness_p50_us && a.lateness_p99_us == b.lateness_p99_us &&
         a.lateness_max_us == b.lateness_max_us && a.lateness_histogram == b.lateness_histogram && a.fault == b.fault &&
         a.stopped_by == b.stopped_by;
}

bool equal(const TrialRecord& a, const TrialRecord& b) {
  return a.trial == b.trial && a.attempt == b.attempt && a.condition_name == b.condition_name &&
         a.series_name == b.series_name && a.answer.said == b.answer.said &&
         a.answer.entered_by == b.answer.entered_by && a.answer.response_time_s == b.answer.response_time_s &&
         equal(a.presentations[0], b.presentations[0]) && equal(a.presentations[1], b.presentations[1]) &&
         a.duration_s == b.duration_s;
}

// Any finite double, from its bits: tiny, huge and subnormal ones among them.
double any_double() {
  const double value = *rc::gen::arbitrary<double>();
  return std::isfinite(value) ? value : 0.1;
}

FingerPresentation any_finger() {
  FingerPresentation finger;
  finger.finger = *rc::gen::arbitrary<int>();
  finger.channel = *rc::gen::element(Channel::cutaneous, Channel::kinaesthetic);
  if (*rc::gen::arbitrary<bool>()) finger.stiffness_se = any_double();
  if (*rc::gen::arbitrary<bool>()) finger.joint_stiffness_n_m_per_rad = any_double();
  for (int i = *rc::gen::inRange(0, 3); i > 0; --i)
    finger.interventions.push_back({"force_cap", *rc::gen::arbitrary<std::int64_t>(), any_double(), any_double()});
  if (*rc::gen::arbitrary<bool>()) finger.stiffness = any_double();
  finger.fit_samples = *rc::gen::arbitrary<std::int64_t>();
  finger.peak_force_n = any_double();
  finger.deepest_penetration = any_double();
  finger.work_j = any_double();
  finger.mean_speed = any_double();
  finger.contacts = *rc::gen::arbitrary<int>();
  finger.dwell_s = any_double();
  finger.saturated_share = any_double();
  finger.vibration_g = any_double();
  finger.vibration_clamped = *rc::gen::arbitrary<bool>();
  return finger;
}

Presentation any_presentation() {
  Presentation presentation;
  for (int i = *rc::gen::inRange(0, 3); i > 0; --i) presentation.fingers.push_back(any_finger());
  if (*rc::gen::arbitrary<bool>()) presentation.first_contact_s = std::abs(any_double());
  presentation.duration_s = any_double();
  presentation.ticks = *rc::gen::arbitrary<std::int64_t>();
  presentation.overruns = *rc::gen::arbitrary<std::int64_t>();
  presentation.lateness_p50_us = any_double();
  presentation.lateness_p99_us = any_double();
  if (*rc::gen::arbitrary<bool>()) {  // a real clock: some tick was late
    presentation.lateness_max_us = std::abs(any_double()) + 1e-3;
    for (std::int64_t& ticks : presentation.lateness_histogram) ticks = *rc::gen::arbitrary<std::int64_t>();
  }
  presentation.stopped_by = *rc::gen::element<std::string>("", "key", "button");
  presentation.fault =
      *rc::gen::element(Fault::none, Fault::no_contact, Fault::stale_pose, Fault::command_gap, Fault::non_finite,
                        Fault::device_lost, Fault::device_fault, Fault::emergency_stop, Fault::interrupted);
  return presentation;
}

TEST_CASE("any trial record comes back from its stored text, every double to the bit", "[data]") {
  REQUIRE(rc::check([] {
    TrialRecord record;
    record.trial.index = *rc::gen::arbitrary<int>();
    record.trial.block = *rc::gen::arbitrary<int>();
    record.trial.practice = *rc::gen::arbitrary<bool>();
    record.trial.round = *rc::gen::arbitrary<int>();
    record.trial.series = *rc::gen::arbitrary<int>();
    record.trial.condition = *rc::gen::arbitrary<int>();
    record.trial.stimuli = {any_double(), any_double()};
    record.trial.unit = *rc::gen::element(Unit::n_per_m, Unit::n_per_rad);
    record.trial.target = *rc::gen::element(-1, kClassSame, kClassDifferent);
    record.attempt = *rc::gen::arbitrary<int>();
    record.condition_name = *rc::gen::string<std::string>();
    for (char& c : record.condition_name) c = static_cast<char>(c & 0x7F);  // names are UTF-8
    record.series_name = "\"500, 900\"\n\xC3\xA9";
    record.answer.said = *rc::gen::element(kClassSame, kClassDifferent);
    record.answer.entered_by = *rc::gen::element(EnteredBy::participant, EnteredBy::operator_);
    record.answer.response_time_s = any_double();
    record.duration_s = any_double();
    record.presentations = {any_presentation(), any_presentation()};
    const std::string text = body_text(to_body(record));
    RC_ASSERT(equal(trial_record_from(nlohmann::ordered_json::parse(text)), record));
    const std::string_view other = name_suffix(record.trial.unit == Unit::n_per_m ? Unit::n_per_rad : Unit::n_per_m);
    RC_ASSERT(text.find("stiffness_" + std::string(other) + "\"") == std::string::npos);
  }));
}

TEST_CASE("a value that could not be computed is null in the log and NaN again when read", "[data]") {
  TrialRecord record = record_of(tutorial(), make_plan(tutorial(), 1, kSeed).trials.front(), kClassSame);
  record.presentations[0].fingers[0].work_j = std::nan("");
  const std::string text = body_text(to_body(record));
  CHECK(text.find("\"work_j\":null") != std::string::npos);
  CHECK(std::isnan(trial_record_from(nlohmann::ordered_json::parse(text)).presentations[0].fingers[0].work_j));
}

TEST_CASE("names keep their unit", "[data]") {
  TrialRecord record = record_of(tutorial(), make_plan(tutorial(), 1, kSeed).trials.front(), kClassSame);
  const auto has = [](const nlohmann::ordered_json& body, const std::vector<std::string>& keys) {
    for (const std::string& key : keys)
      if (!body.contains(key)) return false;
    return true;
  };
  auto body = to_body(record);
  CHECK(has(body, {"stimulus_1_n_per_m", "stimulus_2_n_per_m"}));
  CHECK(has(body["presentations"][0]["fingers"][1],
            {"stiffness_n_per_m", "stiffness_se_n_per_m", "deepest_penetration_m", "mean_speed_m_per_s"}));
  record.trial.unit = Unit::n_per_rad;
  body = to_body(record);
  CHECK(has(body, {"stimulus_1_n_per_rad", "stimulus_2_n_per_rad"}));
  CHECK(has(body["presentations"][0]["fingers"][1],
            {"stiffness_n_per_rad", "stiffness_se_n_per_rad", "deepest_penetration_rad", "mean_speed_rad_per_s"}));
  CHECK(voided_body(record.trial, 1, "no_answer")["unit"] == "N/rad");
  CHECK(trial_from(voided_body(record.trial, 1, "no_answer")) == record.trial);
}

TEST_CASE("what did not happen takes no room in a body", "[data]") {
  const TrialRecord record = record_of(tutorial(), make_plan(tutorial(), 1, kSeed).trials.front(), kClassSame);
  const std::string text = body_text(to_body(record));
  for (const char* key : {"interventions", "stopped_by", "lateness_histogram", "joint_stiffness", "telemetry"})
    CHECK(text.find(key) == std::string::npos);
  CHECK(text.size() < 2400);  // simulations write thousands of them: two fingers, two intervals
}

TEST_CASE("the last ticks before a stop are a table with named columns, in device.fault and nowhere else", "[data]") {
  TrialRecord record = record_of(tutorial(), make_plan(tutorial(), 1, kSeed).trials.front(), kClassSame);
  Presentation& presentation = record.presentations[0];
  presentation.fault = Fault::emergency_stop;
  presentation.stopped_by = "button";
  presentation.fingers[1].finger = 0;
  presentation.fingers[1].channel = Channel::kinaesthetic;
  TickRecord tick;
  tick.time_ns = 9'007'199'254'740'993;  // more than a double holds
  tick.lateness_ns = 12;
  tick.limits = 0x80000001;
  tick.penetration = 0.1;
  tick.asked_n = 5;
  tick.given_n = 4.7;
  tick.measured_n = std::nan("");
  tick.vibration_g = 0.5;
  tick.travel = 0.04;
  tick.finger_m = {1, 2, 3};
  presentation.last_ticks = {tick, tick};
  presentation.last_ticks[1].channel = 1;
  CHECK(body_text(to_body(record)).find("9007199254740993") == std::string::npos);

  const auto body = nlohmann::ordered_json::parse(body_text(device_fault_body(record.trial, 2, 1, presentation)));
  CHECK(body.at("index") == record.trial.index);
  CHECK(body.at("attempt") == 2);
  CHECK(body.at("interval") == 1);
  CHECK(body.at("cause") == "emergency_stop");
  CHECK(body.at("stopped_by") == "button");
  CHECK(body.at("channels")[1] == nlohmann::ordered_json{{"finger", 0}, {"channel", "kinaesthetic"}});
  CHECK(body.at("ticks").at("columns").dump() ==
        R"(["time_ns","lateness_ns","channel","limits","penetration_m","asked_n","given_n","measured_n","vibration_g",)"
        R"("travel_m","travel_rad","finger_x_m","finger_y_m","finger_z_m"])");
  CHECK(body.at("ticks").at("rows").dump() ==
        "[[9007199254740993,12,0,2147483649,0.1,5.0,4.7,null,0.5,0.04,null,1.0,2.0,3.0],"
        "[9007199254740993,12,1,2147483649,0.1,5.0,4.7,null,0.5,null,0.04,1.0,2.0,3.0]]");

  presentation.fingers.resize(1);
  presentation.last_ticks.resize(1);
  presentation.stopped_by.clear();
  presentation.fault = Fault::command_gap;
  record.trial.unit = Unit::n_per_rad;
  const auto other = device_fault_body(record.trial, 1, 0, presentation);
  CHECK(other.at("stopped_by").is_null());
  CHECK(other.at("cause") == "command_gap");
  CHECK(other.at("ticks").at("columns")[4] == "penetration_rad");
  CHECK(other.at("ticks").at("columns").size() == 13);  // no joint, no angle
  CHECK(other.at("ticks").at("rows")[0].size() == 13);
}

TEST_CASE("text that is not UTF-8 is stored in its readable part, not refused", "[data]") {
  const std::string text = body_text(question_body("comment", "after_session", "", "caf\xE9!", 0));
  CHECK(text.find("caf\xEF\xBF\xBD!") != std::string::npos);
}

TEST_CASE("a body that is not a trial is refused with the reason", "[data]") {
  const auto good = to_body(record_of(tutorial(), make_plan(tutorial(), 1, kSeed).trials.front(), kClassSame));
  for (const char* key : {"index", "stimulus_1_n_per_m", "answer", "presentations", "entered_by"}) {
    auto body = good;
    body.erase(key);
    CHECK_THROWS_AS(trial_record_from(body), StorageError);
  }
  auto body = good;
  body["said"] = "maybe";
  CHECK_THROWS_WITH(trial_record_from(body), Catch::Contains("not a completed trial"));
  body = good;
  body["task"] = "maybe";
  CHECK_THROWS_WITH(trial_record_from(body), Catch::Contains("maybe"));
  body = good;
  body["same"] = !body["same"].get<bool>();
  CHECK_THROWS_WITH(trial_record_from(body), Catch::Contains("contradict"));
  body = good;
  body["presentations"][0]["fingers"][0]["channel"] = "visual";
  CHECK_THROWS_WITH(trial_record_from(body), Catch::Contains("visual"));
  body = good;
  body["presentations"][0]["fingers"][0]["channel"] = 3;
  CHECK_THROWS_AS(trial_record_from(body), StorageError);
  body = good;
  body["presentations"][1]["lateness_histogram"] = {1, 2};
  CHECK_THROWS_WITH(trial_record_from(body), Catch::Contains("histogram"));
  CHECK_THROWS_AS(trial_record_from(nlohmann::ordered_json(3)), StorageError);
}

TEST_CASE("a question asked several times has a key for each asking", "[data]") {
  CHECK(question_key("age", "", 0) == "age");
  CHECK(question_key("rating", "SV", 0) == "rating/SV");
  CHECK(question_key("rating", "SV", 36) == "rating/SV@36");
  CHECK(question_key("tired", "", 12) == "tired@12");
}

TEST_CASE("a replay says what happened and what is still open", "[data]") {
  const Plan plan = make_plan(tutorial(), 1, kSeed);
  MemoryLog log;
  log.append(event_kind::kSessionOpened, {{"participant", "P01"}}, {1, 1});
  CHECK_FALSE(replay(log.events()).closed);
  const Trial &a = plan.trials[8], &b = plan.trials[9], &c = plan.trials[10];
  log.append(event_kind::kQuestionAnswered, question_body("handedness", "before_session", "", "left", 0), {2, 2});
  log.append(event_kind::kPracticeEnded, {{"rounds", 1}, {"share_correct", 1.0}, {"passed", true}}, {3, 3});
  log.append(event_kind::kTrialVoided, voided_body(a, 1, "no_answer"), {4, 4});
  log.append(event_kind::kTrialVoided, voided_body(tutorial(), b, 1, "stale_pose"), {5, 5});
  log.append(event_kind::kTrialVoided, voided_body(a, 2, "no_answer"), {6, 6});
  log.append(event_kind::kTrialsShort, voided_body(b, 3, "attempts used up"), {7, 7});
  log.append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), c, kClassDifferent)), {8, 8});
  log.append(event_kind::kBreakTaken, {{"after_trial", 12}, {"duration_s", 20.0}}, {9, 9});
  log.append(event_kind::kQuestionAnswered, question_body(tutorial().questions[1], "SV", "7", 4), {10, 10});
  log.append(event_kind::kStopCleared, {{"reason", "checked the cable"}}, {10, 11});
  log.append(event_kind::kDeviceFault, {{"index", 3}}, {11, 11});
  log.append(event_kind::kSessionResumed, nlohmann::ordered_json::object(), {11, 12});

  SessionState state = replay(log.events());
  CHECK(state.opened);
  CHECK_FALSE(state.closed);
  CHECK(state.practice_ended);
  CHECK(state.voided == std::map<int, int>{{a.index, 2}, {b.index, 1}});
  CHECK(state.void_order == std::vector<int>{b.index, a.index});
  CHECK(state.abandoned == std::set<int>{b.index});
  REQUIRE(state.completed.size() == 1);
  CHECK(state.completed[0].trial == c);
  CHECK(state.breaks_after == std::set<int>{12});
  CHECK(state.answered == std::set<std::string>{"handedness", "effectiveness/SV@4"});
  CHECK(state.last_utc_ns == 11);
  CHECK(state.last_monotonic_ns == 12);
  log.append(event_kind::kSessionClosed, nlohmann::ordered_json::object(), {13, 13});
  CHECK(replay(log.events()).closed);
}

TEST_CASE("a replay of a broken event names it", "[data]") {
  MemoryLog log;
  log.append(event_kind::kTrialCompleted, {{"index", 1}}, {1, 1});
  CHECK_THROWS_WITH(replay(log.events()), Catch::Contains("event 1") && Catch::Contains("jnd verify"));
}

TEST_CASE("a whole number of a body is whole and fits, or is refused", "[data]") {
  const auto body = nlohmann::ordered_json::parse(
      R"({"seven":7,"half":1.5,"huge":1e99,"wide":4294967297,"widest":18446744073709551615,"yes":true})");
  CHECK(whole_at(body, "seven") == 7);
  CHECK(whole_at<std::int64_t>(body, "wide") == 4294967297);
  CHECK(whole_or(body, "none", 3) == 3);
  for (const char* key : {"half", "huge", "wide", "widest", "yes", "none"})
    CHECK_THROWS_AS(whole_at(body, key), nlohmann::json::exception);
  CHECK_THROWS_AS(whole_at<std::int64_t>(body, "widest"), nlohmann::json::exception);
  MemoryLog log;
  log.append(event_kind::kBreakTaken, {{"after_trial", 1e99}}, {1, 1});
  CHECK_THROWS_WITH(replay(log.events()), Catch::Contains("event 1") && Catch::Contains("jnd verify"));
  TrialBodyReader reader(Unit::n_per_m);
  CHECK_THROWS_AS(reader.read(R"({"series_place":4294967297,"condition_place":2,"same":false,"answer":"different"})"),
                  StorageError);
}

}  // namespace
}  // namespace jnd
