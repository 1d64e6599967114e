// How late the control loop wakes: two simulated 3RRS fingers on the steady clock, presented as a session presents
// them, with telemetry. Prints one JSON object: the scheduling that was had, percentiles of the ticks' lateness in us.
// lateness.py sets it beside cyclictest. Usage: lateness_bench [SECONDS [require|prefer|off]]
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/loop/telemetry_ring.h"
#include "devices/rigs/rig_factory.h"

using namespace jnd;

namespace {

// Smallest lateness that at least `share` of the ticks did not exceed.
double percentile_us(const std::vector<std::int64_t>& sorted_ns, double share) {
  if (sorted_ns.empty()) return 0;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted_ns.size())));
  return 1e-3 * static_cast<double>(sorted_ns[std::max<std::size_t>(rank, 1) - 1]);
}

int measure(double seconds, RealtimePolicy policy) {
  const std::string root = JND_SOURCE_DIR;
  Protocol protocol;
  protocol.rig.device = "rrs3";
  protocol.rig.fingers = {"thumb", "index"};
  protocol.rig.tracker = "hand";
  RigDescription description;
  description.spec = load_rig_spec(root + "/devices/specs/rrs3.json");
  SteadyClock clock;
  const auto rig =
      make_simulated_rig(protocol, description, load_profile(root + "/devices/profiles/chinello2017.json"), 1, 1, clock,
                         {.telemetry_ticks = static_cast<std::size_t>((seconds + 12) * 2000), .realtime = policy});
  PresentRequest request;
  request.stimulus.stiffness = 700;
  request.stimulus.cues = {.force = true, .vibration = true};
  request.explore_s = seconds;
  request.no_contact_time_out_s = 10;
  request.id.trial = 1;
  const Presentation given = rig->present(request);

  std::vector<TickRecord> ticks;
  rig->telemetry()->drain(ticks);
  std::vector<std::int64_t> late_ns;
  for (const TickRecord& tick : ticks)
    if (tick.channel == 0) late_ns.push_back(tick.lateness_ns);
  if (!late_ns.empty()) late_ns.erase(late_ns.begin());  // the first tick is not waited for
  std::sort(late_ns.begin(), late_ns.end());
  fmt::print(
      "{{\"fifo\": {}, \"all_ok\": {}, \"ticks\": {}, \"overruns\": {}, \"fault\": \"{}\", \"dropped\": {}, "
      "\"p50_us\": {:.3f}, \"p99_us\": {:.3f}, \"max_us\": {:.3f}}}\n",
      rig->realtime().fifo(), rig->realtime().all_ok(), given.ticks, given.overruns, to_string(given.fault),
      rig->telemetry()->take_dropped(), percentile_us(late_ns, 0.50), percentile_us(late_ns, 0.99),
      percentile_us(late_ns, 1));
  if (!rig->realtime().all_ok()) fmt::print(stderr, "{}\n", rig->realtime().problems());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 5;
  const auto policy = argc > 2 ? parse_realtime_policy(argv[2]) : RealtimePolicy::prefer;
  if (seconds <= 0 || seconds > 3600 || !policy) {
    fmt::print(stderr, "usage: lateness_bench [SECONDS [require|prefer|off]]\n");
    return 2;
  }
  try {
    return measure(seconds, *policy);
  } catch (const std::exception& error) {
    fmt::print(stderr, "lateness_bench: {}\n", error.what());
    return 4;
  }
}
