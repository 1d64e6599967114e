// How fast two simulated fingers are rendered: stimulus seconds per processor second, and the cost of one loop tick.
//
//   rig_bench [--benchmark_filter=...]     items_per_second is ticks; stimulus_s_per_s is the ratio that matters
#include <benchmark/benchmark.h>

#include "devices/rigs/rig_factory.h"

namespace {

using namespace jnd;

void present(benchmark::State& state, Cues cues) {
  Protocol protocol;
  protocol.rig = {.device = "rrs3", .fingers = {"thumb", "index"}, .tracker = "hand"};
  SimulatedClock clock{0};
  const std::string root = JND_SOURCE_DIR;
  const auto rig =
      make_simulated_rig(protocol, RigDescription{.spec = load_rig_spec(root + "/devices/specs/rrs3.json")},
                         load_profile(root + "/devices/profiles/chinello2017.json"), 1, 1, clock);
  PresentRequest request{
      .stimulus = {.stiffness = 700, .cues = cues}, .explore_s = 3, .no_contact_time_out_s = 10, .id = {}};
  std::int64_t ticks = 0;
  double stimulus_s = 0;
  for (auto _ : state) {
    ++request.id.trial;
    const Presentation given = rig->present(request);
    ticks += given.ticks;
    stimulus_s += given.duration_s;
  }
  state.SetItemsProcessed(ticks);
  state.counters["stimulus_s_per_s"] = benchmark::Counter(stimulus_s, benchmark::Counter::kIsRate);
}

}  // namespace

BENCHMARK_CAPTURE(present, force, jnd::Cues{.force = true, .vibration = false})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(present, vibration, jnd::Cues{.force = false, .vibration = true})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(present, both, jnd::Cues{.force = true, .vibration = true})->Unit(benchmark::kMillisecond);

BENCHMARK_MAIN();
