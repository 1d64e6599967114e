#include "runner/command_line.h"

#include <functional>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "protocols/version.h"
#include "runner/calc/calc.h"
#include "runner/commands/commands.h"
#include "runner/device_commands/device_commands.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/command_outcome.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

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
