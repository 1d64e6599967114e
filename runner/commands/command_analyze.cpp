// jnd analyze: the registered analysis of a study, what stands beside it, and the methods in words.
#include <algorithm>
#include <filesystem>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "data/export/export_folder.h"
#include "data/export/result_columns.h"
#include "data/files/draft.h"
#include "data/files/seal.h"
#include "data/methods/methods_text.h"
#include "data/results/study_results.h"
#include "data/study/blinding.h"
#include "runner/commands/commands.h"
#include "runner/keys/interrupt.h"
#include "runner/opening/study_access.h"
#include "runner/report/blinded_files.h"
#include "runner/results/analysis_text.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

struct AnalyzeOptions {
  std::string study;
  std::optional<std::string> kind;    // real, pilot or simulated
  std::optional<std::string> by;      // nominal or delivered; without it, what the protocol registers
  std::string models = "registered";  // or "all": every model, method and correction beside the registered one
  bool cells = false;
  bool json = false;
  std::string csv;       // a folder for the results as CSV; empty: none
  bool replace = false;  // that folder, where an earlier one is there
  std::string methods;   // the file for the methods in words; empty: methods.md beside the study
  bool no_methods = false;
};

namespace fs = std::filesystem;

constexpr std::string_view kCommand = "analyze";

// The numbers come first: a file that cannot be written, or that is not to be written over, is said and does not take
// the analysis with it.
void write_methods_file(const AnalyzeOptions& options, const std::string& text) {
  const bool named = !options.methods.empty();
  const fs::path path = named ? fs::path(options.methods) : fs::path(options.study).parent_path() / "methods.md";
  try {
    Draft draft(path, Draft::What::file);
    draft.write(sealed(text, kCommand));
    draft.replace([](const fs::path& earlier) { require_sealed(earlier, kCommand); });
  } catch (const StorageError& error) {
    if (named) throw;
    write_marked_message(fmt::format("{} (--methods FILE names another place)", error.what()));
    return;
  }
  if (!options.json) fmt::print("The methods in words: {}\n", printable(path.string()));
}

void print_results(const StudyResults& results, const Protocol& protocol, const AnalyzeOptions& options) {
  // A terminal shows the end: what the study found comes last, after everything that it rests on.
  std::vector<ResultTable> tables = result_tables(results, protocol);
  std::stable_partition(tables.begin(), tables.end(), [](const ResultTable& table) { return !is_conclusion(table); });
  for (const ResultTable& table : tables)
    if (table.id != "cells" || options.cells) print_table(table);
  const auto* constant = std::get_if<ConstantResults>(&results.measured);
  if (constant != nullptr && !constant->detailed)
    fmt::print("{}\n", dim(fmt::format("Above {} participants other methods and the manner of answering are left out.",
                                       kMostInDetail)));
  print_cautions(results);
}

int analyze_blinded(const Study& study, const Protocol& protocol, const AnalyzeOptions& options) {
  const BlindedResults results =
      blinded_results(study, protocol, source_to_analyse(protocol, options.by), options.study);
  if (options.cells || options.models == "all" || !options.methods.empty())
    throw UsageError(results.line + "\n--cells, --models all and --methods name conditions: leave them out until then");
  if (!options.csv.empty()) {
    const HoldInterrupts hold;
    ExportFolder files(options.csv, options.replace);
    write_blinded_results(files, results, protocol);
    files.publish();
  }
  if (options.json) {
    fmt::print("{}\n", json_line(to_json(results, protocol)));
    return exit_code::kDone;
  }
  fmt::print("{}\n{}\n{}\n{}\n\n", bold(printable(protocol.title)),
             dim(fmt::format("protocol {}", protocol.sha256.substr(0, 12))), dim(chain_line(results.chains)),
             warn(printable(results.line)));
  if (results.participants.empty()) fmt::print("  no real session yet\n");
  for (const ResultTable& table : blinded_tables(results, protocol)) print_table(table);
  say_other_kinds(study, SessionKind::real);
  if (!options.csv.empty()) fmt::print("CSV files of these results are in {}\n", printable(options.csv));
  return exit_code::kDone;
}

int command_analyze(const AnalyzeOptions& options) {
  const std::unique_ptr<Study> study = Study::open(options.study, Study::Access::read_only);
  const Protocol protocol = protocol_of(*study);
  const SessionKind kind = kind_to_analyse(*study, options.kind);
  if (blinding_of(*study, protocol, kind).blinded) return analyze_blinded(*study, protocol, options);
  std::optional<WorkLine> working(std::in_place, "analysing " + options.study);
  const StudyResults results = results_of(*study, protocol, kind, source_to_analyse(protocol, options.by));
  working.reset();
  // Only JNDs over given levels have other models.
  const auto* constant = std::get_if<ConstantResults>(&results.measured);
  const bool all_models = options.models == "all" && constant != nullptr;
  const StudyModels models = all_models ? study_models(constant->analysis, protocol) : StudyModels{};
  const HoldInterrupts hold;
  // Its place is taken last: where something else that was asked for cannot be written, nothing stays behind.
  std::optional<ExportFolder> csv;
  if (!options.csv.empty()) {
    csv.emplace(options.csv, options.replace);
    write_results(*csv, results, protocol, all_models ? &models : nullptr);
    csv->finish();
  }

  if (options.json) {
    nlohmann::ordered_json out = to_json(results, protocol);
    if (all_models) out["models"] = to_json(models, protocol);
    fmt::print("{}\n", json_line(out));
  } else {
    fmt::print("{}\n{}\n{}\n\n", bold(printable(protocol.title)),
               dim(fmt::format("protocol {}, seed {}", protocol.sha256.substr(0, 12),
                               seed_text(*study, protocol, "sealed while real sessions are blinded"))),
               dim(chain_line(results.chains)));
    if (attendance_of(results).participants == 0) {
      fmt::print("  no {} session yet\n", to_string(kind));
    } else {
      if (all_models) print_table(models_table(models, protocol));
      print_results(results, protocol, options);
      say_other_kinds(*study, kind);
    }
  }
  if (attendance_of(results).participants > 0 && !options.no_methods)
    write_methods_file(options, methods_text(*study, protocol, results));
  if (csv) {
    csv->publish();
    if (!options.json) fmt::print("CSV files of these results are in {}\n", printable(options.csv));
  }
  return exit_code::kDone;
}

}  // namespace

void add_analyze(CommandTree& tree) {
  const auto [command, options] = tree.add("analyze", "d', JND and Weber fractions by the registered plan",
                                           "jnd analyze s.sqlite", command_analyze);
  command.add_option("STUDY", options.study, "the study's file")->required();
  add_kind_and_by(command, options.kind, options.by);
  command.add_option("--models", options.models, "registered (default), or all: every model beside it")
      ->check(CLI::IsMember({"registered", "all"}));
  command.add_flag("--cells", options.cells, "also every cell: counts, rates, z and d'");
  command.add_option("--csv", options.csv, "also the results as CSV files in this folder");
  command.add_flag("--replace", options.replace, "replace the CSV folder of an earlier analysis");
  command.add_option("--methods", options.methods,
                     "the file for the methods in words (default: methods.md beside the study)");
  command.add_flag("--no-methods", options.no_methods, "write no methods file");
  command.add_flag("--json", options.json, "machine-readable");
}

}  // namespace jnd
