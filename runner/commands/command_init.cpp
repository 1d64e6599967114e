// jnd init: asks what a protocol is to be, and writes it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/look_alikes.h"
#include "protocols/input/number_from.h"
#include "protocols/tasks/task.h"
#include "runner/commands/commands.h"
#include "runner/commands/new_protocol.h"
#include "runner/commands/starting_protocol.h"
#include "runner/keys/interrupt.h"
#include "runner/opening/protocol_fitness.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, at);) parts.emplace_back(without_blanks(part));
  return parts;
}

std::optional<double> finite_from(const std::string& text) {
  const std::optional<double> value = number_from<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<int> whole_from(const std::string& text) {
  const std::optional<double> value = finite_from(text);
  constexpr double kMost = 1e6;
  if (!value || *value < 1 || *value > kMost || std::trunc(*value) != *value) return std::nullopt;
  return static_cast<int>(*value);
}

std::string numbers_text(const std::vector<double>& values) {
  std::vector<std::string> words;
  words.reserve(values.size());
  for (const double value : values) words.push_back(plain(value));
  return fmt::format("{}", fmt::join(words, ", "));
}

// "'wich' is not one of them; did you mean 'which'?"
std::string none_of_them(const std::string& answer, const std::vector<std::string>& words) {
  return fmt::format("'{}' is not one of them{}", answer, did_you_mean(answer, words));
}

bool among(const std::string& word, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void print_choices(const std::vector<std::pair<std::string, std::string>>& choices) {
  std::size_t width = 0;
  for (const auto& [word, what] : choices) width = std::max(width, word.size());
  for (const auto& [word, what] : choices) fmt::print("  {:<{}}  {}\n", word, width, what);
}

std::vector<std::string> words_in(const std::vector<std::pair<std::string, std::string>>& choices) {
  std::vector<std::string> words;
  for (const auto& [word, what] : choices) words.push_back(word);
  return words;
}

std::string what_procedure_does(const std::string& word) {
  if (word == "constant") return "the protocol sets the levels, as many trials of each";
  if (word == "staircase") return "up after wrong answers, down after right ones";
  if (word == "quest") return "each level where QUEST expects the threshold";
  return "each level where the answer will tell most about the JND";
}

// "F+V" of force and vibration: conditions are named by their cues.
StartingPoint::Condition condition_of(const std::vector<std::string>& cues) {
  StartingPoint::Condition condition;
  condition.cues = cues;
  for (const std::string& cue : cues) {
    condition.name +=
        (condition.name.empty() ? "" : "+") + std::string(1, static_cast<char>(std::toupper(cue.front())));
    condition.label += (condition.label.empty() ? "" : " and ") + cue;
  }
  return condition;
}

// What a protocol is to be, one thing after the other. Each answer is tried at once, in the protocol as it would be, so
// that a mistake is told where it is made.
class ProtocolWizard {
 public:
  // answers: lines of a person or of a pipe. Questions go to standard output.
  explicit ProtocolWizard(std::istream& answers) : answers_(answers) {}

  // What is still to be chosen of the file's name; given: as the command line has it, or empty.
  std::filesystem::path ask_file(const std::string& given) {
    std::filesystem::path file;
    const auto take = [&file](const std::string& answer) -> std::string {
      file = protocol_file(answer);
      std::error_code error;
      if (std::filesystem::exists(file, error))
        return fmt::format("{} exists already; choose another name", file.string());
      const std::filesystem::path folder = file.parent_path();
      if (!folder.empty() && !std::filesystem::is_directory(folder, error))
        return fmt::format("there is no folder {}", folder.string());
      return "";
    };
    if (!given.empty()) {
      if (const std::string complaint = take(given); !complaint.empty()) throw UsageError(complaint);
      return file;
    }
    ask_for("File to write", "my-study.json", take);
    return file;
  }

  // Throws UsageError where the answers end before the questions do.
  StartingPoint ask() {
    ask_task();
    if (task_of(point_.task).has_trials()) {
      ask_rig();
      ask_procedure();
      ask_stimulus();
      ask_levels();
      ask_conditions();
    }
    ask_participants();
    ask_ratings();
    ask_texts();
    fmt::print("\n");
    return point_;
  }

 private:
  // Takes an answer, and returns why it cannot be taken; empty: it was.
  using Taker = std::function<std::string(const std::string&)>;
  using Choices = std::vector<std::pair<std::string, std::string>>;  // words, and what each means
  // Asks until the answer is taken. fallback: what Enter takes.
  void ask_for(const std::string& what, const std::string& fallback, const Taker& take) {
    for (;;) {
      fmt::print("{} [{}]: ", what, printable(fallback));
      std::fflush(stdout);
      const std::string given = line();
      const std::string complaint = take(given.empty() ? fallback : given);
      if (complaint.empty()) return;
      fmt::print("  {}\n", warn(printable(complaint)));
    }
  }

  // One of the words, with which change is made.
  void ask_choice(const char* heading, const std::string& what, const std::string& fallback, const Choices& choices,
                  const std::function<void(StartingPoint&, const std::string&)>& change) {
    fmt::print("\n{}\n", heading);
    print_choices(choices);
    ask_for(what, fallback, [&](const std::string& answer) -> std::string {
      if (!among(answer, words_in(choices))) return none_of_them(answer, words_in(choices));
      return attempt([&](StartingPoint& point) { change(point, answer); });
    });
  }

  std::string line() {
    std::string text;
    if (!std::getline(answers_, text)) {
      fmt::print("\n");
      throw UsageError("the answers ended before all was asked; nothing was written");
    }
    return std::string(without_blanks(text));
  }

  // The point with the change, where the protocol has no mistake then.
  std::string attempt(const std::function<void(StartingPoint&)>& change) {
    StartingPoint changed = point_;
    change(changed);
    try {
      const ProtocolCheck check = check_fitness_of(readable_json(starting_protocol(changed)), "protocol");
      if (!check.errors.empty()) {
        const Diagnostic& error = check.errors.front();
        return error.message + (error.suggestion.empty() ? "" : fmt::format(" ({})", error.suggestion));
      }
    } catch (const UsageError& error) {
      return error.what();
    }
    point_ = std::move(changed);
    return "";
  }

  void ask_task() {
    Choices choices;
    for (const Task* task : all_tasks()) choices.emplace_back(to_string(task->kind()), task->summary());
    ask_choice("What does a trial ask?", "Task", "which", choices,
               [](StartingPoint& point, const std::string& answer) { point.task = *task_kind_from(answer); });
  }

  void ask_rig() {
    Choices choices;
    for (const StartingRig& rig : starting_rigs()) choices.emplace_back(rig.name, rig.what);
    ask_choice("What presents the stimuli?", "Rig", point_.rig, choices,
               [](StartingPoint& point, const std::string& answer) { point.rig = answer; });
  }

  void ask_procedure() {
    Choices choices;
    for (const std::string& word : starting_procedures(point_.task, point_.rig))
      choices.emplace_back(word, what_procedure_does(word));
    if (choices.size() < 2) return;
    ask_choice("What sets the levels?", "Procedure", point_.procedure, choices,
               [](StartingPoint& point, const std::string& answer) { point.procedure = answer; });
  }

  void ask_stimulus() {
    fmt::print("\nWhat is felt?\n");
    if (starting_cues(point_.rig).empty()) {  // a rig that takes any
      ask_for("Quantity", filled_in(point_).quantity, [this](const std::string& answer) {
        return attempt([&](StartingPoint& point) { point.quantity = answer; });
      });
      ask_for("Unit", filled_in(point_).unit, [this](const std::string& answer) {
        return attempt([&](StartingPoint& point) { point.unit = answer; });
      });
    }
    const StartingPoint filled = filled_in(point_);
    if (task_of(point_.task).has_standard())
      ask_for(fmt::format("Standard, in {}", filled.unit), plain(*filled.standard), [this](const std::string& answer) {
        const std::optional<double> value = finite_from(answer);
        if (!value) return fmt::format("'{}' is not a number", answer);
        return attempt([&](StartingPoint& point) { point.standard = *value; });
      });
  }

  void ask_levels() {
    if (point_.procedure != "constant") return;
    const StartingPoint filled = filled_in(point_);
    ask_for(fmt::format("{}, in {}, separated by commas", task_of(point_.task).start().levels_are, filled.unit),
            numbers_text(*filled.levels), [this](const std::string& answer) -> std::string {
              std::vector<double> values;
              for (const std::string& part : split(answer, ',')) {
                const std::optional<double> value = finite_from(part);
                if (!value) return fmt::format("'{}' is not a number", part);
                values.push_back(*value);
              }
              constexpr std::size_t kMostSpecimens = 11, kMostClasses = 9;  // codes, and keys, that there are
              if (point_.rig == "specimens" && values.size() > kMostSpecimens)
                return fmt::format("at most {} specimens here", kMostSpecimens);
              if (point_.task == TaskKind::identify && values.size() > kMostClasses)
                return fmt::format("at most {} classes: each has a digit as its key", kMostClasses);
              return attempt([&](StartingPoint& point) { point.levels = values; });
            });
    ask_for("Trials of each", std::to_string(*filled.trials_per_cell),
            [this](const std::string& answer) -> std::string {
              const std::optional<int> trials = whole_from(answer);
              if (!trials) return fmt::format("'{}' is not a whole number from 1", answer);
              return attempt([&](StartingPoint& point) { point.trials_per_cell = *trials; });
            });
  }

  void ask_conditions() {
    const std::vector<std::string_view> cues = starting_cues(point_.rig);
    fmt::print("\nWhat is compared within each participant?\n");
    if (cues.empty())
      fmt::print("  names, separated by commas, such as: bare, gloved\n");
    else
      fmt::print("  cues of each condition: {}; several in one with +, conditions separated by commas\n",
                 fmt::join(cues, ", "));
    ask_for("Conditions", cues.empty() ? "plain" : std::string(cues.front()),
            [&](const std::string& answer) { return take_conditions(answer, cues); });
  }

  void ask_participants() {
    fmt::print("\nWho takes part?\n");
    ask_for("Participants", std::to_string(*filled_in(point_).participants),
            [this](const std::string& answer) -> std::string {
              const std::optional<int> participants = whole_from(answer);
              if (!participants) return fmt::format("'{}' is not a whole number from 1", answer);
              return attempt([&](StartingPoint& point) { point.participants = *participants; });
            });
  }

  void ask_ratings() {
    fmt::print(
        "\nWhat is asked after the session? A question on each line, rated from 1 (not at all) to 9 (completely).\n");
    for (bool more = true; more;)
      ask_for("Question", "no more", [&](const std::string& answer) -> std::string {
        more = answer != "no more";
        return more ? attempt([&](StartingPoint& point) { point.ratings.push_back(answer); }) : "";
      });
  }

  void ask_texts() {
    fmt::print("\nWhat is said?\n");
    if (task_of(point_.task).has_trials())
      ask_for("After each trial", filled_in(point_).question, [this](const std::string& answer) {
        return attempt([&](StartingPoint& point) { point.question = answer; });
      });
    ask_for("Language of these texts", "en", [this](const std::string& answer) {
      return attempt([&](StartingPoint& point) { point.language = answer; });
    });
    ask_for("Title of the study", filled_in(point_).title,
            [this](const std::string& answer) { return attempt([&](StartingPoint& point) { point.title = answer; }); });
  }

  std::string take_conditions(const std::string& answer, const std::vector<std::string_view>& cues) {
    const std::vector<std::string> known(cues.begin(), cues.end());
    std::vector<StartingPoint::Condition> conditions;
    for (const std::string& part : split(answer, ',')) {
      if (known.empty()) {
        conditions.push_back({part, part, {}});
        continue;
      }
      const std::vector<std::string> parts = split(part, '+');
      for (const std::string& cue : parts)
        if (!among(cue, known)) return none_of_them(cue, known);
      conditions.push_back(condition_of(parts));
    }
    return attempt([&](StartingPoint& point) { point.conditions = conditions; });
  }

  std::istream& answers_;
  StartingPoint point_;
};

struct InitOptions {
  std::string file;  // to write; asked for where empty
};

int command_init(const InitOptions& options) {
  fmt::print("Enter takes what stands in [brackets]; Ctrl-C leaves, and nothing is written.\n\n");
  ProtocolWizard wizard(std::cin);
  const std::filesystem::path file = wizard.ask_file(options.file);
  const StartingPoint point = wizard.ask();
  const HoldInterrupts hold;  // until here a signal has ended the program
  const std::string name = file.string();
  write_new_protocol(file, readable_json(starting_protocol(point)),
                     fmt::format("the task {} on the rig {}", to_string(point.task), point.rig));
  if (!report_check(name)) return exit_code::kInvalidInput;
  fmt::print(
      "\nNext:\n"
      "  jnd plan {0} --participant P01\n"
      "  jnd run {0} --study rehearsal.sqlite --participant P01 --fast{2}\n"
      "  jnd simulate {0} --participants {1} --study simulated.sqlite --seed 1\n",
      shell_word(name), *filled_in(point).participants, point.rig == kSpecimenRig ? " --kind pilot" : "");
  return exit_code::kDone;
}

}  // namespace

void add_init(CommandTree& tree) {
  const auto [command, options] =
      tree.add("init", "Ask what a study is to be, and write its protocol", "jnd init my-study.json", command_init);
  command.add_option("FILE", options.file, "the file to write; it must not exist (default: asked for)");
}

}  // namespace jnd
