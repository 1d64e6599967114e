// What an integration step of the McKibben finger's model costs, beside Boost.Odeint's runge_kutta4 of the same
// equations in the same run, and what a millisecond of the device costs.
//
//   mckibben_bench [--benchmark_filter=...]     rk4/odeint against rk4/model is the ratio; both end in the same state
#include <array>
#include <cmath>

#include <benchmark/benchmark.h>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>

#include "devices/mckibben/mckibben_device.h"

namespace {

using namespace jnd;

constexpr ForceGains kP{.kp = 0.28};
constexpr double kAngle_rad = 0.6;
// Fref changes between 5 and 10 N every so many steps, so that the loop is never at rest.
constexpr int kSwitch = 512;

double reference_n(int step) {
  return (step / kSwitch) % 2 == 0 ? 5 : 10;
}

// (10)..(12) with pure P control, written down directly: p1, p1', Pmu.
struct Equations {
  using State = std::array<double, 3>;
  const MckibbenParameters& m;
  const MckibbenPose& pose;
  double reference_n = 0;

  void operator()(const State& x, State& rate, double) const {
    const double force = pose.off_n() + pose.ka_n_per_pa() * (x[2] - m.p_atm_pa);
    const double volts = std::fmin(std::fmax(kP.kp * (reference_n - force), m.valve_min_v), m.valve_max_v);
    const double s2 = m.sigma_n_rad_per_s * m.sigma_n_rad_per_s;
    rate[0] = x[1];
    rate[1] = s2 * (m.kv_pa_per_v * volts - x[0]) - 2 * m.zeta * m.sigma_n_rad_per_s * x[1];
    const double p1 = m.p_atm_pa + x[0];
    const double high = std::fmax(p1, x[2]), low = std::fmin(p1, x[2]);
    double flow = m.rho0_kg_per_m3 * m.c_m3_per_s_pa * high;
    const double ratio = (low / high - m.b) / (1 - m.b);
    if (ratio > 0) flow *= std::sqrt(std::fmax(0, 1 - ratio * ratio));
    rate[2] = pose.pa_per_kg * (p1 >= x[2] ? flow : -flow);
  }
};

void rk4_model(benchmark::State& state) {
  const MckibbenModel model(MckibbenParameters{}, Tendon::bilateral, kP);
  const MckibbenPose pose = *model.pose(kAngle_rad);
  MckibbenState at = model.steady_state(pose, 5);
  int step = 0;
  for (auto _ : state) {
    model.regulate(at, pose, reference_n(step++));
    benchmark::DoNotOptimize(at);
  }
  state.SetItemsProcessed(state.iterations());
}

void rk4_odeint(benchmark::State& state) {
  const MckibbenParameters parameters;
  const MckibbenModel model(parameters, Tendon::bilateral, kP);
  const MckibbenPose pose = *model.pose(kAngle_rad);
  const MckibbenState start = model.steady_state(pose, 5);
  Equations equations{parameters, pose};
  Equations::State at{start.valve_pa, start.valve_rate_pa_per_s, start.muscle_pa};
  boost::numeric::odeint::runge_kutta4<Equations::State> stepper;
  int step = 0;
  for (auto _ : state) {
    equations.reference_n = reference_n(step++);
    stepper.do_step(equations, at, 0.0, kMckibbenStep_s);
    benchmark::DoNotOptimize(at);
  }
  state.SetItemsProcessed(state.iterations());
}

// The two integrate the same equations: the largest difference of pressure over a second, in Pa.
void agreement(benchmark::State& state) {
  const MckibbenParameters parameters;
  const MckibbenModel model(parameters, Tendon::bilateral, kP);
  const MckibbenPose pose = *model.pose(kAngle_rad);
  double difference = 0;
  for (auto _ : state) {
    MckibbenState ours = model.steady_state(pose, 5);
    Equations equations{parameters, pose};
    Equations::State theirs{ours.valve_pa, ours.valve_rate_pa_per_s, ours.muscle_pa};
    boost::numeric::odeint::runge_kutta4<Equations::State> stepper;
    for (int step = 0; step < 10'000; ++step) {
      equations.reference_n = reference_n(step);
      stepper.do_step(equations, theirs, 0.0, kMckibbenStep_s);
      model.regulate(ours, pose, equations.reference_n);
      difference = std::fmax(difference, std::abs(ours.muscle_pa - theirs[2]));
    }
  }
  state.counters["largest_difference_pa"] = difference;
}

void pose_of_angle(benchmark::State& state) {
  const MckibbenModel model(MckibbenParameters{}, Tendon::bilateral, kP);
  double angle = kAngle_rad;
  for (auto _ : state) {
    angle = 0.4 + 1.2 * std::abs(angle - 0.6);  // some other one
    benchmark::DoNotOptimize(model.pose(angle));
  }
}

class Flexing final : public FingerFlexion {
 public:
  double angle_rad(std::int64_t time_ns) const noexcept override {
    return 0.64 - 0.28 * std::cos(3.14159 * 1e-9 * static_cast<double>(time_ns));
  }
};

void device_millisecond(benchmark::State& state) {
  const Flexing finger;
  MckibbenDevice device(MckibbenOptions{}, finger);
  std::int64_t now = 0;
  (void)device.engage(now);
  DeviceReading reading;
  DeviceCommand command;
  for (auto _ : state) {
    now += 1'000'000;
    (void)device.read(now, reading);
    command.force_n = 25 * std::fmax(0, reading.travel - 0.4);
    (void)device.write(command, now);
  }
  state.SetItemsProcessed(state.iterations());
}

}  // namespace

BENCHMARK(rk4_model)->Name("rk4/model");
BENCHMARK(rk4_odeint)->Name("rk4/odeint");
BENCHMARK(agreement)->Name("rk4/agreement")->Iterations(1);
BENCHMARK(pose_of_angle);
BENCHMARK(device_millisecond);

BENCHMARK_MAIN();
