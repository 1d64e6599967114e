// The tree of the program's commands. Each command adds itself in its own source: its options, help, example and what it
// runs; a small file collects them. Only this wing, help and runner/command_line.cpp see the parser itself: its headers
// cost each source that includes them two to four seconds.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/numerics/words.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace jnd {

// An option of a command or one of its arguments, while it is described. Each call returns the option again.
class CommandOption {
 public:
  CommandOption(CLI::Option* option) : option_(option) {}  // not explicit: the parser returns these
  CommandOption required() const;
  CommandOption one_of(std::vector<std::string> words) const;
  CommandOption range(int least, int most) const;
  CommandOption range(double least, double most) const;
  // why_not: empty for a value that will do, else what is wrong with it.
  CommandOption check(const std::function<std::string(const std::string&)>& why_not) const;
  CommandOption show_default() const;               // in the help: what the value holds now
  CommandOption delimiter(char between) const;      // of several values in one word
  CommandOption values(int least, int most) const;  // how many it takes
  CommandOption needs(const CommandOption& other) const;
  CommandOption excludes(const CommandOption& other) const;
  CommandOption variable(const std::string& name) const;  // of the environment, which stands in for it
  CommandOption hidden() const;                           // from the help

 private:
  CLI::Option* option_;
};

// A command, while its options are added to it.
class Command {
 public:
  explicit Command(CLI::App& command) : command_(&command) {}
  // value: what is given goes there. A std::string, int, double or std::uint64_t, an optional one of these, or several
  // strings, ints or doubles: an option takes one word each time that it is given, so that no list swallows an argument.
  template <typename Value>
  CommandOption add_option(const std::string& name, Value& value, const std::string& what) const;
  // An option whose value is one of some words, in alphabetical order in the help. value: Enum or an optional one.
  template <typename Enum, std::size_t N, typename Value>
  CommandOption add_choice(const std::string& name, Value& value, const WordTable<Enum, N>& words,
                           const std::string& what) const {
    const std::map<std::string, Enum> known(words.begin(), words.end());
    std::vector<std::string> shown;
    for (const auto& [word, its_value] : known) shown.push_back(word);
    return add_word(
               name, [&value, known](const std::string& word) { value = known.at(word); }, what)
        .one_of(shown);
  }
  CommandOption add_flag(const std::string& name, bool& value, const std::string& what) const;
  CommandOption add_flag(const std::string& name, int& value,
                         const std::string& what) const;  // "--name{5}" may have a value
  CommandOption option(const std::string& name) const;    // one that was added
  void add_notes(const std::string& text) const;          // above the example

 private:
  CommandOption add_word(const std::string& name, const std::function<void(const std::string&)>& take,
                         const std::string& what) const;
  CLI::App* command_;
};

// A parent of commands, while they are added to it: the program, or a group of commands such as `jnd calc`.
class CommandTree {
 public:
  // chosen becomes the command that the arguments name.
  CommandTree(CLI::App& parent, std::function<int()>& chosen) : parent_(parent), chosen_(chosen) {}

  // A command that was added, for the caller to give it its arguments, and what these fill in. Both live as long as the
  // parser.
  template <typename Options>
  struct Added {
    Command command;
    Options& options;
  };

  // A command whose help ends with an example. run(options) returns the exit code and prints to stdout; it throws
  // InputError, StorageError, DeviceError, UsageError and, where arguments do not go together, as below.
  template <typename Options>
  Added<Options> add(const std::string& name, const std::string& what, const std::string& example,
                     int (*run)(const Options&)) {
    const auto options = std::make_shared<Options>();
    return {add_command(name, what, example, [options, run] { return run(*options); }), *options};
  }

  // A command that has commands of its own, exactly one of which is to be named. example: none where empty.
  CommandTree add_group(const std::string& name, const std::string& what, const std::string& example = "");

  // The commands that are added from here on stand under this heading in the parent's help.
  void heading(const std::string& text) { heading_ = text; }
  CLI::App& parent() const noexcept { return parent_; }

 private:
  Command add_command(const std::string& name, const std::string& what, const std::string& example,
                      std::function<int()> run);
  CLI::App& parent_;
  std::function<int()>& chosen_;
  std::string heading_;
};

// What is wrong with the arguments and was found only when the command runs; said as the parser says it.
[[noreturn]] void refuse_arguments(const std::string& problem);

}  // namespace jnd
