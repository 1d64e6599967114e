#include "runner/command_line.h"

#include <functional>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "protocols/version.h"
#include "runner/calc/calc.h"
#include "runner/commands/commands.h"
#include "runner/commands/report_command.h"
#include "runner/device_commands/device_commands.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/command_outcome.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

void add_analyze(CommandTree& tree) {
  const auto [command, options] = tree.add("analyze", "d', JND and Weber fractions by the registered plan",
                                           "jnd analyze s.sqlite", command_analyze);
  command.add_option("STUDY", options.study, "the study's file")->required();
  add_kind_and_by(command, options.kind, options.by);
  command.add_option("--models", options.models, "registered (default), or all: every model beside it")
      ->check(CLI::IsMember({"registered", "all"}));
  command.add_flag("--cells", options.cells, "also every cell: counts, rates, z and d'");
  command.add_option("--csv", options.csv, "also the results as CSV files in this folder");
  command.add_flag("--replace", options.replace, "replace the CSV folder of an earlier analysis");
  command.add_option("--methods", options.methods,
                     "the file for the methods in words (default: methods.md beside the study)");
  command.add_flag("--no-methods", options.no_methods, "write no methods file");
  command.add_flag("--json", options.json, "machine-readable");
}

void add_report(CommandTree& tree) {
  const auto [command, options] = tree.add("report", "Write a page for people: figures, tables, warnings, methods",
                                           "jnd report s.sqlite", command_report);
  command.add_option("STUDY", options.study, "the study's file")->required();
  command.add_option("--to", options.file, "the page (default: the study's name with -report.html, beside it)");
  command.add_option("--figures", options.figures_folder,
                     "the folder for the figures as SVG files (default: the page's name with -figures)");
  add_kind_and_by(command, options.kind, options.by);
  command.add_flag("--replace", options.replace, "replace an earlier report");
}

// In the order of the program's help.
void add_commands(CommandTree& tree) {
  add_new(tree);
  add_check(tree);
  add_plan(tree);
  add_run(tree);
  add_simulate(tree);
  add_status(tree);
  add_verify(tree);
  add_analyze(tree);
  add_export(tree);
  add_report(tree);
  add_doctor(tree);
  add_note(tree);
  add_exclude(tree);
  add_unblind(tree);
  add_backup(tree);
  add_merge(tree);
  add_recover(tree);
  add_calc_commands(tree);
  add_device_commands(tree);
}

// Reads the arguments and runs the command that they choose.
int parse_and_run(int argc, const char* const* argv) {
  CLI::App app{"jnd: plan, rehearse, run and analyse stiffness-discrimination studies", "jnd"};
  app.set_version_flag("--version", std::string("jnd ") + kVersion);
  app.require_subcommand(1);
  app.footer(
      "Start here:\n  jnd new my-study.json          a protocol to start from\n"
      "  jnd check my-study.json        what is wrong with it, where\n"
      "  jnd simulate chinello2017 --participants 18 --study s.sqlite\n"
      "  jnd analyze s.sqlite           d', JND, Weber fractions");
  std::function<int()> chosen;
  CommandTree tree(app, chosen);
  add_commands(tree);
  try {
    app.parse(argc, argv);
    return chosen();
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, err;
    const int code = app.exit(error, out, err);  // help, version or the message, which quotes arguments
    fmt::print("{}", printable_lines(out.str()));
    write_message(printable_lines(err.str()));
    return code == 0 ? exit_code::kDone : exit_code::kUsage;
  }
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
  keep_standard_streams();
  install_interrupt_handlers();
  return outcome_of([&] { return parse_and_run(argc, argv); });
}

}  // namespace jnd
