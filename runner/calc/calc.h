// `jnd calc`: the statistics on any CSV, without a study. Each calc_*.cpp adds its commands; runner/calc/calc.cpp
// collects them.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace CLI {
class App;
}

namespace jnd {

// Adds the whole tree `jnd calc ...`. chosen becomes the command that the arguments name.
void add_calc_commands(CLI::App& app, std::function<int()>& chosen);

// What every command of the tree reads and how it answers.
struct CalcInput {
  std::string file;   // a CSV file, or "-": standard input
  bool json = false;  // JSON as machines want it; otherwise tables for a person
};

// The parent of the tree, while commands are added to it.
class CalcTree {
 public:
  CalcTree(CLI::App& calc, std::function<int()>& chosen) : calc_(calc), chosen_(chosen) {}

  // A command whose help ends with "jnd calc EXAMPLE". options: kept as long as the parser. run(*options) returns the
  // exit code. The caller adds its options to the returned command.
  template <typename Options>
  CLI::App* add(const std::string& name, const std::string& what, const std::string& example,
                std::shared_ptr<Options> options, int (*run)(const Options&)) {
    return add_command(name, what, example, [options, run] { return run(*options); });
  }
  // The positional FILE ("-": standard input) and --json. columns: for the help, such as "id, n_diff, hits".
  static void add_input(CLI::App& command, CalcInput& input, const std::string& columns);

 private:
  CLI::App* add_command(const std::string& name, const std::string& what, const std::string& example,
                        std::function<int()> run);
  CLI::App& calc_;
  std::function<int()>& chosen_;
};

void add_calc_detection(CalcTree& tree);     // sdt, coverage
void add_calc_jnd(CalcTree& tree);           // jnd
void add_calc_group(CalcTree& tree);         // compare, wilcoxon, ptukey, qtukey, shapiro
void add_calc_psychometric(CalcTree& tree);  // fit
void add_calc_adaptive(CalcTree& tree);      // staircase, quest
void add_calc_selftest(CalcTree& tree);      // selftest

}  // namespace jnd
