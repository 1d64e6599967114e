// jnd calc sdt: d' of counts, model by model. jnd calc coverage: how often its intervals and tests are right.
#include "runner/calc/calc_detection.h"

#include <array>
#include <cstdint>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/detection/coverage.h"
#include "runner/calc/calc.h"
#include "runner/commands/commands.h"
#include "runner/calc/csv_counts.h"
#include "protocols/input/csv_table.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/progress_bar.h"

namespace jnd {

namespace {

struct SdtOptions {
  CalcInput input;
};

// The rows of many cells: few of them have counts that no other has, and those cost a millisecond each.
class DetectionRows {
 public:
  const DetectionRow& of(const Counts& counts) {
    if (known_.size() == kMostKnown) known_.clear();
    const auto [place, added] =
        known_.try_emplace({counts.n_diff, counts.hits, counts.n_same, counts.false_alarms}, DetectionRow{});
    if (added) place->second = detection_row(counts);
    return place->second;
  }

 private:
  static constexpr std::size_t kMostKnown = 100'000;
  std::map<std::array<int, 4>, DetectionRow> known_;
};

int sdt(const SdtOptions& options) {
  const CsvTable table = CsvTable::read(options.input.file, {"id", "n_diff", "hits", "n_same", "false_alarms"});
  // The whole file is read before anything is printed: a mistake in the last row leaves no half an answer.
  std::vector<Counts> counts;
  for (std::size_t row = 0; row < table.rows(); ++row) counts.push_back(counts_of(table, row));
  std::vector<NamedDetectionRow> rows;
  DetectionRows known;
  ProgressBar progress("rows", static_cast<std::int64_t>(counts.size()));
  for (std::size_t row = 0; row < counts.size(); ++row) {
    constexpr std::size_t kRowsOfASecond = 1000;
    if (row > 0 && row % kRowsOfASecond == 0) progress.update(static_cast<std::int64_t>(row));
    const NamedDetectionRow named{std::string(table.text(row, "id")), known.of(counts[row])};
    if (options.input.json)
      fmt::print("{}\n", json_line(detection_json(named)));
    else
      rows.push_back(named);
  }
  if (!options.input.json) fmt::print("{}", detection_text(rows));
  return exit_code::kDone;
}

struct CoverageOptions {
  std::vector<int> trials = {6, 12, 24, 48, 100, 200};
  bool json = false;
};

constexpr double kDprimes[] = {0, 0.5, 1, 1.5, 2};
constexpr double kCriteria[] = {-0.5, 0, 0.5};

void print_coverage_json(const CoverageOptions& options) {
  for (const int trials : options.trials) {
    const ProfileCoverage coverage(trials);
    for (const double criterion : kCriteria) {
      const TestSizes sizes = test_sizes(trials, criterion);
      nlohmann::ordered_json line = {{"trials_a_class", trials}, {"criterion", criterion}};
      line["coverage"] = nlohmann::ordered_json::array();
      for (const double dprime : kDprimes)
        line["coverage"].push_back({{"dprime", dprime}, {"profile", coverage.at(dprime, criterion)}});
      line["test_sizes"] = {{"yes_no_05", sizes.yes_no_05},
                            {"yes_no_01", sizes.yes_no_01},
                            {"differencing_05", sizes.differencing_05},
                            {"differencing_01", sizes.differencing_01}};
      fmt::print("{}\n", json_line(line));
    }
  }
}

int coverage(const CoverageOptions& options) {
  if (options.json) {
    print_coverage_json(options);
    return exit_code::kDone;
  }
  fmt::print("Coverage of the 95 % profile-likelihood interval of the yes-no d', in percent:\n\n");
  fmt::print("| trials a class | c | d' = 0 | 0.5 | 1 | 1.5 | 2 |\n|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const int trials : options.trials) {
    const ProfileCoverage coverage(trials);
    for (const double criterion : kCriteria) {
      fmt::print("| {} | {} |", trials, criterion);
      for (const double dprime : kDprimes) fmt::print(" {:.1f} |", 100 * coverage.at(dprime, criterion));
      fmt::print("\n");
    }
  }
  fmt::print("\nSize of the tests of d' = 0, in percent of experiments that have p <= 5 % and p <= 1 %:\n\n");
  fmt::print("| trials a class | c | yes-no 5 % | yes-no 1 % | differencing 5 % | differencing 1 % |\n");
  fmt::print("|---:|---:|---:|---:|---:|---:|\n");
  for (const int trials : options.trials)
    for (const double criterion : kCriteria) {
      const TestSizes sizes = test_sizes(trials, criterion);
      fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", trials, criterion, 100 * sizes.yes_no_05,
                 100 * sizes.yes_no_01, 100 * sizes.differencing_05, 100 * sizes.differencing_01);
    }
  return exit_code::kDone;
}

}  // namespace

void add_calc_detection(CalcTree& tree) {
  const auto sdt_options = std::make_shared<SdtOptions>();
  CLI::App* command = tree.add("sdt", "d' of same-different counts, under every model and correction",
                               "sdt counts.csv --json", sdt_options, sdt);
  CalcTree::add_input(*command, sdt_options->input, "id, n_diff, hits, n_same, false_alarms");

  const auto coverage_options = std::make_shared<CoverageOptions>();
  command = tree.add("coverage", "How often the intervals and tests of sdt are right, by exact enumeration",
                     "coverage --trials 12,48", coverage_options, coverage);
  command->add_option("--trials", coverage_options->trials, "trials a class, each 1..500")
      ->delimiter(',')
      ->check(CLI::Range(1, 500))
      ->capture_default_str();
  command->add_flag("--json", coverage_options->json, "machine-readable, a line per number of trials and criterion");
}

}  // namespace jnd
