// Many simulated studies that are cut in shards, in a folder of their own: what they are, what they were copied from, and
// how a cluster is to run them. The folder needs nothing else but the program, so that it may be moved as it is.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace jnd {

// A file that was copied into the folder.
struct CampaignFile {
  std::string name;  // relative to the folder
  std::string bytes;
};

// What makes a campaign this one: it cannot be changed.
struct CampaignJob {
  int shards = 0;
  std::string command;                 // "plan", "simulate"
  std::vector<std::string> arguments;  // of the command, behind the protocol
  std::vector<CampaignFile> files;     // the protocol first, under its own name: results tell it
};

// How it is run: may be changed at any time. Empty and 0: as the cluster has it.
struct CampaignSettings {
  std::string program;  // which jnd
  std::string partition, time, account, memory;
  int at_once = 0;
  std::vector<std::string> sbatch;  // more options of sbatch, each with its value: "--qos=long"
  std::vector<std::string> setup;   // lines of shell before the program: "module load gcc"

  bool operator==(const CampaignSettings&) const = default;
};

class Campaign {
 public:
  static constexpr const char* kScript = "job.sh";  // the names in the folder
  static constexpr const char* kLoop = "loop.sh";
  static constexpr int kMostShards = 1000;  // an array of Slurm, as it ships

  // The job of the words behind "--": plan PROTOCOL --power ..., or simulate PROTOCOL --studies ... . What they and the
  // protocol name with a relative path is read too, for the folder. Throws UsageError and InputError.
  static CampaignJob job_of(const std::vector<std::string>& words, int shards);

  // Makes the folder. Throws StorageError, and UsageError where something else stands there.
  static Campaign make(const std::filesystem::path& folder, const CampaignJob& job, const CampaignSettings& settings);
  // None where the folder does not exist or is empty. Throws UsageError where it is no campaign's, InputError where what
  // says so is damaged.
  static std::optional<Campaign> open(const std::filesystem::path& folder);

  // Throws UsageError, which says the first difference, unless the job is this campaign's.
  void require_same(const CampaignJob& job) const;
  // Writes the scripts anew where the settings differ. Throws UsageError where job.sh was changed by hand.
  void change(const CampaignSettings& settings);

  const std::filesystem::path& folder() const noexcept { return folder_; }  // absolute
  const std::string& name() const noexcept { return name_; }                // of its jobs; no other campaign has it
  int shards() const noexcept { return shards_; }
  const std::string& command() const noexcept { return command_; }
  const CampaignSettings& settings() const noexcept { return settings_; }

  std::filesystem::path shard_file(int shard) const;  // which is whole where it exists
  std::set<int> finished() const;                     // shards whose file is there
  // When a shard last put down what it has done, which it does only with more: ns since 1970; 0 where it is not begun.
  std::uintmax_t progress(int shard) const;
  // The last lines of the newest log of a shard, with the log's name before; empty where there is none.
  std::string log_tail(int shard, int lines) const;

 private:
  Campaign() = default;
  std::string text() const;
  std::string script() const;
  void write_scripts() const;
  void make_rooms() const;

  std::filesystem::path folder_;
  std::string name_;
  int shards_ = 0;
  std::string command_;
  std::vector<std::string> arguments_;
  std::vector<CampaignFile> hashes_;  // bytes: SHA-256 of them
  CampaignSettings settings_;
};

}  // namespace jnd
