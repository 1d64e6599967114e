#include "runner/cluster/job_script.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include <fmt/format.h>

#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

constexpr std::string_view kPlainMarks = "_.,:@%+=/-&|[]*()";

constexpr std::string_view kHead = R"sh(#!/bin/bash
# One shard of @SHARDS@ of many simulated studies. Written by jnd cluster, which writes it anew for other settings.
#
#   with Slurm, all shards          cd into this folder, then:  sbatch job.sh
#   one shard, here                 ./job.sh 3
#   without a scheduler             ./loop.sh, or with GNU parallel:  seq @SHARDS@ | parallel ./job.sh
#   the result, when all are there  ./job.sh combine    (behind it options of jnd combine)
#
# A shard that is there stays; one that was stopped goes on where it was. This folder may be moved to another machine as it
# is; only the program below has to be there.
#SBATCH --job-name=@NAME@
#SBATCH --array=1-@ARRAY@
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --output=logs/%A_%a.log
#SBATCH --open-mode=append
#SBATCH --requeue
)sh";

constexpr std::string_view kFolder = R"sh(
if [ $# -eq 0 ] && [ -n "$SLURM_ARRAY_TASK_ID" ]; then
  set -- "$SLURM_ARRAY_TASK_ID"
  folder=$SLURM_SUBMIT_DIR  # what Slurm runs is a copy of this file, in another place
else
  folder=$(dirname -- "$0")
fi
here=$PWD
cd -- "$folder" || exit
if [ ! -f campaign.json ]; then
  echo "job.sh: $PWD is not the folder of this campaign: cd into that one, then sbatch job.sh" >&2
  exit 2
fi
if ! sha256sum --check --status 2>/dev/null <<'HASHES'
@HASHES@HASHES
then
  echo "job.sh: the protocol, or another file that was copied to $PWD, was changed since: put it back, or make a new campaign" >&2
  exit 3
fi
mkdir -p shards logs
)sh";

constexpr std::string_view kRun = R"sh(
if [ "$1" = combine ]; then
  shift@COMBINE@
  files=()
  for ((i = 1; i <= @SHARDS@; ++i)); do files+=("$PWD/shards/$i.json"); done
  cd -- "$here" && exec "$program" combine "${files[@]}" "$@"
fi
if ! [[ "$1" =~ ^[0-9]+$ ]] || [ "$1" -lt 1 ] || [ "$1" -gt @SHARDS@ ]; then
  echo "usage: ./job.sh N    a shard, 1 to @SHARDS@;  or ./job.sh combine" >&2
  exit 2
fi
echo "job.sh: shard $1 of @SHARDS@ on $(uname -n), job ${SLURM_JOB_ID:-none}"
"$program" @COMMAND@ --threads 1 --shard "$1/@SHARDS@" --to "shards/$1.json"
status=$?
[ $status -eq 0 ] || echo "job.sh: shard $1 ended with exit code $status" >&2
exit $status
)sh";

// Where the tables of simulated studies go unless something else is said.
constexpr std::string_view kTablesPlace = R"sh(
  [[ " $* " == *" --csv"* ]] || set -- --replace --csv "$PWD/tables" "$@")sh";

constexpr std::string_view kLoopText = R"sh(#!/bin/bash
# Simulated studies in @SHARDS@ shards without a scheduler: runs those that are missing, N at a time (without N: one a processor), and
# prints the result. Run again, it goes on where it was. On several machines that share this folder let each run shards of
# its own:  seq 1 2 @SHARDS@ | xargs -n 1 -P 8 ./job.sh  on one,  seq 2 2 @SHARDS@ | ...  on the other.
# Usage: ./loop.sh [N]
cd -- "$(dirname -- "$0")" || exit
mkdir -p shards logs
one() {
  [ -e "shards/$1.json" ] && return 0
  bash ./job.sh "$1" >>"logs/loop_$1.log" 2>&1 && return 0
  echo "shard $1 failed; logs/loop_$1.log ends with:" >&2
  tail -n 3 "logs/loop_$1.log" >&2
  return 1
}
export -f one
seq @SHARDS@ | xargs -P "${1:-$(nproc)}" -I '{}' bash -c 'one {}' ||
  { echo "loop.sh: not all shards are there; run it again when the cause is gone" >&2; exit 1; }
exec bash ./job.sh combine
)sh";

std::string filled_in(std::string_view text, std::string_view mark, std::string_view value) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t found = text.find(mark, at);
    out += text.substr(at, found - at);
    if (found == std::string_view::npos) break;
    out += value;
    at = found + mark.size();
  }
  return out;
}

// A line as sha256sum --check reads it.
std::string hash_line(const CampaignFile& file) {
  std::string name;
  for (const char c : file.name) name += c == '\\' ? "\\\\" : c == '\n' ? "\\n" : c == '\r' ? "\\r" : std::string(1, c);
  return fmt::format("{}{}  {}\n", name == file.name ? "" : "\\", file.bytes, name);
}

bool is_plain(std::string_view value) {
  return !value.empty() && std::all_of(value.begin(), value.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || kPlainMarks.find(c) != std::string_view::npos;
  });
}

std::string sbatch_line(std::string_view option, std::string_view value) {
  return value.empty() ? "" : fmt::format("#SBATCH --{}={}\n", option, value);
}

}  // namespace

std::string job_script(const JobScript& script) {
  const CampaignSettings& settings = script.settings;
  const std::string shards = std::to_string(script.shards);
  std::string out = filled_in(filled_in(kHead, "@SHARDS@", shards), "@NAME@", script.name);
  out = filled_in(out, "@ARRAY@", settings.at_once > 0 ? fmt::format("{}%{}", shards, settings.at_once) : shards);
  out += sbatch_line("partition", settings.partition) + sbatch_line("time", settings.time) +
         sbatch_line("account", settings.account) + sbatch_line("mem", settings.memory);
  for (const std::string& option : settings.sbatch) out += fmt::format("#SBATCH {}\n", option);
  std::string hashes;
  for (const CampaignFile& file : script.hashes) hashes += hash_line(file);
  out += fmt::format("\nprogram={}\n{}", shell_quoted(settings.program), filled_in(kFolder, "@HASHES@", hashes));
  if (!settings.setup.empty()) out += "\n";
  for (const std::string& line : settings.setup) out += line + "\n";
  std::string command;
  for (const std::string& argument : script.command) command += (command.empty() ? "" : " ") + shell_quoted(argument);
  const std::string run = filled_in(kRun, "@COMBINE@", script.command.front() == "simulate" ? kTablesPlace : "");
  return out + filled_in(filled_in(run, "@SHARDS@", shards), "@COMMAND@", command);  // last: it may hold marks
}

std::string loop_script(int shards) {
  return filled_in(kLoopText, "@SHARDS@", std::to_string(shards));
}

void require_sbatch_words(const CampaignSettings& settings) {
  const auto refuse = [](const char* option, const std::string& value) {
    throw UsageError(fmt::format("{} {}: an #SBATCH line takes letters, digits and _.,:@%+=/-&|[]*() only", option,
                                 shell_quoted(value)));
  };
  for (const auto& [option, value] : {std::pair{"--partition", &settings.partition},
                                      {"--time", &settings.time},
                                      {"--account", &settings.account},
                                      {"--memory", &settings.memory}})
    if (!value->empty() && !is_plain(*value)) refuse(option, *value);
  constexpr std::array<std::string_view, 10> kOurs = {"--array", "--output",    "--error", "--job-name", "--chdir",
                                                      "--wrap",  "--open-mode", "--input", "--parsable", "--requeue"};
  for (const std::string& option : settings.sbatch) {
    if (!option.starts_with("--") || !is_plain(option)) refuse("--sbatch", option);
    if (std::any_of(kOurs.begin(), kOurs.end(), [&option](std::string_view ours) {
          return option == ours || option.starts_with(fmt::format("{}=", ours));
        }))
      throw UsageError(fmt::format("--sbatch {}: jnd cluster sets that itself", shell_quoted(option)));
  }
}

}  // namespace jnd
