// jnd cluster: makes the folder of a campaign, submits it, and follows it to its end.
#include <chrono>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "data/fields/number_text.h"
#include "data/files/scratch_folder.h"
#include "devices/device_error.h"
#include "runner/cluster/called_program.h"
#include "runner/cluster/campaign.h"
#include "runner/cluster/cluster.h"
#include "runner/cluster/follower.h"
#include "runner/cluster/job_script.h"
#include "runner/cluster/slurm.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

struct ClusterOptions {
  std::string folder;
  std::vector<std::string> job;  // plan PROTOCOL --power ..., simulate PROTOCOL --studies ...
  std::optional<int> shards;
  std::optional<std::string> program, partition, time, account, memory;
  std::optional<int> at_once;
  std::vector<std::string> sbatch, setup;
  bool submit = false, follow = false, json = false;
  int retries = 3;
  double every_s = 20;
};

// Of a campaign that only one program submits at a time: on the file that is never replaced. Where the file system has no
// locks, none is there.
class CampaignLock {
 public:
  explicit CampaignLock(const Campaign& campaign)
      : file_(open(Submissions::file_of(campaign).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (file_ < 0 || flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    close(file_);
    throw UsageError(
        fmt::format("{}: another jnd cluster submits or follows this campaign just now", campaign.folder().string()));
  }
  ~CampaignLock() {
    if (file_ >= 0) close(file_);
  }
  CampaignLock(const CampaignLock&) = delete;
  CampaignLock& operator=(const CampaignLock&) = delete;

 private:
  int file_;
};

CampaignSettings settings_from(const ClusterOptions& options, CampaignSettings before) {
  const auto take = [](auto& to, const auto& given) {
    if (given) to = *given;
  };
  if (options.program && options.program->find('/') != std::string::npos)
    before.program = std::filesystem::absolute(*options.program).lexically_normal().string();
  else
    take(before.program, options.program);
  take(before.partition, options.partition);
  take(before.time, options.time);
  take(before.account, options.account);
  take(before.memory, options.memory);
  take(before.at_once, options.at_once);
  if (!options.sbatch.empty()) before.sbatch = options.sbatch;
  if (!options.setup.empty()) before.setup = options.setup;
  require_sbatch_words(before);
  return before;
}

// A mistake in the job's options would be found by every task of the cluster: so the first shard is begun here, for a
// moment. Returns the exit code of a job that is not taken, which has said why. What was begun is not kept.
std::optional<int> try_job(const ClusterOptions& options, const std::string& program, int shards) {
  constexpr std::chrono::milliseconds kTrial{1500};
  const ScratchFolder scratch("cluster");
  std::vector<std::string> command = {program};
  command.insert(command.end(), options.job.begin(), options.job.end());
  command.insert(command.end(), {"--shard", fmt::format("1/{}", shards), "--to", (scratch.path() / "1.json").string()});
  const auto end = std::chrono::steady_clock::now() + kTrial;
  try {
    const CalledProgram tried = call_program(command, std::filesystem::current_path(), [end] {
      return std::chrono::steady_clock::now() < end && !interrupt_requested();
    });
    stop_if_requested();
    const int code = tried.code.value_or(exit_code::kDone);
    if (code != exit_code::kUsage && code != exit_code::kInvalidInput) return {};
    write_message(printable_lines(tried.errors));
    return code;
  } catch (const DeviceError&) {  // it is on the cluster's machines alone
    return {};
  }
}

// The campaign that is in the folder, with the settings that are asked for now; none where there is none yet.
std::optional<Campaign> opened(const ClusterOptions& options) {
  std::optional<Campaign> campaign = Campaign::open(options.folder);
  if (!campaign) {
    if (!options.job.empty()) return {};
    throw UsageError(
        fmt::format("{}: no campaign is there yet: say what is to be run, behind --: plan PROTOCOL --power ..., or "
                    "simulate PROTOCOL --studies N ...",
                    options.folder));
  }
  if (!options.job.empty())
    campaign->require_same(Campaign::job_of(options.job, options.shards.value_or(campaign->shards())));
  else if (options.shards && *options.shards != campaign->shards())
    throw UsageError(
        fmt::format("{} is cut in {}, which cannot be changed", options.folder, counted(campaign->shards(), "shard")));
  campaign->change(settings_from(options, campaign->settings()));
  return campaign;
}

std::string state_of(const Campaign& campaign) {
  try {
    Slurm slurm(campaign.folder(), campaign.name());
    return Follower(campaign, slurm, {}).state();
  } catch (const UsageError&) {  // no Slurm is here
    return fmt::format("{} of {} there", campaign.finished().size(), counted(campaign.shards(), "shard"));
  }
}

void print_state(const Campaign& campaign) {
  const auto named = [&](const char* file) { return shell_word((campaign.folder() / file).string()); };
  const std::string folder = shell_word(campaign.folder().string());
  fmt::print("{}: {}\n", printable(campaign.folder().string()), state_of(campaign));
  if (campaign.finished().size() == static_cast<std::size_t>(campaign.shards())) {
    fmt::print("  the result:             {} combine\n", named(Campaign::kScript));
    return;
  }
  fmt::print("  with Slurm, from here:  jnd cluster {} --submit --follow\n", folder);
  fmt::print("  by hand:                cd {} && sbatch {}\n", folder, Campaign::kScript);
  fmt::print("  without a scheduler:    {}\n", named(Campaign::kLoop));
}

int submit_and_follow(const ClusterOptions& options, const Campaign& campaign) {
  if (options.json && campaign.command() != "plan")
    throw UsageError(
        fmt::format("--json is the result of plan --power; this campaign is of jnd {}", campaign.command()));
  const CampaignLock lock(campaign);
  Slurm slurm(campaign.folder(), campaign.name());
  if (options.submit) {
    const std::optional<std::size_t> submitted = submit_missing(campaign, slurm);
    if (!submitted) return interrupt_requested() ? exit_code::kInterrupted : exit_code::kProblemFound;
    if (*submitted == 0)
      print_message("{}: nothing to submit: every shard is there or in the queue\n",
                    printable(campaign.folder().string()));
  }
  if (!options.follow) return exit_code::kDone;
  FollowOptions follow{options.retries, options.every_s, {}};
  if (options.json) follow.combine.emplace_back("--json");
  return Follower(campaign, slurm, follow).follow();
}

int command_cluster(const ClusterOptions& options) {
  const HoldInterrupts hold;
  std::optional<Campaign> campaign = opened(options);
  if (!campaign) {
    CampaignSettings of_this_program;
    of_this_program.program = std::filesystem::read_symlink("/proc/self/exe").string();
    const CampaignSettings settings = settings_from(options, of_this_program);
    const CampaignJob job = Campaign::job_of(options.job, options.shards.value_or(0));
    if (const std::optional<int> code = try_job(options, settings.program, job.shards)) return *code;
    campaign = Campaign::make(options.folder, job, settings);
  }
  if (options.submit || options.follow) return submit_and_follow(options, *campaign);
  print_state(*campaign);
  return exit_code::kDone;
}

}  // namespace

void add_cluster(CommandTree& tree) {
  const auto [command, options] = tree.add(
      "cluster", "Run simulated studies on a cluster, in shards: write their job, submit it, follow it to the result",
      "jnd cluster campaign --shards 64 --time 02:00:00 --submit --follow -- plan chinello2017 --power",
      command_cluster);
  command.add_option("FOLDER", options.folder, "the campaign's folder; made where it does not exist").required();
  command.add_option(
      "JOB", options.job,
      "behind --: what to run, plan PROTOCOL --power ... or simulate PROTOCOL --studies N ...; may be left out of a campaign that "
      "is there");
  command.add_option("--shards", options.shards, "into how many parts it is cut, each a task of one processor")
      .range(1, Campaign::kMostShards);
  command.add_flag("--submit", options.submit, "submit with sbatch what is neither there nor in the queue");
  const CommandOption follow = command.add_flag(
      "--follow", options.follow,
      "show how it gets on, submit again what was lost, and print the result; Ctrl-C leaves the jobs alone");
  command.add_flag("--json", options.json, "the result, machine-readable").needs(follow);
  command
      .add_option("--retries", options.retries,
                  "how often a shard is submitted again that ends without getting on (default: 3)")
      .range(0, 100);
  command.add_option("--every", options.every_s, "seconds between two looks at the queue (default: 20)")
      .range(0.05, 3600.0);
  command.add_option("--partition", options.partition, "of the cluster");
  command.add_option("--time", options.time, "limit of one shard, such as 02:00:00");
  command.add_option("--account", options.account, "that the time is charged to");
  command.add_option("--memory", options.memory, "of one shard, such as 2G");
  command.add_option("--at-once", options.at_once, "how many shards run at a time at most").range(1, 1000);
  command.add_option("--sbatch", options.sbatch,
                     "another option of sbatch, such as --sbatch=--qos=long; may be repeated");
  command.add_option("--setup", options.setup,
                     "a line of shell before the program: 'module load gcc'; may be repeated");
  command.add_option("--program", options.program, "the jnd to run, where the cluster has another one than this");
}

}  // namespace jnd
