// The McKibben finger's dynamic model and the experiments with it.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "devices/mckibben/mckibben_response.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/mckibben/mckibben_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// The dynamic model: steady states, trajectories of an independent numpy model, limits, and the force controller.

double any_angle() {
  return straight_rad() + (flexed_rad() - straight_rad()) * *rc::gen::inRange(0, 10'001) / 1e4;
}

TEST_CASE("steps reproduce an independent model within 0.01 N") {
  for (const auto& row : mckibben_reference().at("step")) {
    if (!row.contains("F_at")) continue;
    INFO(row.dump());
    const StepResponse response = step_response(kTable1, {.loop = {.gains = {.kp = row.at("KP")}},
                                                          .angle_rad = row.at("alpha1"),
                                                          .from_n = row.at("Fref0"),
                                                          .to_n = row.at("Fref1")});
    for (const auto& [time, force] : row.at("F_at").items()) {
      const auto sample = static_cast<std::size_t>(std::lround(std::stod(time) * 1000));
      REQUIRE(sample < response.force_n.size());
      CHECK(response.time_s[sample] == Approx(std::stod(time)));
      CHECK(response.force_n[sample] == Approx(force.get<double>()).margin(0.01));
    }
    CHECK(response.start_n == Approx(row.at("F_start").get<double>()).epsilon(1e-9));
    CHECK(response.final_n == Approx(row.at("F_final_theory").get<double>()).epsilon(1e-9));
    CHECK(response.steady_error_n == Approx(row.at("e_ss").get<double>()).epsilon(1e-9));
    CHECK(response.overshoot_pct == Approx(row.at("overshoot_pct").get<double>()).margin(1));
    CHECK(response.force_n.back() == Approx(response.final_n).margin(1e-3));
    CHECK(response.verdict == StepVerdict::stable);
  }
}

TEST_CASE("the controller is inside the step: half the step changes the trajectory by less than 1 mN") {
  const MckibbenModel model = mckibben_model({.kp = 0.7});
  const MckibbenPose pose = *model.pose(straight_rad());
  MckibbenState whole = model.steady_state(pose, 0), half = whole;
  double difference = 0;
  for (int i = 0; i < 2000; ++i) {
    model.regulate(whole, pose, 5);
    model.regulate(half, pose, 5, kMckibbenStep_s / 2);
    model.regulate(half, pose, 5, kMckibbenStep_s / 2);
    difference =
        std::max(difference, std::abs(model.force_n(pose, whole.muscle_pa) - model.force_n(pose, half.muscle_pa)));
  }
  CHECK(difference < 1e-3);
}

TEST_CASE("settled under P the force is (L Fref + off) / (1 + L), and simulation comes to rest there") {
  REQUIRE(rc::check("P", [] {
    const double kp = *rc::gen::inRange(5, 71) / 100.0, reference = *rc::gen::inRange(0, 26);
    const MckibbenModel model = mckibben_model({.kp = kp});
    const MckibbenPose pose = *model.pose(any_angle());
    const double gain = pose.ka_n_per_pa() * kTable1.kv_pa_per_v * kp;
    const double expected = (gain * reference + pose.off_n()) / (1 + gain);
    MckibbenState state = model.steady_state(pose, reference);
    RC_ASSERT(std::abs(model.force_n(pose, state.muscle_pa) - expected) < 1e-9);
    const MckibbenState before = state;
    for (int i = 0; i < 100; ++i) model.regulate(state, pose, reference);
    RC_ASSERT(std::abs(state.muscle_pa - before.muscle_pa) < 1);
    // From elsewhere too.
    state = model.vented();
    for (int i = 0; i < 15'000; ++i) model.regulate(state, pose, reference);
    RC_ASSERT(std::abs(model.force_n(pose, state.muscle_pa) - expected) < 1e-3);
  }));
}

TEST_CASE("kA and off at straight, 35 degrees and flexed") {
  const MckibbenModel model = mckibben_model();
  const double angles[] = {straight_rad(), 35 * kDegree, flexed_rad()};
  const double ka[] = {15.964, 20.601, 20.84}, off[] = {-14.162, -8.024, -3.30};
  for (int i = 0; i < 3; ++i) {
    CHECK(model.pose(angles[i])->ka_n_per_pa() * 1e5 == Approx(ka[i]).margin(5e-3));
    CHECK(model.pose(angles[i])->off_n() == Approx(off[i]).margin(5e-3));
  }
}

TEST_CASE("pressures stay between none and the supply, whatever is asked") {
  REQUIRE(rc::check("pressure", [] {
    const auto tendon = *rc::gen::element(Tendon::bilateral, Tendon::unilateral);
    const MckibbenModel model = mckibben_model({.kp = *rc::gen::inRange(0, 400) / 100.0,
                                                .ki = *rc::gen::inRange(0, 30) * 1.0,
                                                .kd = *rc::gen::inRange(0, 3) / 100.0},
                                               tendon);
    const double most = kTable1.kv_pa_per_v * kTable1.valve_max_v;
    MckibbenState state = model.steady_state(*model.pose(any_angle()), *rc::gen::inRange(-10, 50));
    for (int block = 0; block < 10; ++block) {
      const MckibbenPose pose = *model.pose(any_angle());
      const double reference = *rc::gen::inRange(-50, 200);
      const bool open_loop = *rc::gen::inRange(0, 2) == 0;
      for (int i = 0; i < 200; ++i) {
        if (open_loop)
          model.step(state, pose, reference);
        else
          model.regulate(state, pose, reference);
        RC_ASSERT(model.gauge_pa(state) >= 0);
        RC_ASSERT(model.gauge_pa(state) <= most);
        RC_ASSERT(state.valve_pa >= 0);
        RC_ASSERT(state.valve_pa <= most);
        RC_ASSERT(model.volts(state, pose, reference) >= 0);
        RC_ASSERT(model.volts(state, pose, reference) <= kTable1.valve_max_v);
      }
    }
  }));
}

TEST_CASE("what is not a number does not spread") {
  const MckibbenModel model = mckibben_model({.kp = 0.1, .ki = 3, .kd = 0.001});
  const MckibbenPose pose = *model.pose(straight_rad());
  for (const double bad : {kNaN, kInf, -kInf}) {
    for (int field = 0; field < 5; ++field) {
      MckibbenState state = model.steady_state(pose, 5);
      (field == 0   ? state.valve_pa
       : field == 1 ? state.valve_rate_pa_per_s
       : field == 2 ? state.muscle_pa
       : field == 3 ? state.controller.integral_v
                    : state.controller.filtered_n) = bad;
      model.regulate(state, pose, 5);
      CHECK(std::isfinite(model.force_n(pose, state.muscle_pa)));
      CHECK(state.muscle_pa >= kTable1.p_atm_pa);
    }
    MckibbenState state = model.steady_state(pose, 5);
    model.step(state, pose, bad);
    CHECK(std::isfinite(state.muscle_pa));
    model.regulate(state, pose, bad);
    CHECK(std::isfinite(state.muscle_pa));
  }
  MckibbenState state = model.steady_state(pose, 5);
  for (int i = 0; i < 10'000; ++i) model.step(state, pose, kNaN);  // a closed valve: it vents
  CHECK(model.gauge_pa(state) < 10);
}

TEST_CASE("an integral gain leaves no error, and does not wind up") {
  for (const Tendon tendon : {Tendon::bilateral, Tendon::unilateral}) {
    const MckibbenModel model = mckibben_model({.kp = 0.10, .ki = 3.0}, tendon);
    for (const double angle : {straight_rad(), 35 * kDegree, flexed_rad()}) {
      const MckibbenPose pose = *model.pose(angle);
      MckibbenState state = model.steady_state(pose, 0);
      CHECK(model.force_n(pose, state.muscle_pa) == Approx(0).margin(1e-9));
      // Two seconds of a force beyond the supply, then 5 N: as soon there as from an honest start, within a tenth of a
      // second of unavoidable venting.
      for (int i = 0; i < 20'000; ++i) model.regulate(state, pose, 500);
      CHECK(state.controller.integral_v <= kTable1.valve_max_v);
      for (int i = 0; i < 10'000; ++i) model.regulate(state, pose, 5);
      CHECK(model.force_n(pose, state.muscle_pa) == Approx(5).margin(0.01));
      // The same from below, where the valve cannot go.
      for (int i = 0; i < 20'000; ++i) model.regulate(state, pose, -500);
      CHECK(state.controller.integral_v >= 0);
      for (int i = 0; i < 5'000; ++i) model.regulate(state, pose, 5);
      CHECK(model.force_n(pose, state.muscle_pa) == Approx(5).margin(0.01));
    }
  }
}

TEST_CASE("the controller: P, I and D, clamped, with conditional integration") {
  const ForceController p({.kp = 2}, 0, 10);
  CHECK(p.respond(3, {}).volts == 6);
  CHECK(p.respond(30, {}).volts == 10);
  CHECK(p.respond(-1, {}).volts == 0);
  CHECK(p.respond(3, {}).rate.integral_v == 0);
  CHECK(p.respond(kNaN, {}).volts == 0);

  const ForceController pi({.kp = 2, .ki = 5}, 0, 10);
  CHECK(pi.respond(1, {.integral_v = 3, .filtered_n = 0}).volts == 5);
  CHECK(pi.respond(1, {.integral_v = 3, .filtered_n = 0}).rate.integral_v == 5);
  CHECK(pi.respond(1, {.integral_v = 9, .filtered_n = 0}).rate.integral_v == 0);     // 11 V: no further up
  CHECK(pi.respond(-1, {.integral_v = 13, .filtered_n = 0}).rate.integral_v == -5);  // but down
  CHECK(pi.respond(-1, {.integral_v = 1, .filtered_n = 0}).rate.integral_v == 0);    // -1 V: no further down

  // A steadily rising error comes out as Kd times its slope.
  const ForceController d({.kd = 0.01}, -10, 10);
  ControllerState state;
  double volts = 0;
  for (int i = 0; i < 100'000; ++i) {
    const ForceController::Output output = d.respond(100 * i * 1e-6, state);
    state.filtered_n += 1e-6 * output.rate.filtered_n;
    volts = output.volts;
  }
  CHECK(volts == Approx(0.01 * 100).epsilon(1e-6));
}

TEST_CASE("gains and parameters that make no finger are refused") {
  CHECK_THROWS_AS(mckibben_model({.kp = -1}), InputError);
  CHECK_THROWS_AS(mckibben_model({.kp = 1, .ki = kInf}), InputError);
  MckibbenParameters parameters;
  parameters.l0_m = 0.12;  // the muscle would be too short to pull
  CHECK_THROWS_AS(MckibbenModel(parameters, Tendon::bilateral, {.kp = 0.28}), InputError);
  parameters = {};
  parameters.h_fibre_m = 0.13;  // or longer than its fibre
  CHECK_THROWS_AS(MckibbenModel(parameters, Tendon::bilateral, {.kp = 0.28}), InputError);
}

TEST_CASE("a pose between two is on the line") {
  const MckibbenModel model = mckibben_model();
  const MckibbenPose first = *model.pose(0.5), second = *model.pose(0.501);
  const MckibbenPose middle = between(first, second, 0.5), exact = *model.pose(0.5005);
  CHECK(middle.alpha1_rad == Approx(0.5005));
  CHECK(middle.off_n() == Approx(exact.off_n()).epsilon(1e-6));
  CHECK(middle.ka_n_per_pa() == Approx(exact.ka_n_per_pa()).epsilon(1e-6));
  CHECK(middle.pa_per_kg == Approx(exact.pa_per_kg).epsilon(1e-6));
}

// The experiments with the McKibben finger: limit cycles, frequency response, tracking, onset of oscillation, and what
// they refuse.

StepResponse step(double kp, double angle, double from, double to) {
  return step_response(kTable1, {.loop = {.gains = {.kp = kp}}, .angle_rad = angle, .from_n = from, .to_n = to});
}

double bandwidth(double angle, double mean, double amplitude) {
  const FrequencyResponse response = frequency_response(kTable1, {.loop = {.gains = {.kp = 0.7}},
                                                                  .angle_rad = angle,
                                                                  .mean_n = mean,
                                                                  .amplitude_n = amplitude,
                                                                  .frequency_rad_per_s = {1}});
  REQUIRE(response.bandwidth_rad_per_s);
  return *response.bandwidth_rad_per_s;
}

TEST_CASE("limit cycles are those of an independent model") {
  int cycles = 0;
  for (const auto& row : mckibben_reference().at("step")) {
    if (!row.contains("limit_cycle_pp")) continue;
    ++cycles;
    const StepResponse response = step(row.at("KP"), row.at("alpha1"), row.at("Fref0"), row.at("Fref1"));
    CHECK(response.verdict == StepVerdict::limit_cycle);
    CHECK(response.oscillation_pp_n == Approx(row.at("limit_cycle_pp").get<double>()).epsilon(0.05));
    CHECK(response.oscillation_rad_per_s == Approx(row.at("limit_cycle_rad_s").get<double>()).epsilon(0.05));
    CHECK(response.tail_mean_n == Approx(row.at("mean").get<double>()).epsilon(0.05));
  }
  CHECK(cycles == 3);
}

TEST_CASE("gains of 0.3, 0.35 and 0.7 are stable everywhere, and the error falls with the gain") {
  for (const double angle : {straight_rad(), 28 * kDegree, 35 * kDegree, 45 * kDegree, flexed_rad()}) {
    for (const auto& [from, to] : {std::pair{0.0, 5.0}, std::pair{5.0, 10.0}, std::pair{10.0, 5.0}}) {
      double error = 1e9;
      for (const double kp : {0.3, 0.35, 0.7}) {
        const StepResponse response = step(kp, angle, from, to);
        CHECK(response.verdict == StepVerdict::stable);
        CHECK(response.oscillation_rad_per_s == 0);
        CHECK(response.steady_error_n < error);
        CHECK(response.steady_error_n > 0);
        CHECK(response.overshoot_pct > 0);
        error = response.steady_error_n;
      }
    }
  }
}

TEST_CASE("the force falls again: exhaust is part of (11)") {
  const StepResponse response = step(0.28, flexed_rad(), 10, 2);
  CHECK(response.start_n > 7);
  CHECK(response.force_n.back() == Approx(response.final_n).margin(1e-3));
  CHECK(response.final_n < 2);
}

TEST_CASE("sustained oscillation begins at a loop gain of 20 to 21, at every angle") {
  for (const auto& row : mckibben_reference().at("onset").at("KPstar")) {
    const double angle = row.at("alpha1");
    const auto onset = onset_of_oscillation(kTable1, angle);
    REQUIRE(onset);
    CHECK(*onset == Approx(row.at("KP").get<double>()).margin(0.06));
    const double gain = mckibben_model().pose(angle)->ka_n_per_pa() * kTable1.kv_pa_per_v * *onset;
    CHECK(gain > 4 * kTable1.zeta * (1 + kTable1.zeta));  // 20.16, of the linear loop at its worst
    CHECK(gain < 21);
  }
  CHECK(*onset_of_oscillation(kTable1, straight_rad()) == Approx(1.26).margin(0.06));
  CHECK(*onset_of_oscillation(kTable1, 35 * kDegree) == Approx(0.98).margin(0.06));
  CHECK(*onset_of_oscillation(kTable1, flexed_rad()) == Approx(0.97).margin(0.06));
  CHECK_THROWS_AS(onset_of_oscillation(kTable1, 0.1), InputError);
}

TEST_CASE("the frequency response is that of an independent model in the same window", "[long]") {
  for (const auto& row : mckibben_reference().at("freq")) {
    BodeOptions options{.loop = {.gains = {.kp = row.at("KP")}},
                        .angle_rad = row.at("alpha1"),
                        .mean_n = row.at("mean"),
                        .amplitude_n = row.at("amp"),
                        .frequency_rad_per_s = row.at("w")};
    const FrequencyResponse response = frequency_response(kTable1, options);
    CHECK(response.dc == Approx(row.at("DC").get<double>()).epsilon(1e-9));
    for (std::size_t i = 0; i < response.magnitude.size(); ++i) {
      CHECK(response.magnitude[i] == Approx(row.at("mag")[i].get<double>()).epsilon(0.002));
      CHECK(response.phase_rad[i] == Approx(row.at("phase")[i].get<double>()).margin(0.002));
    }
    // Settled, what was still ringing at 160 rad/s after six cycles is gone: measuring longer changes nothing.
    options.settle_cycles = 20;
    options.measure_cycles = 10;
    const FrequencyResponse settled = frequency_response(kTable1, options);
    options.settle_cycles = 40;
    options.measure_cycles = 10;
    const FrequencyResponse later = frequency_response(kTable1, options);
    for (std::size_t i = 0; i < 4; ++i) CHECK(settled.magnitude[i] == Approx(later.magnitude[i]).epsilon(0.005));
  }
}

TEST_CASE("the bandwidth depends on the amplitude") {
  CHECK(bandwidth(straight_rad(), 10, 8) == Approx(79).epsilon(0.03));
  CHECK(bandwidth(flexed_rad(), 10, 8) == Approx(82).epsilon(0.03));
  CHECK(bandwidth(straight_rad(), 5, 0.1) == Approx(436).epsilon(0.03));
  CHECK(bandwidth(flexed_rad(), 5, 0.1) == Approx(500).epsilon(0.03));
}

TEST_CASE("the default frequencies go up, start at the dc gain, and do not move the bandwidth") {
  BodeOptions options{.loop = {.gains = {.kp = 0.7}},
                      .angle_rad = straight_rad(),
                      .mean_n = 10,
                      .amplitude_n = 8,
                      .frequency_rad_per_s = {}};
  const FrequencyResponse response = frequency_response(kTable1, options);
  REQUIRE(response.frequency_rad_per_s.size() == 31);
  CHECK(response.magnitude.front() == Approx(response.dc).epsilon(0.002));
  CHECK(std::is_sorted(response.frequency_rad_per_s.begin(), response.frequency_rad_per_s.end()));
  for (std::size_t i = 1; i < response.phase_rad.size(); ++i)
    CHECK(std::abs(response.phase_rad[i] - response.phase_rad[i - 1]) < 3.2);
  options.frequency_rad_per_s = {300, 20};
  const FrequencyResponse few = frequency_response(kTable1, options);
  CHECK(few.frequency_rad_per_s == std::vector<double>{20, 300});
  CHECK(few.bandwidth_rad_per_s == response.bandwidth_rad_per_s);
}

TEST_CASE("tracking of the six objects of the paper at 0.5 Hz") {
  const double stiffness[] = {8, 10, 20, 30, 40, 50};
  const double peak[] = {3.45, 4.43, 9.35, 14.26, 19.18, 24.09};
  for (int i = 0; i < 6; ++i) {
    const TrackResult result = track(kTable1, {.loop = {}, .kobj_n_per_rad = stiffness[i], .frequency_hz = 0.5});
    CHECK(result.force_peak_n == Approx(peak[i]).margin(0.01));
    CHECK(result.reference_peak_n == Approx(stiffness[i] * (flexed_rad() - straight_rad())).epsilon(1e-6));
  }
  for (const auto& row : mckibben_reference().at("track")) {
    const TrackResult result =
        track(kTable1, {.loop = {}, .kobj_n_per_rad = row.at("Kobj"), .frequency_hz = row.at("freq_hz")});
    CHECK(result.force_peak_n == Approx(row.at("F_peak").get<double>()).margin(0.01));
    CHECK(result.force_min_n == Approx(row.at("F_min").get<double>()).margin(0.01));
    CHECK(result.rms_error_n == Approx(row.at("rms_e").get<double>()).margin(0.01));
  }
}

TEST_CASE("PI renders the asked stiffness, P a part of it") {
  const LoopOptions p{.gains = {.kp = 0.28}, .tendon = Tendon::unilateral};
  const LoopOptions pi{.gains = {.kp = 0.10, .ki = 3.0}, .tendon = Tendon::unilateral};
  for (const double asked : {8.0, 15.0, 25.0, 35.0, 50.0}) {
    CHECK(track(kTable1, {.loop = pi, .kobj_n_per_rad = asked, .frequency_hz = 0.05}).rendered_n_per_rad ==
          Approx(asked).epsilon(0.002));
    CHECK(track(kTable1, {.loop = pi, .kobj_n_per_rad = asked, .frequency_hz = 0.5}).rendered_n_per_rad ==
          Approx(asked).epsilon(0.01));
    const double under_p =
        track(kTable1, {.loop = p, .kobj_n_per_rad = asked, .frequency_hz = 0.05}).rendered_n_per_rad;
    CHECK(under_p < 0.85 * asked);
    CHECK(under_p > 0.60 * asked);
  }
}

TEST_CASE("an integral gain ends at the reference, and the steady state says so") {
  const StepResponse response =
      step_response(kTable1, {.loop = {.gains = {.kp = 0.1, .ki = 3}}, .angle_rad = 0.6, .from_n = 0, .to_n = 5});
  CHECK(response.final_n == Approx(5).epsilon(1e-12));
  CHECK(response.steady_error_n == Approx(0).margin(1e-9));
  CHECK(response.force_n.back() == Approx(5).margin(0.01));
  CHECK(to_string(response.verdict) == "stable");
  // A reference that the supply cannot reach: the steady state is the supply's.
  const StepResponse beyond =
      step_response(kTable1, {.loop = {.gains = {.kp = 0.1, .ki = 3}}, .angle_rad = 0.6, .from_n = 0, .to_n = 900});
  CHECK(beyond.final_n < 250);
  CHECK(beyond.force_n.back() == Approx(beyond.final_n).epsilon(1e-3));
}

TEST_CASE("options outside their range are refused with the range") {
  const auto step_refusal = [](auto change) {
    StepOptions options{.loop = {}, .angle_rad = 0.5, .from_n = 0, .to_n = 5};
    change(options);
    try {
      (void)step_response(kTable1, options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  // Not Catch's matcher, whose name differs between its versions.
  const auto says = [&](auto change, const char* text) { return step_refusal(change).find(text) != std::string::npos; };
  CHECK(step_refusal([](StepOptions&) {}).empty());
  CHECK(says([](StepOptions& o) { o.angle_rad = 1.0; }, "20.121 to 53.106 deg"));
  CHECK(says([](StepOptions& o) { o.angle_rad = std::nan(""); }, "outside"));
  CHECK(says([](StepOptions& o) { o.to_n = 0; }, "two different forces"));
  CHECK(says([](StepOptions& o) { o.to_n = std::nan(""); }, "1000 N"));
  CHECK(says([](StepOptions& o) { o.duration_s = 0; }, "600 s"));
  CHECK(says([](StepOptions& o) { o.loop.gains.kp = -1; }, "gain"));

  BodeOptions bode{.loop = {}, .angle_rad = 0.5, .mean_n = 5, .amplitude_n = 0, .frequency_rad_per_s = {}};
  CHECK_THROWS_AS(frequency_response(kTable1, bode), InputError);
  bode.amplitude_n = 1;
  bode.frequency_rad_per_s = {0};
  CHECK_THROWS_AS(frequency_response(kTable1, bode), InputError);
  CHECK_THROWS_AS(track(kTable1, {.loop = {}, .kobj_n_per_rad = 0, .frequency_hz = 0.5}), InputError);
  CHECK_THROWS_AS(track(kTable1, {.loop = {}, .kobj_n_per_rad = 8, .frequency_hz = 0}), InputError);
}

}  // namespace
