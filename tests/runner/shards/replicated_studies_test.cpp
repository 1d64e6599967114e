// Many simulated studies: their tables are those of each study alone, and the same bytes however they are cut in shards.
#include "runner/shards/replicated_studies.h"

#include <fstream>
#include <functional>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "data/blocks/result_blocks.h"
#include "data/export/result_files.h"
#include "data/results/study_results.h"
#include "protocols/input/input_error.h"
#include "protocols/input/read_file.h"
#include "protocols/input/resources.h"
#include "runner/opening/rig_limits.h"
#include "runner/opening/study_access.h"
#include "tests/catch.h"
#include "tests/runner/power/power_fixture.h"
#include "tests/runner/rigged_fixture.h"
#include "tests/temporary_folder.h"

namespace jnd {
namespace {

namespace fs = std::filesystem;

// A question, and what it refers to.
struct Asked {
  Protocol protocol;
  RigDescription rig = rig_of(protocol);
  ParticipantProfile profile = load_profile(find_resource(Resource::profile, "chinello2017-varied"));
  int participants = 3;
  std::int64_t studies = 5;
  std::uint64_t seed = 7;

  ReplicationQuestion question() const { return {protocol, rig, profile, participants, studies, seed}; }
};

std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder))
    files[entry.path().filename().string()] = read_input_file(entry.path());
  return files;
}

// The tables of the shards in these files.
std::map<std::string, std::string> tables_of(const std::vector<fs::path>& shards, const fs::path& place) {
  ReplicationFolder folder(place, false);
  for_each_shard(shards, [&folder](const StudyShard& shard) { folder.add(shard); });
  folder.publish();
  return files_in(place);
}

void make(const Asked& asked, int number, int of, const fs::path& file, int threads = 1) {
  const ReplicationQuestion question = asked.question();
  make_shard(replication_shard(question, number, of), file, replication_work(question, threads));
}

std::string refusal(const std::vector<fs::path>& files, const fs::path& place) {
  try {
    tables_of(files, place);
  } catch (const InputError& error) {
    return error.what();
  }
  return "taken";
}

// A study on the disk, as jnd simulate makes it, and its tables.
std::map<std::string, std::string> tables_of_study(const Asked& asked, std::uint64_t seed) {
  const TemporaryFolder folder;
  Simulation simulation{asked.protocol, asked.rig, asked.profile};
  simulation.seed = seed;
  simulation.participants = asked.participants;
  const auto study = Study::create(folder.path() / "s.sqlite", asked.protocol.name, asked.protocol.bytes, seed,
                                   {simulated_epoch_ns(1), 0});
  simulate_study(simulation, *study);
  std::map<std::string, std::string> tables;
  const StudyResults results = results_of(*study, asked.protocol, SessionKind::simulated);
  for (const ResultFile& file : result_files(result_blocks(results, asked.protocol))) tables[file.name] = file.rows;
  return tables;
}

}  // namespace

TEST_CASE("tables of many studies have the rows of each, and its seed makes it again", "[shards][replicated]") {
  const TemporaryFolder folder;
  for (const Protocol& protocol :
       {testing::few_trials(TaskKind::same_different, 4), testing::short_staircases(TaskKind::which),
        testing::few_trials(TaskKind::yes_no, 4)}) {
    const Asked asked{.protocol = protocol, .studies = 2};
    const fs::path shard = folder.path() / fmt::format("{}.json", to_string(protocol.task.kind));
    make(asked, 1, 1, shard, 2);
    const auto tables = tables_of({shard}, folder.path() / to_string(protocol.task.kind));
    CHECK(tables.contains("dictionary.csv"));
    CHECK(tables.contains("datapackage.json"));
    std::map<std::string, std::string> expected;
    for (std::int64_t number = 0; number < 2; ++number) {
      const std::uint64_t seed = seed_of_study(asked.seed, number);
      for (const auto& [name, rows] : tables_of_study(asked, seed)) {
        std::istringstream lines(rows);
        for (std::string line; std::getline(lines, line);)
          expected[name] += fmt::format("{},{},{}\n", number + 1, seed, line);
      }
    }
    CHECK(expected.contains("group.csv"));
    CHECK(expected.contains("contrasts.csv"));
    for (const auto& [name, rows] : expected) {
      INFO(name);
      REQUIRE(tables.contains(name));
      CHECK(tables.at(name).substr(tables.at(name).find('\n') + 1) == rows);
      CHECK(tables.at(name).starts_with("study,seed,"));
    }
  }
}

TEST_CASE("seeds of studies are their own, and whole in a double", "[shards][replicated]") {
  std::set<std::uint64_t> seeds;
  for (std::int64_t number = 0; number < 10'000; ++number)
    for (const std::uint64_t seed : {1, 2}) seeds.insert(seed_of_study(seed, number));
  CHECK(seeds.size() == 20'000);
  CHECK(*seeds.rbegin() < (std::uint64_t{1} << 53U));
}

TEST_CASE("shards of simulated studies come to the same files however they are cut", "[shards][replicated][long]") {
  const TemporaryFolder folder;
  const Asked asked{testing::few_trials(TaskKind::same_different, 4)};
  make(asked, 1, 1, folder.path() / "whole.json", 2);
  const auto whole = tables_of({folder.path() / "whole.json"}, folder.path() / "whole");
  for (const int of : {2, 5, 7}) {
    std::vector<fs::path> files;
    for (int number = of; number >= 1; --number) {
      files.push_back(folder.path() / fmt::format("{}-of-{}.json", number, of));
      make(asked, number, of, files.back());
    }
    std::swap(files.front(), files[1]);
    CHECK(tables_of(files, folder.path() / fmt::format("of-{}", of)) == whole);
  }
}

TEST_CASE("a shard of simulated studies goes on from what was done of it", "[shards][replicated]") {
  const TemporaryFolder folder;
  const Asked asked{testing::few_trials(TaskKind::same_different, 4)};
  const fs::path whole = folder.path() / "whole", cut = folder.path() / "cut";
  make(asked, 1, 1, whole);
  // As if killed after three studies.
  const ReplicationQuestion question = asked.question();
  const ShardWork work = replication_work(question, 1);
  StudyShard part = replication_shard(question, 1, 1);
  part.range.last = 3;
  part.result = work.result(part.range, {});
  std::ofstream(cut.string() + ".part") << shard_text(part);
  std::int64_t first_told = 0;
  make_shard(replication_shard(question, 1, 1), cut, work, [&](std::int64_t done) {
    if (first_told == 0) first_told = done;
  });
  CHECK(first_told == 4);
  CHECK(read_input_file(cut) == read_input_file(whole));
}

TEST_CASE("shards of other studies are refused", "[shards][replicated]") {
  const TemporaryFolder folder;
  Asked asked{testing::few_trials(TaskKind::same_different, 4)};
  asked.studies = 2;
  const auto file = [&](const std::string& name) { return folder.path() / name; };
  make(asked, 1, 2, file("1"));
  make(asked, 2, 2, file("2"));
  const auto refused = [&](const std::string& second) {
    return refusal({file("1"), file(second)}, file("tables of " + second));
  };
  CHECK(refused("2") == "taken");

  Asked other{asked.protocol};
  other.studies = 2;
  other.profile = load_profile(find_resource(Resource::profile, "chinello2017"));
  make(other, 2, 2, file("profile"));
  CHECK_THAT(refused("profile"), Catch::Contains("profile is \"chinello2017\" and not"));
  // The same name with other numbers in the file.
  other.profile.name = asked.profile.name;
  make(other, 2, 2, file("edited profile"));
  CHECK_THAT(refused("edited profile"), Catch::Contains("simulation_sha256 is"));

  PowerQuestion power = testing::registered_question(asked.protocol);
  power.participants = {4};
  power.trials = {4};
  power.effects = {1};
  power.analyses = {PowerAnalysis::registered};
  power.studies = 2;
  testing::make_power_shard(asked.protocol, power, 2, 2, file("power"));
  CHECK_THAT(refused("power"), Catch::Contains("of jnd plan --power, and the first of jnd simulate"));
  // Well formed, and of no use.
  StudyShard empty = read_shard(file("2"));
  empty.result = {{{"file", 3}}};
  std::ofstream(file("foreign")) << shard_text(empty);
  CHECK_THAT(refused("foreign"), Catch::Contains("shard 2 of 2"));
  CHECK_FALSE(fs::exists(file("tables of foreign")));
  const auto edited = [&](const std::string& name, const std::function<void(StudyShard&)>& edit) {
    StudyShard shard = read_shard(file("2"));
    edit(shard);
    std::ofstream(file(name)) << shard_text(shard);
    return refused(name);
  };
  int n = 0;
  for (const char* const name : {"../out.csv", "dictionary.csv", "SHA256SUMS", "a\x1b[2J.csv"})
    CHECK_THAT(edited(std::to_string(100 + ++n), [&](StudyShard& shard) { shard.result[0]["file"] = name; }),
               Catch::Contains("a name that jnd does not give"));
  for (const char* const cell : {"=1+1", "\"\t@x,\"", "\"1\"", "\"1", "\x1b[2J", "1,1"})
    CHECK_THAT(edited(std::to_string(100 + ++n),
                      [&](StudyShard& shard) {
                        auto& rows = shard.result[0]["rows"].get_ref<std::string&>();
                        rows.replace(0, rows.find(','), cell);
                      }),
               Catch::Contains("not as jnd writes it"));
}

}  // namespace jnd
