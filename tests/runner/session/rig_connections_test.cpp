// Devices that are unplugged in a session: it waits, goes on by itself, and uses up no attempt for it.
#include "runner/session/rig_connections.h"

#include <cmath>
#include <fstream>

#include "analysis/numerics/special_values.h"
#include "devices/hid/calibration/calibration_certificate.h"
#include "runner/session/session_engine.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

using test::Bench;
using test::small_protocol;

// The ideal rig, with one device that may be pulled out.
class PluggedRig final : public Rig {
 public:
  explicit PluggedRig(test::IdealRig& inside) : inside_(inside) {}
  const RigInfo& info() const noexcept override { return inside_.info(); }
  Presentation present(const PresentRequest& request) override {
    ++presented;
    return inside_.present(request);
  }
  void neutral() noexcept override { inside_.neutral(); }
  std::string missing() override { return absent() ? missing_sealed() + ", and said last: 575 N/m" : ""; }
  std::string missing_sealed() override { return absent() ? "device RRS3-0001 is not there" : ""; }
  RigConnections connections() const override {
    DeviceLinkReport device;
    device.serial = "RRS3-0001";
    device.connected = !absent();
    device.calibration_id = calibration_id;
    device.clock_uncertainty_s = kInf;
    return {.devices = {device}, .tracker = {}};
  }
  std::function<bool()> absent = [] { return false; };
  std::string calibration_id;
  int presented = 0;

 private:
  test::IdealRig& inside_;
};

// An operator who waits, or ends the session when something is missing.
class Waiting final : public SessionView {
 public:
  Waiting(Clock& clock, bool ends) : clock_(clock), ends_(ends) {}
  OperatorRequest missing(const std::string& what, const std::function<bool()>& back) override {
    told.push_back(what);
    if (ends_) return {Request::end_for_now, "lunch"};
    while (!back()) clock_.sleep_until_ns(clock_.now_ns() + 50'000'000);
    return {};
  }
  OperatorRequest ready(const TrialOutline&) override {
    announced();
    return {};
  }
  std::vector<std::string> told;
  std::function<void()> announced = [] {};

 private:
  Clock& clock_;
  bool ends_;
};

struct Scene {
  explicit Scene(const nlohmann::json& changes = {}) : bench(small_protocol(changes)) {
    // Pulled out in the presentations that `pulled` names, for `away_s`.
    rig.absent = [this] { return bench.clock.now_ns() < back_ns; };
    bench.rig.fault = [this](const PresentRequest&) {
      if (!pulled(rig.presented)) return Fault::none;
      back_ns = away_s > 0 ? bench.clock.now_ns() + static_cast<std::int64_t>(1e9 * away_s) : 0;
      return Fault::device_lost;
    };
  }
  SessionEnd run(SessionView& view, bool person) {
    const SessionParts parts{
        bench.protocol,   bench.plan,           rig,    bench.responder, bench.log, bench.clock, view,
        bench.interrupts, RecordPolicy::events, person, sealed};
    return SessionEngine(parts).run(replay(bench.log.events()), {});
  }
  std::vector<nlohmann::ordered_json> bodies(std::string_view kind) const {
    std::vector<nlohmann::ordered_json> found;
    for (const Event& event : bench.log.events())
      if (event.kind == kind) found.push_back(nlohmann::ordered_json::parse(event.body));
    return found;
  }
  std::vector<std::string> moments() const {
    std::vector<std::string> found;
    for (const auto& body : bodies(event_kind::kConnections)) found.push_back(body.at("when"));
    return found;
  }

  Bench bench;
  PluggedRig rig{bench.rig};
  std::int64_t back_ns = 0;
  double away_s = 100;
  bool sealed = true;
  std::function<bool(int)> pulled = [](int presented) { return presented == 3; };
};

TEST_CASE("A device that is pulled out is waited for, and the session goes on by itself") {
  Scene scene;
  Waiting person(scene.bench.clock, false);
  int announced = 0, too_soon = 0;  // trials: all, and those that could not begin
  person.announced = [&] {
    ++announced;
    if (scene.rig.absent()) ++too_soon;
  };
  REQUIRE(scene.run(person, true) == SessionEnd::completed);
  CHECK(announced == 17);
  CHECK(too_soon == 0);
  CHECK(person.told == std::vector<std::string>{"device RRS3-0001 is not there"});
  CHECK(scene.moments() == std::vector<std::string>{"fault", "missing", "back"});
  CHECK(scene.bodies(event_kind::kConnections)[1].at("devices")[0].at("connected") == false);
  CHECK(scene.bodies(event_kind::kConnections)[2].at("devices")[0].at("connected") == true);
  const auto voided = scene.bodies(event_kind::kTrialVoided);
  REQUIRE(voided.size() == 1);
  CHECK(voided[0].at("reason") == "device_lost");
  CHECK(voided[0].at("counts") == false);
  CHECK(scene.bench.completed().size() == 16);
  CHECK(scene.bench.rig.neutral_calls >= 1);
}

TEST_CASE("What a rig's program says is told where nothing is sealed, and nowhere else") {
  for (const bool sealed : {true, false}) {
    Scene scene;
    Waiting person(scene.bench.clock, true);
    scene.sealed = sealed;
    REQUIRE(scene.run(person, true) == SessionEnd::interrupted);
    REQUIRE(person.told.size() == 1);
    CHECK((person.told[0].find("575") == std::string::npos) == sealed);
  }
}

TEST_CASE("However often it is pulled out, no attempt is used up and nothing is presented meanwhile") {
  Scene scene(nlohmann::json{{"trial", {{"max_attempts", 1}}}});
  scene.pulled = [](int presented) { return presented % 3 == 0 && presented < 40; };
  Waiting person(scene.bench.clock, false);
  REQUIRE(scene.run(person, true) == SessionEnd::completed);
  CHECK(scene.bench.completed().size() == 16);
  CHECK(scene.bodies(event_kind::kTrialsShort).empty());
  CHECK(person.told.size() == scene.bodies(event_kind::kTrialVoided).size());
  CHECK(person.told.size() >= 10);
}

TEST_CASE("A device that is back before anybody looks uses up an attempt: it could go on for ever") {
  Scene scene;
  scene.away_s = 0;
  scene.pulled = [](int) { return true; };
  SessionView quiet;
  REQUIRE(scene.run(quiet, false) == SessionEnd::completed);
  CHECK(scene.bench.completed().empty());
  CHECK(scene.bodies(event_kind::kTrialsShort).size() == 16);
}

TEST_CASE("Without a person it waits half a minute, then ends so that it can be resumed") {
  Scene scene;
  scene.away_s = 20;
  SessionView quiet;
  SECTION("it comes back in time") {
    REQUIRE(scene.run(quiet, false) == SessionEnd::completed);
  }
  SECTION("it does not") {
    scene.away_s = 1e6;
    const std::int64_t began_ns = scene.bench.clock.now_ns();
    REQUIRE(scene.run(quiet, false) == SessionEnd::interrupted);
    CHECK(scene.bench.clock.now_ns() - began_ns < 60'000'000'000);
    CHECK(scene.bench.completed().size() == 1);
    scene.back_ns = 0;
    REQUIRE(scene.run(quiet, false) == SessionEnd::completed);
  }
  CHECK(scene.bench.completed().size() == 16);
}

TEST_CASE("A person may end the session while something is missing") {
  Scene scene;
  Waiting person(scene.bench.clock, true);
  REQUIRE(scene.run(person, true) == SessionEnd::interrupted);
  const auto left = scene.bodies(event_kind::kLeft);
  REQUIRE(left.size() == 1);
  CHECK(left[0].at("cause") == "operator");
  CHECK(left[0].at("reason") == "lunch");
  CHECK(scene.moments().back() == "missing");
}

TEST_CASE("A second Ctrl-C or a signal ends the waiting too") {
  Scene scene;
  class Signalled final : public SessionView {
   public:
    explicit Signalled(Interrupts& interrupts) : interrupts_(interrupts) {}
    OperatorRequest missing(const std::string&, const std::function<bool()>&) override {
      interrupts_.end = true;
      return {};
    }

   private:
    Interrupts& interrupts_;
  } view(scene.bench.interrupts);
  REQUIRE(scene.run(view, true) == SessionEnd::interrupted);
  CHECK(scene.bodies(event_kind::kLeft)[0].at("cause") == "signal");
}

TEST_CASE("A rig of models has no connections to keep") {
  Bench bench(small_protocol());
  bench.rig.fault = [](const PresentRequest& request) {
    return request.id.trial == 2 && request.id.attempt == 1 ? Fault::device_lost : Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  for (const std::string& kind : bench.kinds()) CHECK(kind != event_kind::kConnections);
}

TEST_CASE("A device's certificate goes into the study, or that it was not found") {
  const TemporaryFolder folder;
  CalibrationRecord record;
  record.identity.serial[0] = 'R';
  record.operator_name = "Ada";
  const nlohmann::ordered_json certificate = certificate_of(record);
  const std::string id = certificate.at("id");
  std::ofstream(folder.path() / (id + ".json")) << certificate.dump(2);

  Scene scene;
  Waiting view(scene.bench.clock, false);
  const SessionParts parts{scene.bench.protocol,
                           scene.bench.plan,
                           scene.rig,
                           scene.bench.responder,
                           scene.bench.log,
                           scene.bench.clock,
                           view,
                           scene.bench.interrupts,
                           RecordPolicy::events,
                           true};
  const SessionRecorder recorder(parts);
  note_calibrations(parts, recorder, {folder.path()});
  CHECK(scene.bodies(event_kind::kCalibration).empty());  // of a device that never was calibrated
  scene.rig.calibration_id = id;
  note_calibrations(parts, recorder, {folder.path() / "nowhere"});
  note_calibrations(parts, recorder, {folder.path() / "nowhere", folder.path()});
  const auto bodies = scene.bodies(event_kind::kCalibration);
  REQUIRE(bodies.size() == 2);
  CHECK(bodies[0].at("certificate").is_null());
  CHECK(bodies[1].at("serial") == "RRS3-0001");
  CHECK(bodies[1].at("calibration_id") == id);
  CHECK(bodies[1].at("certificate") == certificate);
}

TEST_CASE("Connections are kept whole, and what is no number as null") {
  DeviceLinkReport device;
  device.serial = "RRS3-0001";
  device.sent = 5;
  device.latency_p99_us = 12.5;
  device.slowest_presenting_ms = 30.5;
  device.slowest_waiting_ms = 410;
  device.clock_uncertainty_s = kInf;
  TrackerReport tracker;
  tracker.kind = "hid";
  tracker.gaps = 3;
  tracker.firmware = "2.7.0";
  tracker.is_model = true;
  const auto body = connections_body({.devices = {device}, .tracker = tracker}, "opened");
  CHECK(body.at("when") == "opened");
  CHECK(body.at("devices")[0].at("sent") == 5);
  CHECK(body.at("devices")[0].at("latency_p99_us") == 12.5);
  CHECK(body.at("devices")[0].at("slowest_presenting_ms") == 30.5);
  CHECK(body.at("devices")[0].at("slowest_waiting_ms") == 410);
  CHECK(body.at("devices")[0].at("clock_uncertainty_s").is_null());
  CHECK(body.at("tracker").at("gaps") == 3);
  CHECK(body.at("tracker").at("firmware") == "2.7.0");
  CHECK(body.at("tracker").at("is_model") == true);
  CHECK(connections_body({}, "closed").at("tracker").is_null());
}

TEST_CASE("One model among the devices or behind the tracker makes a rig one of models") {
  RigConnections rig;
  rig.devices.resize(2);
  CHECK_FALSE(rig.on_a_model());
  rig.tracker = TrackerReport{};
  CHECK_FALSE(rig.on_a_model());
  rig.tracker->is_model = true;
  CHECK(rig.on_a_model());
  rig.tracker.reset();
  rig.devices[1].is_model = true;
  CHECK(rig.on_a_model());
}

}  // namespace
}  // namespace jnd
