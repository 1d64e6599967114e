// jnd analyze: the registered analysis of a study, what stands beside it, and the methods in words.
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "data/blocks/result_blocks.h"
#include "data/export/export_folder.h"
#include "data/export/result_files.h"
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
#include "runner/results/result_format.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/other_programs.h"
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

// Where the rest is.
std::string rest_text(const std::vector<Block>& blocks, const std::string& study) {
  std::string options;
  for (const SectionOption& one : kSections)
    if (std::any_of(blocks.begin(), blocks.end(),
                    [&](const Block& block) { return block.section == one.section && !block.columns.empty(); }))
      options += fmt::format("{}, ", one.option);
  return paragraph(fmt::format("More: {}or --all", options)) +
         fmt::format("As a page: jnd report {}\n", shell_word(study));
}

std::string results_text(const StudyResults& results, const std::vector<Block>& blocks, const Protocol& protocol,
                         const AnalyzeOptions& options) {
  std::string text = answer_text(results, blocks, protocol) + cautions_text(results);
  if (results.task.outcomes.empty() && !options.all) return text;  // free interaction is answered by all there is
  bool shown = false;
  for (const SectionOption& one : kSections) {
    if (!options.shows(one.section)) continue;
    bool any = false;
    for (const Block& block : blocks) {
      if (block.section != one.section) continue;
      const ResultTable table = table_of(block);
      if (table.rows.empty()) continue;
      text += text_of(table);
      shown = any = true;
    }
    if (!any && options.sections[static_cast<std::size_t>(one.section)])
      text += paragraph(fmt::format("There is nothing for {} in this study.", one.option)) + "\n";
  }
  if (!results.detailed && (options.shows(Section::models) || options.shows(Section::behaviour)))
    text += dim(
        fmt::format("Above {} participants other methods and the manner of answering are left out.\n", kMostInDetail));
  return shown ? text : text + rest_text(blocks, options.study);
}

constexpr int kNotStarted = 126, kNotFound = 127;  // what a shell ends with where it could not run the command

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string() : value;
}

// Empty for none.
std::string pager() {
  for (const char* const name : {"JND_PAGER", "PAGER"})
    if (std::getenv(name) != nullptr) return environment(name) == "cat" ? std::string() : environment(name);
  return is_on_path("less") ? "less" : "";
}

bool longer_than_terminal(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n') >= terminal_rows();
}

// While one lives, Ctrl-C is the pager's, and a pager that has ended is no signal.
class LeaveSignalsToPager {
 public:
  LeaveSignalsToPager() {
    struct sigaction ignored {};
    ignored.sa_handler = SIG_IGN;
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &ignored, &before_[i]);
  }
  ~LeaveSignalsToPager() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before_[i], nullptr);
  }
  LeaveSignalsToPager(const LeaveSignalsToPager&) = delete;
  LeaveSignalsToPager& operator=(const LeaveSignalsToPager&) = delete;

 private:
  static constexpr std::array kSignals = {SIGPIPE, SIGINT};
  std::array<struct sigaction, kSignals.size()> before_{};
};

// False where it was not shown.
bool shown_by(const std::string& command, const std::string& text) {
  std::fflush(stdout);
  // For a less that the user names: with colours, and gone by itself where all fits.
  constexpr int kUnlessSet = 0;
  setenv("LESS", "FRX", kUnlessSet);
  // The user's own command, as git and man run it.
  std::FILE* const pipe = popen(command.c_str(), "w");  // NOLINT(cert-env33-c)
  if (pipe == nullptr) return false;
  const LeaveSignalsToPager signals;  // from here on: the pager itself obeys them
  std::fwrite(text.data(), 1, text.size(), pipe);
  const int status = pclose(pipe);
  return !(WIFEXITED(status) && (WEXITSTATUS(status) == kNotFound || WEXITSTATUS(status) == kNotStarted));
}

// Prints the text on standard output. Where that is a terminal with fewer lines than the text, through $JND_PAGER, else
// $PAGER, else less where it is installed ("cat" or an empty name: none). A reader who leaves the pager early
// misses the rest; a pager that cannot be started is done without.
void print_paged(const std::string& text) {
  if (is_terminal(STDOUT_FILENO) && longer_than_terminal(text))
    if (const std::string command = pager(); !command.empty() && shown_by(command, text)) return;
  fmt::print("{}", text);
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
  for (const Block& block : blinded_blocks(results, protocol))
    if (block.rows() > 0) text += text_of(table_of(block));
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
  // The model is fitted for whoever shows it.
  const bool model =
      options.json || !options.csv.empty() || options.shows(Section::participants) || options.shows(Section::tests);
  const StudyResults results =
      results_of(*study, protocol, kind, {.by = source_to_analyse(protocol, options.by), .hierarchical = model});
  // Only JNDs of pairs have other models.
  const StudyModels models = options.shows(Section::models) ? study_models(results.task, protocol) : StudyModels{};
  const std::vector<Block> blocks = result_blocks(results, protocol, &models);
  working.reset();
  if (options.by && results.task.cells.empty())
    write_marked_message("--by makes no difference here: this study has no fit over stiffness differences");
  const HoldInterrupts hold;
  // Its place is taken last: where something else that was asked for cannot be written, nothing stays behind.
  std::optional<ExportFolder> csv;
  if (!options.csv.empty()) {
    csv.emplace(options.csv, options.replace);
    write_results(*csv, blocks, protocol, fmt::format("results of {} data", to_string(kind)));
    csv->finish();
  }

  const bool methods = !options.methods.empty() && results.attendance.participants > 0;
  if (methods) write_methods_file(options.methods, methods_text(*study, protocol, results));
  if (csv) csv->publish();
  if (options.json) {
    fmt::print("{}\n", json_line(to_json(results, blocks, protocol)));
    return exit_code::kDone;
  }
  std::string text = head_text(*study, results, protocol);
  text += results.attendance.participants == 0 ? fmt::format("  no {} session yet\n", to_string(kind))
                                               : results_text(results, blocks, protocol, options);
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
