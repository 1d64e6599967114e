// What a command is, as its help, the completions of the shells and the manual pages tell it: read from the tree of
// commands, so that the three say the same.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace jnd {

// An option, or an argument, which has a place instead of a name.
struct OptionPage {
  std::string name;                // "--study"; of an argument "STUDY"
  std::string value;               // what it takes: "FILE", "off|events|full"; empty where it takes nothing
  std::string what;                // what it does, its default among it
  std::vector<std::string> words;  // the values, where only these are taken
  std::string range;               // "1 to 1000"; empty where it has none
  std::string fallback;            // the default that the parser knows; empty where `what` says it
  std::string variable;            // of the environment, that is read where the option is not given
  bool is_argument = false;
  bool required = false;
  bool several = false;  // it takes several values
};

struct CommandPage {
  std::string name;     // "jnd plan"
  std::string what;     // one line
  std::string heading;  // under which the parent's help lists it
  std::string notes;    // paragraphs with lines of their own; mostly empty
  std::vector<std::string> examples;
  std::vector<OptionPage> arguments, options;
  std::vector<CommandPage> commands;  // of its own
};

// With everything below it. Thread rule: app is not changed meanwhile.
CommandPage command_page(const CLI::App& app);

// "plan", of "jnd plan".
std::string own_name(const CommandPage& page);
// "jnd plan [OPTIONS] [PROTOCOL]".
std::string usage_of(const CommandPage& page);
// "--study STUDY", "--json", "PROTOCOL...".
std::string label_of(const OptionPage& option);
// What there is to say of it: what it does, its range, words, default and variable.
std::string words_of(const OptionPage& option);

// Every command in order, the page itself first.
std::vector<const CommandPage*> all_pages(const CommandPage& page);

}  // namespace jnd
