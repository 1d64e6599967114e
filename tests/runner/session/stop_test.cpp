// Stops in a session: their cause is kept with the ticks that led to it, only a person's word clears the latch, and a
// storage that blocks never leaves force on a finger.
#include <algorithm>
#include <vector>

#include "data/log/replay.h"
#include "data/log/telemetry.h"
#include "devices/participants/simulated_hand.h"
#include "devices/rigs/fingertip_rig.h"
#include "devices/rigs/rig_factory.h"
#include "protocols/rigs/rig_description.h"
#include "runner/session/record_policy.h"
#include "runner/session/session_engine.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

using test::Bench;
using test::small_protocol;

// A view of a person who clears a stop, or does not, and counts how often it was asked.
class Operator final : public SessionView {
 public:
  explicit Operator(bool clears) : clears_(clears) {}
  OperatorRequest recover(const std::string& stopped_by) override {
    asked.push_back(stopped_by);
    return {clears_ ? Request::go_on : Request::end_for_now, {}};
  }
  std::vector<std::string> asked;

 private:
  bool clears_;
};

std::vector<nlohmann::ordered_json> bodies(const MemoryLog& log, std::string_view kind) {
  std::vector<nlohmann::ordered_json> found;
  for (const Event& event : log.events())
    if (event.kind == kind) found.push_back(nlohmann::ordered_json::parse(event.body));
  return found;
}

TEST_CASE("A stop voids the trial, is logged with its source, and goes on only once it is cleared") {
  Bench bench(small_protocol());
  int presented = 0;
  bench.rig.fault = [&](const PresentRequest&) {
    if (++presented == 3) bench.rig.stop.latch(StopSource::button);
    return bench.rig.stop.latched() ? Fault::emergency_stop : Fault::none;
  };
  Operator person(true);
  REQUIRE(bench.run(person) == SessionEnd::completed);
  CHECK(person.asked.size() == 1);
  const auto faults = bodies(bench.log, event_kind::kDeviceFault);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].at("cause") == "emergency_stop");
  CHECK(bodies(bench.log, event_kind::kStopCleared).size() == 1);
  CHECK(bodies(bench.log, event_kind::kTrialVoided).size() == 1);
  CHECK(bench.completed().size() == 16);
}

TEST_CASE("A stop that nobody clears ends the session, resumably, and stays latched") {
  Bench bench(small_protocol());
  bench.rig.fault = [&](const PresentRequest&) {
    bench.rig.stop.latch(StopSource::key);
    return Fault::emergency_stop;
  };
  Operator person(false);
  REQUIRE(bench.run(person) == SessionEnd::interrupted);
  CHECK(bench.rig.stop.latched());
  CHECK(bodies(bench.log, event_kind::kStopCleared).empty());
  bench.rig.stop.clear();
  bench.rig.fault = [](const PresentRequest&) { return Fault::none; };
  CHECK(bench.run() == SessionEnd::completed);
  CHECK(bench.completed().size() == 16);
}

// The simulated rig of a protocol, with what its log needs.
struct RealBench {
  Protocol protocol = small_protocol();
  RigDescription description{.spec = load_rig_spec(JND_SOURCE_DIR "/devices/specs/rrs3.json")};
  ParticipantProfile profile = load_profile(JND_SOURCE_DIR "/devices/profiles/chinello2017.json");
  Plan plan = make_plan(protocol, 1, 1);
  SimulatedClock clock{0};
  Interrupts interrupts;
  SessionView view;

  SessionEnd run(SessionLog& log, RecordPolicy record) {
    const std::unique_ptr<Rig> rig =
        make_simulated_rig(protocol, description, profile, 1, 1, clock, rig_options(record, protocol, description));
    const std::unique_ptr<Responder> responder = make_simulated_participant(profile, protocol, 1, 1, clock);
    const SessionParts parts{protocol, plan, *rig, *responder, log, clock, view, interrupts, record, false};
    return SessionEngine(parts).run(replay(log.events()));
  }
};

TEST_CASE("Recording in full keeps every tick of every interval with its trial") {
  RealBench bench;
  MemoryLog log;
  REQUIRE(bench.run(log, RecordPolicy::full) == SessionEnd::completed);
  int trials = 0;
  for (const Event& event : log.events()) {
    if (event.kind != event_kind::kTrialCompleted) continue;
    ++trials;
    const auto body = nlohmann::ordered_json::parse(event.body);
    const TrialRecord record = trial_record_from(body);
    const std::vector<TelemetryBlob> blobs = log.telemetry(event.seq);
    REQUIRE(blobs.size() == 2);
    for (std::size_t interval = 0; interval < 2; ++interval) {
      CHECK(blobs[interval].interval == static_cast<int>(interval));
      CHECK(blobs[interval].dropped == 0);
      const Telemetry ticks = decode_telemetry(blobs[interval].bytes);
      const Presentation& given = record.presentations[interval];
      REQUIRE(ticks.ticks.size() == static_cast<std::size_t>(given.ticks) * given.fingers.size());
      double peak_n = 0;
      for (const TickRecord& tick : ticks.ticks)
        if (tick.channel == 0) peak_n = std::max(peak_n, tick.measured_n);
      CHECK(peak_n == given.fingers[0].peak_force_n);
    }
  }
  CHECK(trials == 16);
}

TEST_CASE("Recording events keeps no ticks, and neither changes what is delivered or answered") {
  RealBench full, events;
  MemoryLog with_ticks, without;
  REQUIRE(full.run(with_ticks, RecordPolicy::full) == SessionEnd::completed);
  REQUIRE(events.run(without, RecordPolicy::events) == SessionEnd::completed);
  const auto a = bodies(with_ticks, event_kind::kTrialCompleted), b = bodies(without, event_kind::kTrialCompleted);
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i].contains("telemetry"));
    CHECK_FALSE(b[i].contains("telemetry"));
    CHECK(a[i].at("presentations") == b[i].at("presentations"));
    CHECK(a[i].at("answer") == b[i].at("answer"));
  }
}

// Remembers what its device was told last.
class ToldDevice final : public FingertipDevice {
 public:
  DeviceStatus engage(std::int64_t) noexcept override { return DeviceStatus::ok; }
  DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept override {
    reading.time_ns = now_ns;
    reading.travel = -0.02;
    reading.force_n = told.force_n;
    return DeviceStatus::ok;
  }
  DeviceStatus write(const DeviceCommand& command, std::int64_t) noexcept override {
    told = command;
    largest_n = std::max(largest_n, command.force_n);
    return DeviceStatus::ok;
  }
  void neutral() noexcept override { told = DeviceCommand{}; }
  DeviceCommand told;
  double largest_n = 0;
};

// Blocks for five seconds at every event, and looks at the device while it does.
class SlowLog final : public SessionLog {
 public:
  SlowLog(Clock& clock, const ToldDevice& device, EmergencyStop* stop) : clock_(clock), device_(device), stop_(stop) {}
  void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override {
    force_while_blocked = force_while_blocked || device_.told.force_n != 0;
    if (stop_ != nullptr && ++appends == 2) stop_->latch(StopSource::key);
    clock_.sleep_until_ns(clock_.now_ns() + 5'000'000'000);
    force_while_blocked = force_while_blocked || device_.told.force_n != 0;
    log_.append(kind, body, stamp);
  }
  std::vector<Event> events() const override { return log_.events(); }
  const MemoryLog& log() const { return log_; }
  bool force_while_blocked = false;
  int appends = 0;

 private:
  MemoryLog log_;
  Clock& clock_;
  const ToldDevice& device_;
  EmergencyStop* stop_;
};

TEST_CASE("While the storage blocks for five seconds no device acts, and a stop is in force at the next tick") {
  for (const bool latched : {false, true}) {
    RealBench bench;
    RigParts parts;
    auto device = std::make_unique<ToldDevice>();
    ToldDevice& told = *device;
    parts.channels.push_back({.device = &told, .spec = *bench.description.spec.cutaneous()});
    parts.devices.push_back(std::move(device));
    parts.tracker = std::make_unique<SimulatedHand>(HandHabits{}, 1, 1, 1);
    parts.scene.object = sphere_object({.radius_m = 0.040});
    FingertipRig rig({}, std::move(parts), bench.clock);
    const auto responder = make_simulated_participant(bench.profile, bench.protocol, 1, 1, bench.clock);
    SlowLog log(bench.clock, told, latched ? &rig.stop : nullptr);
    const SessionParts parts_of_session{
        bench.protocol,   bench.plan,           rig,  *responder, log, bench.clock, bench.view,
        bench.interrupts, RecordPolicy::events, false};
    const SessionEnd end = SessionEngine(parts_of_session).run(replay(log.events()));
    CHECK_FALSE(log.force_while_blocked);
    CHECK(told.largest_n > 1);
    CHECK(end == (latched ? SessionEnd::interrupted : SessionEnd::completed));
    if (latched) {
      const auto faults = bodies(log.log(), event_kind::kDeviceFault);
      REQUIRE(faults.size() == 1);
      CHECK(faults[0].at("cause") == "emergency_stop");
      CHECK(faults[0].at("stopped_by") == "key");
    }
  }
}

}  // namespace
}  // namespace jnd
