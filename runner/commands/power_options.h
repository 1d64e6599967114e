// `jnd plan --power`: how often a study will find what is there, by simulating it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runner/commands/precision_options.h"
#include "runner/commands/shard_options.h"
#include "runner/power/power_result.h"

namespace jnd {

// Files that a result of a power study is also written to; empty: none.
struct PowerFiles {
  std::string csv, ademp, figure;
};
// csv: what --csv does.
void add_power_files(const Command& command, PowerFiles& files, const std::string& csv);
// Throws InputError where one of them is there already.
void refuse_existing(const PowerFiles& files);
// Writes the files and prints the result.
void give_power_result(const PowerResult& result, const PowerFiles& files, bool json);

struct PowerOptions {
  bool asked = false;                      // --power
  std::vector<double> effects;             // else 0 and 1
  std::vector<std::string> group_factors;  // "patients=1.4", "patients/V=1.4"
  std::vector<std::string> analyses;       // else registered and hierarchical, as far as there are
  std::optional<double> interaction_cv, criterion, criterion_sd;
  double lapses = 0, drop_out = 0;
  int studies = 1000;
  double wanted = 0.8;
  bool physics = false;
  std::string profile;  // empty: what fits
  int threads = 0;      // 0: as many as the machine has processors
  ShardOptions shard;
  PowerFiles files;
};
// Adds the options to `jnd plan`.
void add_power_options(const Command& plan, PowerOptions& options);

// name: a protocol's file, or the name of a shipped one. Returns the exit code. Throws UsageError where the options do
// not fit the protocol, or one another.
int plan_power(const std::string& name, std::uint64_t seed, bool json, const PrecisionOptions& precision,
               const PowerOptions& options);

}  // namespace jnd
