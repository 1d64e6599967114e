// What one contact update costs: a lone sphere against the bare nearest-point law it must cost no more than, and the
// shipped objects under a finger that presses and moves about.
//
//   contact_bench [--benchmark_filter=...]     items_per_second is updates
#include <cmath>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "devices/contact/god_object.h"
#include "devices/contact/object_json.h"

namespace {

using namespace jnd;

// The baseline: the law of one sphere, with the same result and the same memory of the last normal.
class NearestPoint {
 public:
  explicit NearestPoint(const Sphere& sphere) : sphere_(sphere) {}
  [[gnu::noinline]] const Contact& update(const Eigen::Vector3d& finger_m) noexcept {
    const Eigen::Vector3d from_centre = finger_m - sphere_.centre_m;
    const double distance = std::sqrt(from_centre.squaredNorm());
    const bool touched = contact_.touching;
    if (distance > 1e-9) contact_.normal = from_centre * (1 / distance);
    contact_.touching = sphere_.radius_m - distance > 1e-12;
    contact_.penetration_m = contact_.touching ? sphere_.radius_m - distance : 0;
    contact_.proxy_m = sphere_.centre_m + sphere_.radius_m * contact_.normal;
    contact_.event = contact_.touching == touched ? ContactEvent::none
                     : contact_.touching          ? ContactEvent::made
                                                  : ContactEvent::broken;
    return contact_;
  }

 private:
  Sphere sphere_;
  Contact contact_;
};

VirtualObject shipped(const std::string& name) {
  return load_object(std::string(JND_SOURCE_DIR) + "/devices/objects/" + name + ".json").shape;
}

// Twenty seconds at 1 kHz: a press a second, 3 mm deep on the average, wandering over the side that the index meets.
std::vector<Eigen::Vector3d> presses(const VirtualObject& object) {
  std::vector<Eigen::Vector3d> path;
  for (int ms = 0; ms < 20000; ++ms) {
    const double t = 1e-3 * ms;
    const Eigen::Vector3d direction =
        Eigen::Vector3d(1, 0.4 * std::sin(0.61 * t), 0.4 * std::cos(0.47 * t)).normalized();
    path.emplace_back((object.surface_along(direction) + 0.001 + 0.005 * std::cos(2 * M_PI * t)) * direction);
  }
  return path;
}

template <typename Model>
void press(benchmark::State& state, Model& model, const std::vector<Eigen::Vector3d>& path) {
  std::size_t at = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(model.update(path[at]).penetration_m);
    if (++at == path.size()) at = 0;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
}

void baseline(benchmark::State& state) {
  const VirtualObject object = shipped("sphere");
  NearestPoint model(object.spheres.front());
  press(state, model, presses(object));
}

void god_object(benchmark::State& state, const char* name) {
  const VirtualObject object = shipped(name);
  GodObject model;
  model.begin(object, Eigen::Vector3d::UnitX());
  press(state, model, presses(object));
}

}  // namespace

BENCHMARK(baseline);
BENCHMARK_CAPTURE(god_object, sphere, "sphere");
BENCHMARK_CAPTURE(god_object, wall, "wall");
BENCHMARK_CAPTURE(god_object, teddy_bear, "teddy-bear");
BENCHMARK_CAPTURE(god_object, baseball, "baseball");

BENCHMARK_MAIN();
