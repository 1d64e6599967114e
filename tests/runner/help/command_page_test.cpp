// What every command says of itself: help, completions and manual pages are made from it.
#include "runner/help/command_page.h"

#include <sstream>

#include <CLI/CLI.hpp>

#include "runner/command_line.h"
#include "runner/help/completed_value.h"
#include "runner/help/manual.h"
#include "runner/help/usage_error.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// The program's tree, whose commands are not run.
struct Program {
  Program() { build_program(app, chosen); }
  CLI::App app;
  std::function<int()> chosen;
};

// The words of a line as a shell has them; what is sent into a file is left out.
std::vector<std::string> shell_words(const std::string& line) {
  std::vector<std::string> words;
  std::string word;
  bool quoted = false, begun = false;
  for (const char c : line.substr(0, line.find(" > ")) + " ") {
    if (c == '"') {
      quoted = !quoted;
      begun = true;
    } else if (c == ' ' && !quoted) {
      if (begun) words.push_back(word);
      word.clear();
      begun = false;
    } else {
      word += c;
      begun = true;
    }
  }
  return words;
}

// Options that take several values, here and below; each leaves the arguments that follow it alone.
int check_lists(const CLI::App& app) {
  int lists = 0;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional() || option->get_items_expected_max() < 2) continue;
    INFO(app.get_name() << " " << option->get_name());
    CHECK_FALSE(option->get_allow_extra_args());
    ++lists;
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    lists += check_lists(*command);
  return lists;
}

// What takes a value has a name for it, here and below.
int check_values(const CLI::App& app, const CommandPage& page) {
  int values = 0;
  for (const std::vector<OptionPage>* options : {&page.arguments, &page.options})
    for (const OptionPage& option : *options) {
      const CLI::Option* const parsed = app.get_option_no_throw(option.name);
      INFO(page.name << " " << option.name);
      REQUIRE(parsed != nullptr);
      CHECK(option.value.empty() == (parsed->get_items_expected_max() == 0));
      values += option.value.empty() ? 0 : 1;
    }
  for (const CommandPage& command : page.commands)
    values += check_values(*app.get_subcommand(own_name(command)), command);
  return values;
}

}  // namespace

TEST_CASE("what takes a value names it, and a flag names none") {
  const Program program;
  CHECK(check_values(program.app, command_page(program.app)) > 150);
}

TEST_CASE("no option that takes several values takes the arguments that follow") {
  Program program;
  CHECK(check_lists(program.app) > 10);
  std::vector<std::string> words = shell_words("calc identify --classes A,B confusion.csv --json");
  std::reverse(words.begin(), words.end());  // as the parser takes them
  CHECK_NOTHROW(program.app.parse(words));
}

TEST_CASE("every command has an example, and the arguments of each are read without an error") {
  Program program;
  const CommandPage page = command_page(program.app);
  int examples = 0;
  for (const CommandPage* command : all_pages(page)) {
    INFO(command->name);
    if (command->commands.empty()) CHECK_FALSE(command->examples.empty());
    for (const std::string& example : command->examples) {
      INFO(example);
      // Of the command itself, or of a group one of its commands.
      CHECK(example.starts_with(command->name));
      std::vector<std::string> words = shell_words(example);
      words.erase(words.begin());
      program.chosen = nullptr;
      CHECK(named_command(program.app, words).problem.empty());
      std::reverse(words.begin(), words.end());  // as the parser takes them
      CHECK_NOTHROW(program.app.parse(words));
      CHECK(program.chosen != nullptr);
      ++examples;
    }
  }
  CHECK(examples > 40);
}

TEST_CASE("every option says what it does and what it takes") {
  const Program program;
  const CommandPage page = command_page(program.app);
  for (const CommandPage* command : all_pages(page)) {
    INFO(command->name);
    CHECK_FALSE(command->what.empty());
    for (const std::vector<OptionPage>* options : {&command->arguments, &command->options})
      for (const OptionPage& option : *options) {
        INFO(option.name);
        CHECK_FALSE(option.what.empty());
        if (option.is_argument) CHECK_FALSE(option.value.empty());
        // The parser's own words for a type tell a user nothing.
        for (const char* type : {"TEXT", "INT", "UINT", "FLOAT", "ENUM", "BOOLEAN"})
          if (option.name != "--remarks" && option.name != "TEXT") CHECK(option.value != type);
        for (const char c : option.what) CHECK(c != '\n');
      }
  }
}

TEST_CASE("an option that takes few words says them, and more words are listed") {
  const Program program;
  const CommandPage page = command_page(program.app);
  const auto option = [&page](const std::string& command, const std::string& name) {
    for (const CommandPage* one : all_pages(page))
      for (const OptionPage& each : one->options)
        if (one->name == command && each.name == name) return each;
    return OptionPage();
  };
  CHECK(label_of(option("jnd run", "--record")) == "--record off|events|full");
  CHECK(label_of(option("jnd new", "--task")) == "--task WORD");
  CHECK(words_of(option("jnd new", "--task")).find("same-different, which") != std::string::npos);
  CHECK(label_of(option("jnd calc staircase", "--clamp")) == "--clamp NUMBER,NUMBER");
  CHECK(words_of(option("jnd doctor", "--seconds")).find("(default: 3)") != std::string::npos);
  CHECK(words_of(option("jnd plan", "--cohort")).find("(1 to 10000)") != std::string::npos);
  CHECK(label_of(option("jnd status", "--json")) == "--json");
}

TEST_CASE("a shell is offered words, shipped names and files by what an option takes") {
  OptionPage option;
  option.value = "simulated|hid|FILE";
  CHECK(completed_value(option).words == std::vector<std::string>{"simulated", "hid"});
  CHECK(completed_value(option).files == "*");
  option.value = "PROTOCOL";
  const std::vector<std::string> names = completed_value(option).words;
  CHECK(std::count(names.begin(), names.end(), "chinello2017") == 1);
  CHECK(completed_value(option).files == "*.json");
  option.value = "STUDY";
  CHECK(completed_value(option).files == "*.sqlite");
  option.value = "N";
  CHECK(completed_value(option).nothing());
  option.words = {"off", "full"};
  CHECK(completed_value(option).words == option.words);
}

TEST_CASE("a manual page keeps minus signs, quotes and lines that begin with a full stop") {
  CommandPage page;
  page.name = "jnd odd";
  page.what = ".TH is no request here";
  page.examples = {"jnd odd --say 'it\\'"};
  const std::string text = manual_page(page, page);
  CHECK(text.find("jnd\\-odd \\- \\&.TH is") != std::string::npos);
  CHECK(text.find("jnd odd \\-\\-say \\(aqit\\e\\(aq") != std::string::npos);
  CHECK(manual_file(page) == "jnd-odd.1");
}

TEST_CASE("what is misspelled is looked for among what there is, and values are not taken for options") {
  const Program program;
  const auto problem = [&program](const std::vector<std::string>& words) {
    return named_command(program.app, words).problem;
  };
  CHECK(problem({"analyse"}) == "there is no command 'analyse'; did you mean 'analyze'?");
  CHECK(problem({"device", "tset", "rrs3"}) == "device has no command 'tset'; did you mean 'test'?");
  CHECK(problem({"run", "x", "--particpant", "P01"}) ==
        "run has no option --particpant; did you mean '--participant'?");
  CHECK(problem({"run", "x", "--particpant=P01"}) == "run has no option --particpant; did you mean '--participant'?");
  CHECK(problem({"quite-else"}) == "there is no command 'quite-else'");
  CHECK(problem({"exclude", "s", "--reason", "--strange"}).empty());
  CHECK(problem({"note", "s", "--", "--strange"}).empty());
  CHECK(problem({"calc", "sdt", "-"}).empty());
}

}  // namespace jnd
