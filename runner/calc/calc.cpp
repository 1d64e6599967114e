#include "runner/calc/calc.h"

#include <CLI/CLI.hpp>

namespace jnd {

CLI::App* CalcTree::add_command(const std::string& name, const std::string& what, const std::string& example,
                                std::function<int()> run) {
  CLI::App* command = calc_.add_subcommand(name, what);
  command->footer("Example:\n  jnd calc " + example);
  command->callback([&chosen = chosen_, run = std::move(run)] { chosen = run; });
  return command;
}

void CalcTree::add_input(CLI::App& command, CalcInput& input, const std::string& columns) {
  command.add_option("FILE", input.file, "a CSV file with the columns " + columns + "; - reads standard input")
      ->required();
  command.add_flag("--json", input.json, "machine-readable");
}

void add_calc_commands(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* calc = app.add_subcommand("calc", "The statistics on any CSV, without a study");
  calc->require_subcommand(1);
  calc->footer("Example:\n  jnd calc sdt counts.csv --json");
  CalcTree tree(*calc, chosen);
  add_calc_detection(tree);
  add_calc_jnd(tree);
  add_calc_group(tree);
  add_calc_psychometric(tree);
  add_calc_adaptive(tree);
  add_calc_selftest(tree);
}

}  // namespace jnd
