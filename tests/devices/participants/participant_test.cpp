// Simulated participants feel only what was delivered, and show the thresholds they were calibrated to.
#include <cmath>
#include <map>
#include <vector>

#include "analysis/numerics/normal.h"
#include "devices/loop/rendering.h"
#include "devices/participants/perceived_stiffness.h"
#include "devices/participants/simulated_participant.h"
#include "protocols/input/input_error.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// What an ideal rig would deliver.
Presentation delivered(double stiffness, Cues cues) {
  Presentation presentation;
  presentation.fingers.resize(2);
  for (FingerPresentation& finger : presentation.fingers) {
    if (cues.force) finger.stiffness = stiffness;
    if (cues.vibration) finger.vibration_g = std::min(burst_amplitude_g(stiffness), 1.0);
  }
  return presentation;
}

struct Rates {
  double hit = 0, false_alarm = 0;
};

// Many trials of one series, half of them different. The plan's words are false on purpose: they must not matter.
Rates rates_of(const ParticipantProfile& profile, double low, double high, Cues cues, int trials) {
  SimulatedClock clock{0};
  const Protocol protocol = small_protocol();
  const auto responder = make_simulated_participant(profile, protocol, 1, 11, clock);
  int different = 0, hits = 0, same = 0, alarms = 0;
  Trial trial;
  trial.target = kClassSame;
  trial.stimuli = {1, 1};
  for (int i = 1; i <= trials; ++i) {
    trial.index = i;
    const double first = i % 4 < 2 ? low : high, second = i % 2 == 0 ? low : high;
    const std::array<Presentation, 2> presentations{delivered(first, cues), delivered(second, cues)};
    const auto answer = responder->judge({.trial = trial, .presentations = presentations});
    const bool said = answer->said == kClassDifferent;
    if (first != second) {
      ++different;
      hits += said;
    } else {
      ++same;
      alarms += said;
    }
  }
  return {static_cast<double>(hits) / different, static_cast<double>(alarms) / same};
}

double dprime_of(const Rates& rates) {
  return normal_quantile(rates.hit) - normal_quantile(rates.false_alarm);
}

// Least-squares JND over the differences 200, 300 and 400 N/m against 900.
double jnd_of(const ParticipantProfile& profile, Cues cues, int trials) {
  double xy = 0, xx = 0;
  for (const double difference : {200.0, 300.0, 400.0}) {
    xy += difference * dprime_of(rates_of(profile, 900 - difference, 900, cues, trials));
    xx += difference * difference;
  }
  return xx / xy;
}

}  // namespace

TEST_CASE("calibrated on S and V alone, both strategies predict the published combination") {
  // Monte-Carlo error of the JND at 40,000 trials a series is about 0.8 per cent: three of them.
  constexpr int kTrials = 40'000;
  const auto profile = GENERATE(as<std::string>{}, "chinello2017", "chinello2017-differencing");
  const ParticipantProfile shipped = shipped_profile(profile.c_str());
  const double predicted = profile == "chinello2017" ? 220.5 : 199.4;
  CHECK(jnd_of(shipped, kForce, kTrials) == Approx(283.5).epsilon(0.025));
  CHECK(jnd_of(shipped, kVibration, kTrials) == Approx(351.0).epsilon(0.025));
  CHECK(jnd_of(shipped, kBoth, kTrials) == Approx(predicted).epsilon(0.025));
}

TEST_CASE("the criterion of each strategy gives the false alarms of its theory") {
  const Rates magnitude = rates_of(shipped_profile("chinello2017"), 500, 900, kForce, 40'000);
  // P(N(0, 283.5^2) > 150), and P(N(400, 283.5^2) > 150).
  CHECK(magnitude.false_alarm == Approx(normal_cdf(-150 / 283.5)).margin(0.015));
  CHECK(magnitude.hit == Approx(normal_cdf(250 / 283.5)).margin(0.015));
  const Rates differencing = rates_of(shipped_profile("chinello2017-differencing"), 500, 900, kBoth, 40'000);
  // 2 Phi(-tau / (sqrt 2 sigma)) with tau = 2 sigma.
  CHECK(differencing.false_alarm == Approx(2 * normal_cdf(-std::sqrt(2.0))).margin(0.015));
}

TEST_CASE("a rig that always renders the same stiffness leaks nothing", "[long]") {
  // The engine says 500 against 900; the rig delivers 700 whatever is asked.
  class OneStiffnessRig final : public Rig {
   public:
    explicit OneStiffnessRig(Rig& rig) : rig_(rig) {}
    const RigInfo& info() const noexcept override { return rig_.info(); }
    Presentation present(const PresentRequest& request) override {
      PresentRequest changed = request;
      changed.stimulus.stiffness = 700;
      return rig_.present(changed);
    }
    void neutral() noexcept override { rig_.neutral(); }

   private:
    Rig& rig_;
  };
  SimulatedClock clock{0};
  const Protocol protocol = small_protocol();
  for (const char* name : {"chinello2017", "chinello2017-differencing"}) {
    const ParticipantProfile profile = shipped_profile(name);
    const auto device = make_simulated_rig(protocol, rrs3_rig(), profile, 1, 5, clock);
    OneStiffnessRig rig(*device);
    const auto responder = make_simulated_participant(profile, protocol, 1, 5, clock);
    std::map<bool, std::pair<int, int>> said;  // same -> (trials, "different")
    for (int i = 1; i <= 1200; ++i) {
      Trial trial;
      trial.index = i;
      trial.condition = 2;
      trial.stimuli = {i % 2 == 0 ? 500.0 : 900.0, i % 4 < 2 ? 500.0 : 900.0};
      trial.target = trial.stimuli[0] == trial.stimuli[1] ? kClassSame : kClassDifferent;
      std::array<Presentation, 2> presentations;
      for (int interval = 0; interval < 2; ++interval) {
        PresentRequest asked = request(trial.stimuli[static_cast<std::size_t>(interval)], kBoth,
                                       {.trial = i, .attempt = 1, .interval = interval});
        asked.explore_s = 1;
        presentations[static_cast<std::size_t>(interval)] = rig.present(asked);
      }
      const auto answer = responder->judge({.trial = trial, .presentations = presentations});
      auto& [trials, different] = said[(trial.target == kClassSame)];
      ++trials;
      different += answer->said == kClassDifferent;
    }
    const Rates rates{static_cast<double>(said[false].second) / said[false].first,
                      static_cast<double>(said[true].second) / said[true].first};
    // Standard error of d' with 600 + 600 trials at these rates is below 0.09.
    CHECK(std::abs(dprime_of(rates)) < 0.3);
  }
}

TEST_CASE("cues are those delivered: mean force slope, strongest vibration, nothing where nothing was") {
  Presentation presentation = delivered(600, kBoth);
  presentation.fingers[0].stiffness = 580;
  presentation.fingers[1].stiffness = 620;
  presentation.fingers[0].vibration_g = 0.6;
  const StiffnessCues both = cues_of(presentation);
  CHECK(*both.force == Approx(600));
  CHECK(*both.vibration == Approx(600));
  presentation.fingers[0].stiffness.reset();
  CHECK(*cues_of(presentation).force == Approx(620));
  CHECK_FALSE(cues_of(delivered(600, kVibration)).force);
  CHECK_FALSE(cues_of(delivered(600, kForce)).vibration);
  // A clamped burst feels like 900 N/m.
  CHECK(*cues_of(delivered(1500, kBoth)).vibration == Approx(900));
}

TEST_CASE("without a cue in both intervals an answer is bias, not information") {
  for (const char* name : {"chinello2017", "chinello2017-differencing"}) {
    const ParticipantProfile profile = shipped_profile(name);
    const Rates none = rates_of(profile, 500, 900, Cues{}, 20'000);
    CHECK(std::abs(dprime_of(none)) < 0.1);
    CHECK(none.false_alarm > 0.01);
    const StiffnessCues force{.force = 500, .vibration = {}}, vibration{.force = {}, .vibration = 900};
    for (const double n : {-2.0, -0.5, 0.3, 1.0, 2.5}) {
      const PerceptNoise noise{n, -n / 2, 0.1, 0.2};
      CHECK(judge_cues(profile, force, vibration, 1, noise).said == judge_cues(profile, {}, {}, 1, noise).said);
    }
  }
}

TEST_CASE("answers depend on participant, trial and attempt, and on nothing else") {
  const ParticipantProfile profile = shipped_profile("chinello2017");
  const Protocol protocol = small_protocol();
  const std::array<Presentation, 2> presentations{delivered(600, kBoth), delivered(900, kBoth)};
  const auto answers = [&](int participant, std::uint64_t seed, int attempt, int first) {
    SimulatedClock clock{0};
    const auto responder = make_simulated_participant(profile, protocol, participant, seed, clock);
    std::vector<double> times;
    for (int i = first; i <= 20; ++i) {
      Trial trial;
      trial.index = i;
      times.push_back(
          responder->judge({.trial = trial, .attempt = attempt, .presentations = presentations})->response_time_s);
    }
    return times;
  };
  const std::vector<double> whole = answers(1, 5, 1, 1), resumed = answers(1, 5, 1, 11);
  CHECK(std::vector<double>(whole.begin() + 10, whole.end()) == resumed);
  CHECK(answers(2, 5, 1, 1) != whole);
  CHECK(answers(1, 6, 1, 1) != whole);
  CHECK(answers(1, 5, 2, 1) != whole);
}

TEST_CASE("an answer takes its time on the clock, and a late one is none") {
  ParticipantProfile profile = shipped_profile("chinello2017");
  const Protocol protocol = small_protocol();
  SimulatedClock clock{0};
  const std::array<Presentation, 2> presentations{delivered(600, kBoth), delivered(900, kBoth)};
  const auto responder = make_simulated_participant(profile, protocol, 1, 5, clock);
  double logs = 0;
  constexpr int kTrials = 2000;
  for (int i = 1; i <= kTrials; ++i) {
    Trial trial;
    trial.index = i;
    const std::int64_t before = clock.now_ns();
    const auto answer = responder->judge({.trial = trial, .presentations = presentations, .time_out_s = 30});
    REQUIRE(answer);
    CHECK(answer->entered_by == EnteredBy::participant);
    REQUIRE(1e-9 * static_cast<double>(clock.now_ns() - before) == Approx(answer->response_time_s).margin(1e-8));
    logs += std::log(answer->response_time_s);
  }
  CHECK(std::exp(logs / kTrials) == Approx(1.2).epsilon(0.03));
  profile.response_time_median_s = 10;
  const auto slow = make_simulated_participant(profile, protocol, 1, 5, clock);
  const std::int64_t before = clock.now_ns();
  Trial trial;
  CHECK_FALSE(slow->judge({.trial = trial, .presentations = presentations, .time_out_s = 0.5}));
  CHECK(clock.now_ns() - before == 500'000'000);
}

TEST_CASE("lapses answer by a coin, whatever was felt") {
  ParticipantProfile profile = shipped_profile("chinello2017");
  profile.lapse_rate = 1;
  const Rates rates = rates_of(profile, 100, 5000, kForce, 8000);
  CHECK(rates.hit == Approx(0.5).margin(0.04));
  CHECK(rates.false_alarm == Approx(0.5).margin(0.04));
}

TEST_CASE("drift makes late trials noisier, and spread makes participants differ") {
  ParticipantProfile tired = shipped_profile("chinello2017");
  tired.drift_per_trial = 0.01;
  const Rates fresh = rates_of(shipped_profile("chinello2017"), 500, 900, kForce, 4000),
              worn = rates_of(tired, 500, 900, kForce, 4000);
  CHECK(dprime_of(worn) < dprime_of(fresh) / 2);

  ParticipantProfile varied = shipped_profile("chinello2017-varied");
  CHECK(varied.spread_cv == 0.2);
  varied.lapse_rate = varied.drift_per_trial = 0;
  const Protocol protocol = small_protocol();
  const std::array<Presentation, 2> presentations{delivered(640, kForce), delivered(900, kForce)};
  int changed = 0;
  for (int participant = 1; participant <= 40; ++participant) {
    SimulatedClock clock{0};
    const auto one = make_simulated_participant(varied, protocol, participant, 5, clock);
    ParticipantProfile plain = varied;
    plain.spread_cv = 0;
    const auto other = make_simulated_participant(plain, protocol, participant, 5, clock);
    for (int i = 1; i <= 40; ++i) {
      Trial trial;
      trial.index = i;
      changed += one->judge({.trial = trial, .presentations = presentations})->said !=
                 other->judge({.trial = trial, .presentations = presentations})->said;
    }
  }
  CHECK(changed > 10);
  CHECK(changed < 400);
}

TEST_CASE("replies keep to the question's form") {
  const auto question = [](Question::Kind kind, const char* id, double min = 0, double max = 0) {
    Question made;
    made.kind = kind;
    made.id = id;
    made.min = min;
    made.max = max;
    return made;
  };
  const Question rating = question(Question::Kind::rating, "effectiveness", 1, 9);
  const Question age = question(Question::Kind::number, "age", 18, 40);
  Question hand = question(Question::Kind::choice, "hand");
  hand.options = {"left", "right"};
  const Question required = question(Question::Kind::text, "note");
  Question optional = required;
  optional.required = false;

  SimulatedClock clock{0};
  const Protocol protocol = small_protocol();
  const ParticipantProfile profile = shipped_profile("chinello2017");
  std::array<double, 3> sums{};
  constexpr int kPeople = 400;
  for (int participant = 1; participant <= kPeople; ++participant) {
    const auto person = make_simulated_participant(profile, protocol, participant, 5, clock);
    for (int condition = 0; condition < 3; ++condition) {
      const std::string reply = *person->reply(rating, condition);
      REQUIRE(reply.size() == 1);
      REQUIRE(reply[0] >= '1');
      REQUIRE(reply[0] <= '9');
      sums[static_cast<std::size_t>(condition)] += reply[0] - '0';
      CHECK(*person->reply(rating, condition) == reply);
    }
    CHECK(person->reply(rating, -1).has_value());
    const int years = std::stoi(*person->reply(age, -1));
    CHECK(years >= 18);
    CHECK(years <= 40);
    const std::string side = *person->reply(hand, -1);
    CHECK((side == "left" || side == "right"));
    CHECK_FALSE(person->reply(optional, -1));
    CHECK_FALSE(person->reply(required, -1)->empty());
  }
  // The scale's end at 9 pulls the highest mean down a little.
  CHECK(sums[0] / kPeople == Approx(6.7).margin(0.35));
  CHECK(sums[1] / kPeople == Approx(3.7).margin(0.35));
  CHECK(sums[2] / kPeople == Approx(7.5).margin(0.35));
}
