#include "runner/help/help_text.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

constexpr std::size_t kWidestLabel = 26;    // a longer one has a line of its own
constexpr std::size_t kNarrowestText = 24;  // columns

struct Row {
  std::string label, text;
};

std::string table(const std::vector<Row>& rows, std::size_t columns) {
  std::size_t width = 0;
  for (const Row& row : rows)
    if (row.label.size() <= kWidestLabel) width = std::max(width, row.label.size());
  std::string out;
  const std::size_t indent = width + 4;
  const std::size_t room = std::max(kNarrowestText, columns > indent ? columns - indent : 0);
  for (const Row& row : rows) {
    const std::vector<std::string> lines = wrapped_words(row.text, room);
    const bool apart = row.label.size() > width;
    out += apart ? fmt::format("  {}\n", row.label) : fmt::format("  {:<{}}  {}\n", row.label, width, lines.front());
    for (std::size_t i = apart ? 0 : 1; i < lines.size(); ++i) out += fmt::format("{:{}}{}\n", "", indent, lines[i]);
  }
  return out;
}

std::vector<std::string> headings_of(const CommandPage& page) {
  std::vector<std::string> headings;
  for (const CommandPage& command : page.commands)
    if (std::find(headings.begin(), headings.end(), command.heading) == headings.end())
      headings.push_back(command.heading);
  return headings;
}

std::string commands_text(const CommandPage& page, std::size_t columns) {
  std::string out;
  const std::vector<std::string> headings = headings_of(page);
  // As wide under every heading, so that all texts begin in one column.
  std::size_t width = 0;
  for (const CommandPage& command : page.commands) width = std::max(width, own_name(command).size());
  for (const std::string& heading : headings) {
    std::vector<Row> rows;
    for (const CommandPage& command : page.commands)
      if (command.heading == heading) rows.push_back({fmt::format("{:<{}}", own_name(command), width), command.what});
    out += fmt::format("\n{}:\n{}", bold(headings.size() == 1 ? "Commands" : heading), table(rows, columns));
  }
  return out;
}

std::string section(const char* title, const std::vector<OptionPage>& options, std::size_t columns) {
  if (options.empty()) return "";
  std::vector<Row> rows;
  rows.reserve(options.size());
  for (const OptionPage& option : options)
    rows.push_back({label_of(option), (option.required && !option.is_argument ? "required: " : "") + words_of(option)});
  return fmt::format("\n{}:\n{}", bold(title), table(rows, columns));
}

}  // namespace

std::string help_text(const CommandPage& page, std::size_t columns) {
  std::string out = fmt::format("{}\n\nUsage: {}\n", page.what, usage_of(page));
  out += commands_text(page, columns);
  out += section("Arguments", page.arguments, columns);
  out += section("Options", page.options, columns);
  if (!page.notes.empty()) out += "\n" + page.notes;
  if (!page.examples.empty()) out += fmt::format("\n{}:\n", bold(page.examples.size() == 1 ? "Example" : "Examples"));
  for (const std::string& example : page.examples) out += fmt::format("  {}\n", example);
  if (page.commands.empty()) return out;
  const std::size_t blank = page.name.find(' ');
  const std::string group = blank == std::string::npos ? "" : page.name.substr(blank);
  out += fmt::format("\nMore about one of them:  jnd help{} COMMAND\n", group);
  return out;
}

std::string exit_codes_text() {
  std::string out;
  const auto add = [&out](int code, const char* meaning) { out += fmt::format("  {:>3}  {}\n", code, meaning); };
  add(exit_code::kDone, "done");
  add(exit_code::kProblemFound, "a check found a problem, or a comparison a difference");
  add(exit_code::kUsage, "wrong usage");
  add(exit_code::kInvalidInput, "invalid input: a protocol, a rig file, a CSV file");
  add(exit_code::kDevice, "a device");
  add(exit_code::kStorage, "storage, or results that could not be printed in full");
  add(exit_code::kInterrupted, "interrupted: run it again to go on");
  return out;
}

const std::vector<EnvironmentVariable>& environment_variables() {
  static const std::vector<EnvironmentVariable> variables = {
      {"JND_STUDY", "the study, where a command takes STUDY and none is given"},
      {"JND_PAGER", "what long output goes through on a terminal; else PAGER, else less"},
      {"JND_DATA_DIR", "the folder of what is shipped with the program"},
      {"BROWSER", "what jnd report --open starts; else xdg-open"},
      {"NO_COLOR", "switches colours off"}};
  return variables;
}

std::string program_closing(std::size_t columns) {
  std::vector<Row> variables;
  for (const EnvironmentVariable& one : environment_variables()) variables.push_back({one.name, one.what});
  return fmt::format(
      "\n{}:\n"
      "  jnd new my-study.json          a protocol to start from; jnd init asks what it is to be\n"
      "  jnd check my-study.json        what is wrong with it, where\n"
      "  jnd simulate chinello2017 --participants 18 --study s.sqlite\n"
      "  jnd analyze s.sqlite           d', JND, Weber fractions\n"
      "\n{}:\n{}\n{}:\n{}",
      bold("Start here"), bold("Exit codes"), exit_codes_text(), bold("Environment"), table(variables, columns));
}

}  // namespace jnd
