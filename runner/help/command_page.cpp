#include "runner/help/command_page.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace jnd {

namespace {

// What an option of that name takes; with the command before it, in that command alone. Each one that takes text is here.
constexpr auto kValues = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"--accept-gap", "REASON"},
    {"--account", "NAME"},
    {"--ademp", "FILE"},
    {"--answer", "COLUMN"},
    {"--batch", "FILE"},
    {"--block", "COLUMN"},
    {"--buttons", "FILE"},
    {"--classes", "A,B,..."},
    {"--command", "PROGRAM"},
    {"--condition", "COLUMN"},
    {"--csv", "FILE"},
    {"--device", "DEVICE"},
    {"--events", "SOCKET"},
    {"--figure", "FILE"},
    {"--figures", "FOLDER"},
    {"--from", "PROTOCOL"},
    {"--geometry", "FILE"},
    {"--group", "NAME"},
    {"--guess", "RATE|free"},
    {"--jnd", "JND"},
    {"--kind", "real|pilot|simulated"},
    {"--language", "LANGUAGE"},
    {"--lapse", "RATE|free"},
    {"--level", "COLUMN"},
    {"--memory", "SIZE"},
    {"--methods", "FILE"},
    {"--no-answer", "WORD"},
    {"--operator", "NAME"},
    {"--order", "COLUMN"},
    {"--out", "FILE"},
    {"--override-readiness", "REASON"},
    {"--participant", "CODE"},
    {"--partition", "NAME"},
    {"--pose", "PZ,ROLL,PITCH"},
    {"--positive", "WORD"},
    {"--press", "CODE:TRIAL"},
    {"--profile", "PROFILE"},
    {"--program", "FILE"},
    {"--protocol", "PROTOCOL"},
    {"--random", "LIST"},
    {"--reason", "REASON"},
    {"--reference-name", "NAME"},
    {"--remarks", "TEXT"},
    {"--responder", "PROFILE"},
    {"--rig", "FILE"},
    {"--sbatch", "OPTION"},
    {"--setup", "LINE"},
    {"--shard", "K/N"},
    {"--spec", "FILE"},
    {"--standard", "NUMBER|COLUMN"},
    {"--study", "STUDY"},
    {"--sureness", "COLUMN"},
    {"--time", "TIME"},
    {"--to", "FILE"},
    {"--wrench", "FX,FY,FZ,MX,MY,MZ"},
    {"jnd analyze --csv", "FOLDER"},
    {"jnd calc fit --participant", "COLUMN"},
    {"jnd calc hierarchical --lapse", "RATE|shared"},
    {"jnd calc hierarchical --participant", "COLUMN"},
    {"jnd calc jnd --participant", "COLUMN"},
    {"jnd calc sdt --participant", "COLUMN"},
    {"jnd calc which --participant", "COLUMN"},
    {"jnd device calibrate --reference", "interactive|FILE"},
    {"jnd doctor --study", "STUDY|FOLDER"},
    {"jnd export --to", "FOLDER"},
    {"jnd plan --analysis", "NAME,..."},
    {"jnd plan --effect", "NUMBER,..."},
    {"jnd plan --group-factor", "GROUP=NUMBER,..."},
    {"jnd plan --participants", "N,..."},
    {"jnd plan --shard", "K/N"},
    {"jnd plan --to", "FILE"},
    {"jnd plan --trials", "N,..."},
    {"jnd run --kind", "real|pilot"},
    {"jnd run --rig", "simulated|hid|specimens|FILE"},
});

// Words that are longer than this together are listed behind what the option does.
constexpr std::size_t kLongestChoice = 32;

// "{a,b}" -> a, b. What the parser writes of CLI::IsMember.
std::vector<std::string> words_in_braces(const std::string& text) {
  const std::size_t begin = text.find('{'), end = text.rfind('}');
  std::vector<std::string> words;
  if (begin == std::string::npos || end == std::string::npos) return words;
  std::istringstream list(text.substr(begin + 1, end - begin - 1));
  for (std::string word; std::getline(list, word, ',');) words.push_back(word);
  return words;
}

// "INT in [1 - 100]" -> "1 to 100".
std::string range_in(const std::string& text) {
  const std::size_t begin = text.find(" in ["), end = text.rfind(']');
  if (begin == std::string::npos || end == std::string::npos) return "";
  std::string range = text.substr(begin + 5, end - begin - 5);
  const std::size_t dash = range.find(" - ");
  if (dash != std::string::npos) range.replace(dash, 3, " to ");
  return range;
}

std::string_view known_value(const std::string& name) {
  const auto* const found =
      std::find_if(kValues.begin(), kValues.end(), [&name](const auto& one) { return one.first == name; });
  return found == kValues.end() ? std::string_view() : found->second;
}

// The value's name: by the option's name where it is text, else by the type.
std::string value_by_name(const std::string& command, const std::string& name, const std::string& type) {
  if (type == "INT" || type == "UINT") return "N";
  if (type != "TEXT") return "NUMBER";
  const std::string_view in_command = known_value(command + " " + name);
  return std::string(!in_command.empty() ? in_command : known_value(name));
}

std::string value_of_option(const std::string& command, const CLI::Option& option, const OptionPage& page,
                            const std::string& type) {
  const std::string choice = fmt::format("{}", fmt::join(page.words, "|"));
  if (!page.words.empty()) return choice.size() <= kLongestChoice ? choice : "WORD";
  const std::string one = value_by_name(command, page.name, type);
  std::string value = one;
  for (int i = 1; i < option.get_items_expected_min(); ++i) value += "," + one;
  if (page.several && option.get_delimiter() != '\0' && !value.ends_with("...")) value += ",...";
  return value;
}

OptionPage option_page(const std::string& command, const CLI::Option& option) {
  OptionPage page;
  page.is_argument = option.get_positional();
  page.name = page.is_argument               ? option.get_name(true)
              : !option.get_lnames().empty() ? "--" + option.get_lnames().front()
                                             : option.get_name();
  page.what = option.get_description();
  page.required = option.get_required() && option.get_envname().empty();
  page.variable = option.get_envname();
  page.several = option.get_expected_max() > 1 && option.get_expected_max() != option.get_expected_min();
  if (option.get_items_expected_max() == 0) return page;  // a flag
  const std::string full = option.get_type_name();
  const std::string type = full.substr(0, full.find(':'));
  page.words = words_in_braces(full);
  page.range = range_in(full);
  page.fallback = option.get_default_str();
  page.value = page.is_argument ? page.name : value_of_option(command, option, page, type);
  return page;
}

// The text below a command: lines that call the program are its examples, what stands before them are notes.
void read_footer(const std::string& text, CommandPage& page) {
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    const std::string stripped = line.substr(std::min(line.find_first_not_of(' '), line.size()));
    if (stripped.starts_with("jnd "))
      page.examples.push_back(stripped);
    else
      page.notes += line + "\n";
  }
  while (page.notes.ends_with("\n\n")) page.notes.pop_back();
}

}  // namespace

CommandPage command_page(const CLI::App& app) {
  CommandPage page;
  for (const CLI::App* one = &app; one != nullptr; one = one->get_parent())
    page.name = one->get_name() + (page.name.empty() ? "" : " ") + page.name;
  page.what = app.get_description();
  page.heading = app.get_group();
  read_footer(app.get_footer(), page);
  for (const CLI::Option* option : app.get_options({})) {
    if (option->get_group().empty()) continue;  // kept for scripts of before
    OptionPage one = option_page(page.name, *option);
    (one.is_argument ? page.arguments : page.options).push_back(std::move(one));
  }
  // The options that every command has come last.
  std::stable_partition(page.options.begin(), page.options.end(),
                        [](const OptionPage& one) { return one.name != "--help" && one.name != "--version"; });
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    page.commands.push_back(command_page(*command));
  return page;
}

std::string own_name(const CommandPage& page) {
  return page.name.substr(page.name.rfind(' ') + 1);
}

std::string usage_of(const CommandPage& page) {
  std::string usage = page.name;
  if (!page.commands.empty()) return usage + " COMMAND ...";
  bool others = false;
  for (const OptionPage& option : page.options) {
    if (option.name == "--help" || option.name == "--version") continue;
    if (option.required)
      usage += " " + label_of(option);
    else
      others = true;
  }
  if (others) usage += " [OPTIONS]";
  for (const OptionPage& argument : page.arguments)
    usage += argument.required ? " " + label_of(argument) : fmt::format(" [{}]", label_of(argument));
  return usage;
}

std::string label_of(const OptionPage& option) {
  if (option.is_argument) return option.name + (option.several ? "..." : "");
  return option.value.empty() ? option.name : option.name + " " + option.value;
}

std::string words_of(const OptionPage& option) {
  std::string text = option.what;
  if (!option.words.empty() && option.value == "WORD") text += fmt::format(": {}", fmt::join(option.words, ", "));
  if (!option.range.empty() && text.find(option.range) == std::string::npos) text += fmt::format(" ({})", option.range);
  if (!option.fallback.empty()) text += fmt::format(" (default: {})", option.fallback);
  if (!option.variable.empty()) text += fmt::format(" (default: ${})", option.variable);
  return text;
}

std::vector<const CommandPage*> all_pages(const CommandPage& page) {
  std::vector<const CommandPage*> pages = {&page};
  for (const CommandPage& command : page.commands)
    for (const CommandPage* one : all_pages(command)) pages.push_back(one);
  return pages;
}

}  // namespace jnd
