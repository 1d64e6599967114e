// jnd simulate: a whole study of simulated participants; or the results of many.
#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "data/blocks/result_blocks.h"
#include "data/fields/number_text.h"
#include "data/study/blinding.h"
#include "protocols/input/resources.h"
#include "protocols/tasks/task.h"
#include "runner/commands/commands.h"
#include "runner/commands/shard_options.h"
#include "runner/keys/interrupt.h"
#include "runner/opening/rig_limits.h"
#include "runner/opening/study_access.h"
#include "runner/results/analysis_text.h"
#include "runner/session/simulate.h"
#include "runner/shards/replicated_studies.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/progress_bar.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

struct SimulateOptions {
  std::string protocol;
  std::optional<std::string> study;
  int participants = 1;
  std::optional<std::uint64_t> seed;
  std::string profile;  // empty: the one that fits the protocol
  int threads = 0;      // 0: as many as the machine has processors
  bool no_study = false;
  int studies = 0;  // 0: one, as a study or with its result printed
  std::string csv;  // folder of the tables of many; empty: none
  bool replace = false;
  ShardOptions shard;
  bool json = false;
  std::string record = "events";  // off, events, full
};

int interrupted() {
  write_message("jnd: interrupted; nothing was kept\n");
  return exit_code::kInterrupted;
}

// What the group came to, as jnd analyze shows it.
void print_group(const StudyResults& results, const Protocol& protocol, bool json) {
  const std::vector<Block> blocks = result_blocks(results, protocol);
  if (json)
    fmt::print("{}\n", json_line(to_json(results, blocks, protocol)));
  else
    fmt::print("{}", answer_text(results, blocks, protocol));
}

// Of pairs at given levels counts are enough; all others go through a study that nobody keeps.
int simulate_without_study(const Simulation& simulation, bool json) {
  const Protocol& protocol = simulation.protocol;
  if (task_of(protocol.task.kind).evidence(protocol) == Evidence::counts) {
    const std::vector<CellCounts> cells = simulate_counts(simulation);
    if (interrupt_requested()) return interrupted();
    print_group(
        results_of(results_of_counts(cells, protocol, SessionKind::simulated), simulation.participants, protocol),
        protocol, json);
    return exit_code::kDone;
  }
  try {
    print_group(simulated_results(simulation, source_to_analyse(protocol, std::nullopt), json), protocol, json);
  } catch (const Stopped&) {
    return interrupted();
  }
  return exit_code::kDone;
}

// Many studies, of which the results are kept.
int simulate_studies(const Simulation& simulation, const SimulateOptions& options) {
  if (options.csv.empty() == options.shard.to.empty())
    throw UsageError("say where the results of the studies go: --csv FOLDER, or of a shard --to FILE");
  const ShardPlace place = place_of(options.shard);
  const ReplicationQuestion question{simulation.protocol,
                                     simulation.rig,
                                     simulation.profile,
                                     simulation.participants,
                                     options.studies,
                                     options.seed.value_or(1),
                                     source_to_analyse(simulation.protocol, std::nullopt)};
  const ShardWork work = replication_work(question, simulation.threads);
  StudyShard shard = replication_shard(question, place.number, place.of);
  if (!options.shard.to.empty()) return make_shard_file(shard, work, options.shard);
  ReplicationFolder folder(options.csv, options.replace);
  std::optional<ProgressBar> bar(std::in_place, "simulating studies", options.studies);
  const std::int64_t at_once = std::int64_t{16} * simulation.threads;  // what is held in memory
  for (std::int64_t first = 0; first < options.studies; first += at_once) {
    shard.range = {first, std::min<std::int64_t>(options.studies, first + at_once)};
    shard.result = work.result(shard.range, [&](std::int64_t done) { bar->update(first + done); });
    folder.add(shard);
  }
  bar.reset();
  fmt::print("{}", folder.publish());
  return exit_code::kDone;
}

int command_simulate(const SimulateOptions& options) {
  const HoldInterrupts hold;
  const bool many = options.studies > 0;
  if (!many && options.no_study == options.study.has_value())
    throw UsageError(
        "say where the data go: --study FILE, or --no-study to keep nothing; of many studies --studies N --csv FOLDER");
  const Protocol protocol = load_checked_protocol(options.protocol);
  const RigDescription rig = rig_of(protocol);
  const ParticipantProfile profile = load_profile(
      find_resource(Resource::profile, options.profile.empty() ? default_profile(protocol) : options.profile));
  if (const std::string other = not_shipped_text(rig.spec); !other.empty() && !options.json)
    fmt::print("{}\n", warn(printable(fmt::format("The rig is {}: {}.", other, limits_text(rig.spec)))));
  const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  Simulation simulation{protocol, rig, profile};
  simulation.record = record_policy_of(options.record);
  simulation.participants = options.participants;
  simulation.threads = options.threads > 0 ? options.threads : processors;
  simulation.progress = true;
  if (many) return simulate_studies(simulation, options);
  if (options.no_study) {
    simulation.seed = options.seed.value_or(1);
    return simulate_without_study(simulation, options.json);
  }

  if (std::filesystem::exists(*options.study)) require_sound(*options.study);
  const std::unique_ptr<Study> study =
      open_or_create_study(*options.study, protocol, options.seed, {simulated_epoch_ns(1), 0});
  if (!study->sessions().empty() && plan_sealed(*study, protocol))
    throw UsageError(
        fmt::format("{} holds sessions of people and is blinded: simulated participants would go through the same "
                    "plans and show them. "
                    "Simulate into another file, or with --no-study",
                    *options.study));
  simulation.seed = study->info().seed;
  const SimulationResult result = simulate_study(simulation, *study);
  study->close();
  const std::string file = study->path().string();
  if (result.interrupted) {
    fmt::print("Interrupted. Every answer so far is in {}; the same command goes on from here.\n", printable(file));
    return exit_code::kInterrupted;
  }
  std::int64_t trials = 0;
  std::int64_t voided = 0;
  for (const SessionInfo& session : Study::open(file, Study::Access::read_only)->sessions()) {
    if (session.kind != SessionKind::simulated || session.participant_number > options.participants) continue;
    trials += session.trials_done;
    voided += session.trials_voided;
  }
  const int sessions = protocol.design.sessions;
  if (result.already_complete > 0)
    fmt::print("{} had finished before.\n",
               counted(result.already_complete, sessions == 1 ? "participant" : "session"));
  fmt::print("{}: {}{}, profile {}, seed {}: {} {}, {} voided\n", printable(file),
             counted(options.participants, "participant"),
             sessions == 1 ? "" : fmt::format(", {} sessions each", sessions), printable(profile.name), simulation.seed,
             trials, protocol.explore ? "explorations" : "trials", voided);
  fmt::print("  next:  jnd analyze {}\n", shell_word(file));
  return exit_code::kDone;
}

}  // namespace

void add_simulate(CommandTree& tree) {
  const auto [command, options] =
      tree.add("simulate", "Run simulated participants through the study",
               "jnd simulate chinello2017 --participants 18 --study s.sqlite --seed 1", command_simulate);
  command.add_option("PROTOCOL", options.protocol, "protocol file, or name of a shipped one").required();
  command.add_option("--study", options.study, "the study's file; made where it does not exist");
  command.add_option("--participants", options.participants, "how many, numbered from 1 (default: 1)")
      .range(1, 100'000);
  command.add_option("--seed", options.seed,
                     "seed of a new study (default: drawn, printed and kept in the study; without a study 1)");
  command.add_option("--profile", options.profile, "profile file, or name of a shipped one (default: what fits)");
  command
      .add_option("--threads", options.threads,
                  "participants, or of many studies these, at a time (default: one a processor)")
      .range(1, 1024);
  const CommandOption studies =
      command
          .add_option("--studies", options.studies, "so many of them, each with a seed of its own: the results alone")
          .range(1, 1'000'000);
  const CommandOption csv = command.add_option(
      "--csv", options.csv, "the results of these studies, below each other, as CSV files in this folder");
  csv.needs(studies);
  command.add_flag("--replace", options.replace, "replace that folder of an earlier run").needs(csv);
  add_shard_options(command, options.shard, "--studies");
  command.option("--to").excludes(csv);
  command.add_option("--record", options.record, "what is kept: off, events (faults; default), full (every tick)")
      .one_of({"off", "events", "full"});
  command.add_flag("--no-study", options.no_study, "keep nothing: print the group's result only");
  command.add_flag("--json", options.json, "machine-readable result of --no-study");
  for (const char* const one : {"--study", "--no-study", "--json", "--record"}) studies.excludes(command.option(one));
}

}  // namespace jnd
