#include "runner/cluster/slurm.h"

#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocols/input/number_from.h"
#include "runner/cluster/called_program.h"
#include "runner/cluster/campaign.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/other_programs.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

std::vector<std::string> parts_of(const std::string& line, char mark, std::size_t most) {
  std::vector<std::string> parts;
  std::size_t at = 0;
  while (parts.size() + 1 < most) {
    const std::size_t found = line.find(mark, at);
    if (found == std::string::npos) break;
    parts.push_back(line.substr(at, found - at));
    at = found + 1;
  }
  parts.push_back(line.substr(at));
  return parts;
}

bool while_not_interrupted() {
  return !interrupt_requested();
}

}  // namespace

Slurm::Slurm(std::filesystem::path folder, std::string name) : folder_(std::move(folder)), name_(std::move(name)) {
  for (const char* const program : {"sbatch", "squeue"})
    if (!is_on_path(program))
      throw UsageError(fmt::format(
          "{} is not found: there is no Slurm on this machine. Run this on the cluster's login node, load its module if it "
          "has one, or do without a scheduler: {}",
          program, shell_quoted((folder_ / Campaign::kLoop).string())));
}

std::optional<std::int64_t> Slurm::submit(const std::set<int>& shards, int at_once) {
  std::string array = ranges_text(shards);
  if (at_once > 0) array += fmt::format("%{}", at_once);
  // Never ended in the middle: it would not be known whether the job is in.
  const CalledProgram sbatch =
      call_program({"sbatch", "--parsable", "--array=" + array, Campaign::kScript}, folder_, [] { return true; });
  const auto job = number_from<std::int64_t>(sbatch.output.substr(0, sbatch.output.find_first_of(";\n")));
  trouble_ = sbatch.done && job ? "" : sbatch.trouble();
  return sbatch.done ? job : std::nullopt;
}

std::optional<std::vector<QueueTask>> Slurm::queue() {
  const CalledProgram squeue = call_program(
      {"squeue", "--noheader", "--array", "--all", "--states=all", "--name=" + name_, "--format=%F|%K|%T|%r"}, folder_,
      while_not_interrupted);
  trouble_ = squeue.done ? "" : squeue.trouble();
  if (!squeue.done) return {};
  return tasks_in(squeue.output);
}

std::string Slurm::accounts(const std::set<std::int64_t>& jobs) {
  if (!accounting_ || jobs.empty() || !is_on_path("sacct")) return "";
  const CalledProgram sacct =
      call_program({"sacct", "--noheader", "--allocations", "--parsable2", "--format=JobID,State,ExitCode",
                    fmt::format("--jobs={}", fmt::join(jobs, ","))},
                   folder_, while_not_interrupted);
  // Where there is no accounting it will not come.
  if (!sacct.done && while_not_interrupted()) accounting_ = false;
  return sacct.done ? sacct.output : "";
}

std::vector<QueueTask> Slurm::tasks_in(std::string_view lines) {
  std::vector<QueueTask> tasks;
  std::istringstream stream{std::string(lines)};
  for (std::string line; std::getline(stream, line);) {
    const std::vector<std::string> parts = parts_of(line, '|', 4);
    if (parts.size() != 4) continue;
    const auto job = number_from<std::int64_t>(parts[0]);
    const auto shard = number_from<int>(parts[1]);
    if (job && shard) tasks.push_back({*job, *shard, parts[2], parts[3]});
  }
  return tasks;
}

std::string Slurm::ending_in(std::string_view lines, std::int64_t job, int shard) {
  std::string ending;
  std::istringstream stream{std::string(lines)};
  for (std::string line; std::getline(stream, line);) {
    const std::vector<std::string> parts = parts_of(line, '|', 3);
    if (parts.size() != 3 || parts[0] != fmt::format("{}_{}", job, shard)) continue;
    ending = parts[1];
    const std::vector<std::string> code = parts_of(parts[2], ':', 2);
    if (code.size() == 2 && code[1] != "0") ending += ", signal " + code[1];
    if (code.size() == 2 && code[1] == "0" && code[0] != "0") ending += ", exit code " + code[0];
  }
  return ending;
}

}  // namespace jnd
