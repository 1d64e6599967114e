// Whole simulated studies: the same result on any number of threads, recovery of the profiles' thresholds, no leak.
#include "runner/session/simulate.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "analysis/thresholds/jnd.h"
#include "data/export/export.h"
#include "data/verify/verify.h"
#include "protocols/input/read_file.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/temporary_folder.h"

namespace jnd {
namespace {

namespace fs = std::filesystem;

RigDescription rig() {
  return {.spec = load_rig_spec(JND_SOURCE_DIR "/devices/specs/rrs3.json")};
}
ParticipantProfile profile(const std::string& name) {
  return load_profile(std::string(JND_SOURCE_DIR "/devices/profiles/") + name + ".json");
}

// The published design with other trials a cell, balanced, and short explorations.
Protocol published(int trials_per_cell, double explore_s) {
  nlohmann::json json = nlohmann::json::parse(read_input_file(JND_SOURCE_DIR "/protocols/chinello2017.json"));
  json["design"]["trials_per_cell"] = trials_per_cell;
  json["design"]["sampling"] = "balanced";
  json["trial"]["explore_s"] = explore_s;
  json.erase("assumed");
  return parse_protocol(json.dump(), "published.json");
}

std::string all_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string text;
  for (const fs::path& file : files) text += fs::relative(file, folder).string() + "\n" + read_input_file(file);
  return text;
}

std::string exported(const Protocol& protocol, std::uint64_t seed, int threads) {
  const TemporaryFolder folder;
  const RigDescription device = rig();
  const ParticipantProfile who = profile("chinello2017-varied");
  Simulation simulation{protocol, device, who};
  simulation.participants = 5;
  simulation.threads = threads;
  simulation.seed = seed;
  const auto study =
      Study::create(folder.path() / "s.sqlite", protocol.name, protocol.bytes, seed, {simulated_epoch_ns(1), 0});
  const SimulationResult result = simulate_study(simulation, *study);
  REQUIRE(result.completed == 5);
  const VerifyReport report = verify(*study);
  CHECK(report.problems.empty());
  CHECK(report.trials == 5 * 9 * 4);
  CHECK(report.voided == 0);
  export_csv(*study, protocol, results_of(*study, protocol, SessionKind::simulated), folder.path() / "csv", false);
  return all_files(folder.path() / "csv");
}

TEST_CASE("The same seed gives byte-identical exports on any number of threads; another seed differs") {
  const Protocol protocol = published(4, 0.5);
  const std::string one = exported(protocol, 1, 1);
  CHECK(one == exported(protocol, 1, 2));
  CHECK(one == exported(protocol, 1, 5));
  CHECK(one != exported(protocol, 2, 2));
}

// 1/mean(m) of each condition, with the standard error that the scatter of the slopes gives it.
struct Recovered {
  double jnd[3];
  double se[3];
};

Recovered recover(const std::string& profile_name, int participants, int trials_per_cell,
                  const RigFilter& filter = {}) {
  const Protocol protocol = published(trials_per_cell, 0.5);
  const RigDescription device = rig();
  const ParticipantProfile who = profile(profile_name);
  Simulation simulation{protocol, device, who};
  simulation.participants = participants;
  simulation.threads = 2;
  simulation.seed = 20170920;
  const TaskResults results = results_of_counts(simulate_counts(simulation, filter), protocol, SessionKind::simulated);
  Recovered recovered{};
  for (int condition = 0; condition < 3; ++condition) {
    std::vector<double> slopes;
    for (const TaskEstimateRow& row : results.estimates)
      if (row.condition == condition) slopes.push_back(row.estimates.values[0].value.value());
    const MeanEstimate mean = mean_with_ci(slopes);
    REQUIRE(mean.n == participants);
    recovered.jnd[condition] = 1 / mean.mean;
    recovered.se[condition] = mean.sd / std::sqrt(participants) / (mean.mean * mean.mean);
  }
  return recovered;
}

TEST_CASE("Simulated participants reproduce their profile's thresholds through the rig, and SV as predicted",
          "[long]") {
  // S, V, SV: the first two are calibrated, the third is a prediction (magnitude: sqrt(1/(1/283.5^2 + 1/351^2)) =
  // 220.5).
  struct Expectation {
    const char* profile;
    double jnd[3];
  };
  for (const Expectation& expected : {Expectation{"chinello2017", {283.5, 351.0, 220.5}},
                                      Expectation{"chinello2017-differencing", {283.5, 351.0, 199.4}}}) {
    const Recovered recovered = recover(expected.profile, 12, 120);
    for (int condition = 0; condition < 3; ++condition) {
      INFO(expected.profile << " condition " << condition << ": " << recovered.jnd[condition] << " ± "
                            << recovered.se[condition]);
      // Log-linear rates at 60 trials a class pull d' down by less than 1 %; 4 standard errors for the draw.
      CHECK(std::abs(recovered.jnd[condition] - expected.jnd[condition]) <
            4 * recovered.se[condition] + 0.015 * expected.jnd[condition]);
      CHECK(recovered.se[condition] < 0.08 * expected.jnd[condition]);  // else the check above could not fail
    }
  }
}

// Renders 700 N/m whatever is asked.
class OneStiffnessRig final : public Rig {
 public:
  explicit OneStiffnessRig(std::unique_ptr<Rig> rig) : rig_(std::move(rig)) {}
  const RigInfo& info() const noexcept override { return rig_->info(); }
  Presentation present(const PresentRequest& request) override {
    PresentRequest same = request;
    same.stimulus.stiffness = 700;
    return rig_->present(same);
  }
  void neutral() noexcept override { rig_->neutral(); }

 private:
  std::unique_ptr<Rig> rig_;
};

TEST_CASE("Nothing leaks: a rig that renders every sphere alike brings every d' to 0 within its error", "[long]") {
  for (const char* name : {"chinello2017", "chinello2017-differencing"}) {
    const Protocol protocol = published(80, 0.5);
    const RigDescription device = rig();
    const ParticipantProfile who = profile(name);
    Simulation simulation{protocol, device, who};
    simulation.participants = 10;
    simulation.threads = 2;
    simulation.seed = 3;
    const auto filter = [](std::unique_ptr<Rig> rig) -> std::unique_ptr<Rig> {
      return std::make_unique<OneStiffnessRig>(std::move(rig));
    };
    const TaskResults results =
        results_of_counts(simulate_counts(simulation, filter), protocol, SessionKind::simulated);
    for (int condition = 0; condition < 3; ++condition) {
      std::vector<double> dprimes;
      for (const CellResult& cell : results.cells)
        if (cell.condition == condition) dprimes.push_back(cell.yes_no.dprime);
      const MeanEstimate mean = mean_with_ci(dprimes);
      const double se = mean.sd / std::sqrt(mean.n);
      INFO(name << " condition " << condition << ": d' " << mean.mean << " ± " << se);
      CHECK(std::abs(mean.mean) < 4 * se);
      CHECK(se < 0.1);
    }
  }
}

}  // namespace
}  // namespace jnd
