#include "runner/command_line.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "protocols/version.h"
#include "runner/calc/calc.h"
#include "runner/cluster/cluster.h"
#include "runner/commands/commands.h"
#include "runner/device_commands/device_commands.h"
#include "runner/help/help_commands.h"
#include "runner/help/usage_error.h"
#include "runner/help/version_text.h"
#include "runner/keys/interrupt.h"
#include "runner/study_commands/study_commands.h"
#include "runner/terminal/command_outcome.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/study_variable.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

// In the order of the program's help.
void add_commands(CommandTree& tree) {
  tree.heading("Design a study");
  add_init(tree);
  add_new(tree);
  add_check(tree);
  add_plan(tree);
  add_combine(tree);
  add_cluster(tree);
  add_diff(tree);
  tree.heading("Run it");
  add_run(tree);
  add_simulate(tree);
  tree.heading("Look after it");
  add_studies(tree);
  add_status(tree);
  add_watch(tree);
  add_verify(tree);
  add_note(tree);
  add_exclude(tree);
  add_unblind(tree);
  add_backup(tree);
  add_merge(tree);
  add_recover(tree);
  tree.heading("Results");
  add_analyze(tree);
  add_report(tree);
  add_export(tree);
  tree.heading("Devices and the machine");
  add_device_commands(tree);
  add_doctor(tree);
  tree.heading("Statistics");
  add_calc_commands(tree);
  tree.heading("About the program");
  add_help(tree);
  add_completions(tree);
  add_man(tree);
}

// Where an argument is called STUDY, the variable stands in for it.
void read_study_variable(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    read_study_variable(*command);
    for (CLI::Option* option : command->get_options([](CLI::Option* one) { return one->get_name(true) == "STUDY"; }))
      option->envname(kStudyVariable);
  }
}

int say_usage(const CLI::App& command, const std::string& problem) {
  write_message(printable_lines(usage_message(command, problem)));
  return exit_code::kUsage;
}

// A command may find only later that options do not go together, or not with the study: then, too, it is said where
// to read.
int run_chosen(const std::function<int()>& chosen, const CLI::App& command) {
  try {
    return chosen();
  } catch (const UsageError& error) {
    write_marked_message(error.what());
    write_message(fmt::format("  more:  {}\n", help_command_of(command)));
    return exit_code::kUsage;
  }
}

// Reads the arguments and runs the command that they choose.
int parse_and_run(int argc, const char* const* argv) {
  CLI::App app;
  std::function<int()> chosen;
  build_program(app, chosen);
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  const NamedCommand named = named_command(app, arguments);
  if (!named.problem.empty()) return say_usage(*named.command, named.problem);
  try {
    app.parse(argc, argv);
    if (chosen) {
      tell_study_of_variable(*named.command, arguments);
      return run_chosen(chosen, *named.command);
    }
  } catch (const CLI::CallForVersion&) {
    fmt::print("{}", version_text());
    return exit_code::kDone;
  } catch (const CLI::CallForHelp&) {
  } catch (const CLI::ParseError& error) {
    return say_usage(*named.command, problem_of(error));
  }
  // Asked for, or a group of commands without one of them. Then, too, 0: as with gh and cargo the list is the answer,
  // while the 1 of git would say in this program that a check found a problem.
  fmt::print("{}", help_of(*named.command));
  return exit_code::kDone;
}

}  // namespace

void build_program(CLI::App& app, std::function<int()>& chosen) {
  app.name("jnd");
  app.description("jnd: plan, rehearse, run and analyse discrimination studies in haptics");
  app.set_help_flag("-h,--help", "print this help");
  app.require_subcommand(0, 1);
  CommandTree tree(app, chosen);
  add_commands(tree);
  app.set_version_flag("--version", kVersion, "print the version, and what it was built with");
  read_study_variable(app);
}

int run_command_line(int argc, const char* const* argv) {
  keep_standard_streams();
  install_interrupt_handlers();
  return outcome_of([&] { return parse_and_run(argc, argv); });
}

}  // namespace jnd
