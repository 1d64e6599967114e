// The dynamic model: steady states, trajectories of an independent numpy model, limits, and the force controller.
#include <cmath>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "devices/mckibben/mckibben_response.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/mckibben/mckibben_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

double any_angle() {
  return straight_rad() + (flexed_rad() - straight_rad()) * *rc::gen::inRange(0, 10'001) / 1e4;
}

}  // namespace

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
