// The tree of the program's commands. Each command adds itself in its own source: its options, help, example and what it
// runs; a small file collects them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace CLI {
class App;
}

namespace jnd {

// A parent of commands, while they are added to it: the program, or a group of commands such as `jnd calc`.
class CommandTree {
 public:
  // chosen becomes the command that the arguments name.
  CommandTree(CLI::App& parent, std::function<int()>& chosen) : parent_(parent), chosen_(chosen) {}

  // A command that was added, for the caller to give it its arguments, and what these fill in. Both live as long as the
  // parser.
  template <typename Options>
  struct Added {
    CLI::App& command;
    Options& options;
  };

  // A command whose help ends with an example. run(options) returns the exit code and prints to stdout; it throws
  // InputError, StorageError, DeviceError, UsageError and, where arguments do not go together, CLI::ParseError.
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
  CLI::App& add_command(const std::string& name, const std::string& what, const std::string& example,
                        std::function<int()> run);
  CLI::App& parent_;
  std::function<int()>& chosen_;
  std::string heading_;
};

}  // namespace jnd
