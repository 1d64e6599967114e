// The scripts in a campaign's folder: one for a scheduler, which also runs a shard by hand and combines them, and a loop for
// where there is no scheduler.
#pragma once

#include <string>
#include <vector>

#include "runner/cluster/campaign.h"

namespace jnd {

struct JobScript {
  std::string name;  // of the jobs
  int shards = 0;
  std::vector<std::string> command;  // of jnd: its name, the protocol, its other arguments
  std::vector<CampaignFile> hashes;  // of what it reads; bytes: SHA-256 of them
  CampaignSettings settings;
};

std::string job_script(const JobScript& script);
std::string loop_script(int shards);

// Throws UsageError where a setting cannot stand in the script: #SBATCH lines know no quoting that could be relied on.
void require_sbatch_words(const CampaignSettings& settings);

}  // namespace jnd
