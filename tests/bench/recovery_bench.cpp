// Recovery of the profiles' thresholds at full size: 200 simulated participants, 400 balanced trials a cell, through
// the rig. Prints 1/mean(m) of each condition beside the expected value, their ratio, and the standard error. Usage:
// recovery_bench [PARTICIPANTS [TRIALS_PER_CELL [THREADS]]]
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/group/group.h"
#include "data/task_results/task_results.h"
#include "protocols/input/read_file.h"
#include "protocols/reading/protocol_json.h"
#include "runner/session/simulate.h"

using namespace jnd;

namespace {

const std::string kSource = JND_SOURCE_DIR;

// Explorations of half a second: presses, soft start and the fit are the published protocol's, only shorter.
constexpr double kExplore_s = 0.5;

Protocol published(int trials_per_cell) {
  nlohmann::json json = nlohmann::json::parse(read_input_file(kSource + "/protocols/chinello2017.json"));
  json["design"]["trials_per_cell"] = trials_per_cell;
  json["design"]["sampling"] = "balanced";
  json["trial"]["explore_s"] = kExplore_s;
  json.erase("assumed");
  return parse_protocol(json.dump(), "published.json");
}

void recover(const std::string& name, const double (&expected)[3], int participants, int trials, int threads) {
  const Protocol protocol = published(trials);
  const RigDescription rig{.spec = load_rig_spec(kSource + "/devices/specs/rrs3.json")};
  const ParticipantProfile profile = load_profile(kSource + "/devices/profiles/" + name + ".json");
  Simulation simulation{protocol, rig, profile};
  simulation.participants = participants;
  simulation.threads = threads;
  simulation.seed = 1;
  simulation.progress = true;
  const auto began = std::chrono::steady_clock::now();
  const TaskResults results = results_of_counts(simulate_counts(simulation), protocol, SessionKind::simulated);
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  fmt::print("{} ({} participants, {} trials a cell, {:.0f} s)\n", name, participants, trials, elapsed);
  for (int condition = 0; condition < 3; ++condition) {
    std::vector<double> slopes;
    for (const TaskEstimateRow& row : results.estimates)
      if (row.condition == condition) slopes.push_back(row.estimates.values.front().value.value());
    const MeanEstimate mean = mean_with_ci(slopes);
    const double se = mean.sd / std::sqrt(mean.n) / (mean.mean * mean.mean);
    fmt::print("  {:<3} 1/mean(m) {:7.2f} ± {:.2f} N/m   expected {:6.1f}   ratio {:.4f}\n",
               protocol.conditions[static_cast<std::size_t>(condition)].name, 1 / mean.mean, se, expected[condition],
               1 / mean.mean / expected[condition]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int participants = argc > 1 ? std::atoi(argv[1]) : 200;
  const int trials = argc > 2 ? std::atoi(argv[2]) : 400;
  const int threads = argc > 3 ? std::atoi(argv[3]) : static_cast<int>(std::thread::hardware_concurrency());
  recover("chinello2017", {283.5, 351.0, 220.5}, participants, trials, threads);
  recover("chinello2017-differencing", {283.5, 351.0, 199.4}, participants, trials, threads);
}
