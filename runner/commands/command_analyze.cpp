// jnd analyze: the registered analysis of a study, what stands beside it, and the methods in words.
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

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
#include "runner/results/answer_tables.h"
#include "runner/results/result_format.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/pager.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

// In the order in which they are printed.
struct SectionOption {
  Section section;
  const char* option;
  const char* what;
};
constexpr std::array<SectionOption, 6> kSections = {
    {{Section::participants, "--participants", "every participant with intervals, and all means of the group"},
     {Section::tests, "--tests", "contrasts on every scale, tests over all conditions, pairs, series, groups"},
     {Section::models, "--models", "other models, methods and corrections: would one change the conclusion?"},
     {Section::behaviour, "--behaviour", "order of intervals, bias, drift, cues, sureness"},
     {Section::questions, "--questions", "answers to the questions, and their tests"},
     {Section::cells, "--cells", "every count, rate, z and d'"}}};

struct AnalyzeOptions {
  std::string study;
  std::optional<std::string> kind;  // real, pilot or simulated
  std::optional<std::string> by;    // nominal or delivered; without it, what the protocol registers
  // What is shown behind the answer; by Section.
  std::array<bool, kSections.size()> sections{};
  bool all = false;
  bool json = false;
  std::string csv;       // a folder for the results as CSV; empty: none
  bool replace = false;  // that folder, where an earlier one is there
  std::string methods;   // the file for the methods in words; empty: none
  std::string word;      // "all", behind --models
  bool no_methods = false;

  bool shows(Section section) const { return all || sections[static_cast<std::size_t>(section)]; }
};

namespace fs = std::filesystem;

constexpr std::string_view kCommand = "analyze";

// An edited file is not written over.
void write_methods_file(const std::string& file, const std::string& text) {
  Draft draft(file, Draft::What::file);
  draft.write(sealed(text, kCommand));
  draft.replace([](const fs::path& earlier) { require_sealed(earlier, kCommand); });
}

std::string head_text(const Study& study, const StudyResults& results, const Protocol& protocol) {
  const std::string origin =
      fmt::format("{}; protocol {}, seed {}", who_took_part(results, protocol), protocol.sha256.substr(0, 12),
                  seed_text(study, protocol, "sealed while real sessions are blinded"));
  std::string conditions;
  for (const Condition& condition : protocol.conditions)
    if (const std::string title = condition_title(condition); title != condition.name)
      conditions += (conditions.empty() ? "" : "; ") + title;
  return paragraph(protocol.title, "", bold) + paragraph(origin, "", dim) +
         (conditions.empty() ? "" : paragraph(conditions, "", dim)) + "\n";
}

// Where the rest is. tables: all that there are.
std::string rest_text(const std::vector<ResultTable>& tables, const std::string& study) {
  std::string options;
  for (const SectionOption& one : kSections)
    if (std::any_of(tables.begin(), tables.end(),
                    [&](const ResultTable& table) { return section_of(table) == one.section; }))
      options += fmt::format("{}, ", one.option);
  return paragraph(fmt::format("More: {}or --all", options)) +
         fmt::format("As a page: jnd report {}\n", shell_word(study));
}

std::string results_text(const StudyResults& results, const Protocol& protocol, const std::vector<ResultTable>& models,
                         const AnalyzeOptions& options) {
  std::vector<ResultTable> tables = result_tables(results, protocol);
  std::string text = answer_text(results, protocol) + cautions_text(results);
  // A study of free interaction is answered by all that there is to show.
  const bool explored = std::holds_alternative<ExplorationResults>(results.measured);
  const std::string rest = explored ? "" : rest_text(tables, options.study);
  tables.insert(tables.end(), models.begin(), models.end());
  bool shown = false;
  for (const SectionOption& one : kSections) {
    bool any = false;
    for (const ResultTable& table : tables) {
      if (explored || section_of(table) != one.section || !options.shows(one.section)) continue;
      text += text_of(table);
      shown = any = true;
    }
    if (!any && !explored && options.sections[static_cast<std::size_t>(one.section)])
      text += paragraph(fmt::format("There is nothing for {} in this study.", one.option)) + "\n";
  }
  const auto* constant = std::get_if<ConstantResults>(&results.measured);
  if (constant != nullptr && !constant->detailed &&
      (options.shows(Section::models) || options.shows(Section::behaviour)))
    text += dim(
        fmt::format("Above {} participants other methods and the manner of answering are left out.\n", kMostInDetail));
  return shown ? text : text + rest;
}

int analyze_blinded(const Study& study, const Protocol& protocol, SessionKind kind, const AnalyzeOptions& options) {
  const BlindedResults results =
      blinded_results(study, protocol, kind, source_to_analyse(protocol, options.by), options.study);
  if (options.all || options.sections != AnalyzeOptions().sections || !options.methods.empty())
    throw UsageError(results.line +
                     "\n--all, --cells, --tests and their like, and --methods, name conditions: leave them out until "
                     "then");
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
  std::string text = paragraph(protocol.title, "", bold) +
                     dim(fmt::format("protocol {}", protocol.sha256.substr(0, 12))) + "\n\n" +
                     warn(printable(results.line)) + "\n\n";  // it ends with a command, in one line
  if (results.participants.empty()) text += fmt::format("  no {} session yet\n", to_string(kind));
  for (const ResultTable& table : blinded_tables(results, protocol)) text += text_of(table);
  print_paged(text + paragraph(chain_line(results.chains), "", dim));
  say_other_kinds(study, kind);
  if (!options.csv.empty()) fmt::print("CSV files of these results are in {}\n", printable(options.csv));
  return exit_code::kDone;
}

int command_analyze(const AnalyzeOptions& options) {
  if (!options.word.empty() && options.word != "all")
    throw UsageError(fmt::format("analyze takes one study at a time: {} is one too many", options.word));
  const std::unique_ptr<Study> study = Study::open(options.study, Study::Access::read_only);
  const Protocol protocol = protocol_of(*study);
  const SessionKind kind = kind_to_analyse(*study, options.kind);
  if (blinding_of(*study, protocol, kind).blinded) return analyze_blinded(*study, protocol, kind, options);
  std::optional<WorkLine> working(std::in_place, "analysing " + options.study);
  StudyResults results = results_of(*study, protocol, kind, source_to_analyse(protocol, options.by));
  if (options.json || !options.csv.empty() || options.shows(Section::participants) || options.shows(Section::tests))
    add_hierarchical(results, protocol);
  working.reset();
  if (options.by && !std::holds_alternative<ConstantResults>(results.measured))
    write_marked_message("--by makes no difference here: this study has no fit over stiffness differences");
  // Only JNDs over given levels have other models.
  const auto* constant = std::get_if<ConstantResults>(&results.measured);
  const bool all_models = options.shows(Section::models) && constant != nullptr;
  const StudyModels models = all_models ? study_models(constant->analysis, protocol) : StudyModels{};
  const HoldInterrupts hold;
  // Its place is taken last: where something else that was asked for cannot be written, nothing stays behind.
  std::optional<ExportFolder> csv;
  if (!options.csv.empty()) {
    csv.emplace(options.csv, options.replace);
    write_results(*csv, results, protocol, all_models ? &models : nullptr);
    csv->finish();
  }

  const bool methods = !options.methods.empty() && attendance_of(results).participants > 0;
  if (methods) write_methods_file(options.methods, methods_text(*study, protocol, results));
  if (csv) csv->publish();
  if (options.json) {
    nlohmann::ordered_json out = to_json(results, protocol);
    if (all_models) out["models"] = to_json(models, protocol);
    fmt::print("{}\n", json_line(out));
    return exit_code::kDone;
  }
  std::string text = head_text(*study, results, protocol);
  if (attendance_of(results).participants == 0)
    text += fmt::format("  no {} session yet\n", to_string(kind));
  else
    text +=
        results_text(results, protocol,
                     all_models ? std::vector{models_table(models, protocol)} : std::vector<ResultTable>(), options);
  text += paragraph(chain_line(results.chains), "", dim);
  print_paged(text);
  say_other_kinds(*study, kind);
  if (methods) fmt::print("The methods in words: {}\n", printable(options.methods));
  if (!options.csv.empty()) fmt::print("CSV files of these results are in {}\n", printable(options.csv));
  return exit_code::kDone;
}

}  // namespace

void add_analyze(CommandTree& tree) {
  const auto [command, options] = tree.add("analyze", "d', JND and Weber fractions by the registered plan",
                                           "jnd analyze s.sqlite", command_analyze);
  command.add_option("STUDY", options.study, "the study's file").required();
  add_kind_and_by(command, options.kind, options.by);
  for (const SectionOption& one : kSections)
    command.add_flag(one.option, options.sections[static_cast<std::size_t>(one.section)], one.what);
  command.add_flag("--all", options.all, "all of these");
  command.add_option("--csv", options.csv, "also the results as CSV files in this folder");
  command.add_flag("--replace", options.replace, "replace the CSV folder of an earlier analysis");
  command.add_option("--methods", options.methods, "also the methods in words, as Markdown, in this file");
  command.add_flag("--json", options.json, "machine-readable");
  // Scripts of before: nothing is written unasked any more, and --models needs no word.
  command.add_flag("--no-methods", options.no_methods, "").hidden();
  command.add_option("WORD", options.word, "").hidden();
}

}  // namespace jnd
