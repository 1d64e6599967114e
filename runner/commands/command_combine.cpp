// jnd combine: puts the shards of simulated studies together.
#include <fmt/format.h>

#include "runner/commands/commands.h"
#include "runner/commands/power_options.h"
#include "runner/keys/interrupt.h"
#include "runner/power/power_shard.h"
#include "runner/shards/replicated_studies.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

struct CombineOptions {
  std::vector<std::string> files;
  PowerFiles written;
  bool replace = false;
  bool json = false;
};

int combine_power(const std::vector<std::filesystem::path>& files, const CombineOptions& options) {
  if (options.replace) throw UsageError("--replace is for the folder of simulated studies");
  refuse_existing(options.written);
  give_power_result(combined_power(files), options.written, options.json);
  return exit_code::kDone;
}

int combine_simulated(const std::vector<std::filesystem::path>& files, const CombineOptions& options) {
  if (options.json || !options.written.figure.empty() || !options.written.ademp.empty())
    throw UsageError("--json, --figure and --ademp are for shards of plan --power: these are of simulate --studies");
  if (options.written.csv.empty()) throw UsageError("say where the tables of these studies go: --csv FOLDER");
  ReplicationFolder folder(options.written.csv, options.replace);
  for_each_shard(files, [&folder](const StudyShard& shard) { folder.add(shard); });
  fmt::print("{}", folder.publish());
  return exit_code::kDone;
}

int command_combine(const CombineOptions& options) {
  const HoldInterrupts hold;
  const std::vector<std::filesystem::path> files(options.files.begin(), options.files.end());
  const bool power = read_shard(files.front()).kind == ShardKind::power;
  return power ? combine_power(files, options) : combine_simulated(files, options);
}

}  // namespace

void add_combine(CommandTree& tree) {
  const auto [command, options] =
      tree.add("combine", "Put the shards of simulated studies together", "jnd combine shards/*.json", command_combine);
  command
      .add_option("FILES", options.files,
                  "every file that plan --power --shard, or simulate --studies --shard, has written, in any order")
      .required();
  add_power_files(command, options.written,
                  "the numbers as CSV: of a power study also, as a file; of simulated studies in this folder");
  command.add_flag("--replace", options.replace, "replace the folder of an earlier run");
  command.add_flag("--json", options.json, "machine-readable, of a power study");
}

}  // namespace jnd
