#include "runner/command_line.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <SQLiteCpp/SQLiteCpp.h>
#include <boost/version.hpp>
#include <fmt/format.h>
#include <hidapi.h>
#include <nlohmann/json.hpp>
#include <sodium.h>
#include <sqlite3.h>
#include <zstd.h>

#include "data/files/draft.h"
#include "protocols/version.h"
#include "runner/calc/calc.h"
#include "runner/cluster/cluster.h"
#include "runner/commands/commands.h"
#include "runner/device_commands/device_commands.h"
#include "runner/help/command_page.h"
#include "runner/help/completions.h"
#include "runner/help/help_text.h"
#include "runner/help/manual.h"
#include "runner/help/usage_error.h"
#include "runner/keys/interrupt.h"
#include "runner/study_commands/study_commands.h"
#include "runner/terminal/command_outcome.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/study_variable.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

// The help of the command, with the program's closing words where it is the program itself; as wide as the terminal.
std::string help_of(const CLI::App& command) {
  constexpr std::size_t kWidest = 100;  // columns that are still read with ease
  const auto columns = static_cast<std::size_t>(std::max(terminal_width(), 0));
  const std::size_t width = std::min(columns, kWidest);
  const std::string text = help_text(command_page(command), width);
  return command.get_parent() == nullptr ? text + program_closing(width) : text;
}

struct HelpOptions {
  const CLI::App* program = nullptr;
  std::vector<std::string> words;  // of the command
};

struct CompletionsOptions {
  const CLI::App* program = nullptr;
  std::string shell;
};

struct ManOptions {
  const CLI::App* program = nullptr;
  std::string folder;
};

int command_help(const HelpOptions& options) {
  const NamedCommand named = named_command(*options.program, options.words);
  if (!named.problem.empty()) {
    write_message(printable_lines(usage_message(*named.command, named.problem)));
    return exit_code::kUsage;
  }
  fmt::print("{}", help_of(*named.command));
  return exit_code::kDone;
}

int command_completions(const CompletionsOptions& options) {
  const CommandPage program = command_page(*options.program);
  fmt::print("{}", options.shell == "bash"  ? bash_completions(program)
                   : options.shell == "zsh" ? zsh_completions(program)
                                            : fish_completions(program));
  return exit_code::kDone;
}

int command_man(const ManOptions& options) {
  const HoldInterrupts hold;
  const CommandPage program = command_page(*options.program);
  const std::filesystem::path folder = options.folder;
  std::error_code error;
  std::filesystem::create_directories(folder, error);  // where it cannot be made, writing into it says so
  const std::vector<const CommandPage*> pages = all_pages(program);
  for (const CommandPage* page : pages) {
    Draft draft(folder / manual_file(*page), Draft::What::file, Draft::Access::everyone);
    draft.write(manual_page(*page, program));
    draft.replace([](const std::filesystem::path&) {});
  }
  fmt::print("{} manual pages in {}; read one with  man -l {}\n", pages.size(), printable(folder.string()),
             printable((folder / manual_file(program)).string()));
  return exit_code::kDone;
}

void add_help(CommandTree& tree) {
  const auto [command, options] =
      tree.add("help", "Explain a command, or list them all", "jnd help device test", command_help);
  options.program = &tree.parent();
  command.add_option("COMMAND", options.words, "a command and, of one that has its own, one of those; none: the list");
}

void add_completions(CommandTree& tree) {
  const auto [command, options] =
      tree.add("completions", "Print what makes the Tab key complete commands, options and names in a shell",
               "jnd completions bash > ~/.local/share/bash-completion/completions/jnd", command_completions);
  options.program = &tree.parent();
  command.add_option("SHELL", options.shell, "whose: bash, zsh or fish").required().one_of({"bash", "zsh", "fish"});
}

void add_man(CommandTree& tree) {
  const auto [command, options] =
      tree.add("man", "Write the manual pages, one a command", "jnd man ~/.local/share/man/man1", command_man);
  options.program = &tree.parent();
  command.add_option("FOLDER", options.folder, "where they go; pages of the same names are replaced").required();
}

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

std::string compiler() {
#if defined(__clang__)
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

// 10.2.1 from its parts in one number: major * 10000 + minor * 100 + patch, for example.
std::string dotted(long number, long major, long minor) {
  return fmt::format("{}.{}.{}", number / major, number / minor % (major / minor), number % minor);
}

std::string built_with() {
  const std::string type = JND_BUILD_TYPE, sanitizers = JND_SANITIZERS;
  return fmt::format("built with {}, {}{}", compiler(), type.empty() ? "no build type" : type,
                     sanitizers.empty() ? "" : ", sanitizers " + sanitizers);
}

// Libraries that the loader brings: what runs now may be newer than what was there when this was compiled.
std::string linked_libraries() {
  return fmt::format("linked: SQLite {}, hidapi {}, zstd {}, libsodium {}", sqlite3_libversion(), hid_version_str(),
                     ZSTD_versionString(), sodium_version_string());
}

std::string compiled_libraries() {
  return fmt::format(
      "compiled: Boost {}, nlohmann_json {}.{}.{}, Eigen {}.{}.{}, fmt {}, CLI11 {}, SQLiteCpp {}, "
      "simdjson {}, md4c {}, ncurses {}",
      dotted(BOOST_VERSION, 100'000, 100), NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
      NLOHMANN_JSON_VERSION_PATCH, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
      dotted(FMT_VERSION, 10'000, 100), CLI11_VERSION, dotted(SQLITECPP_VERSION_NUMBER, 1'000'000, 1'000),
      JND_SIMDJSON_VERSION, JND_MD4C_VERSION, JND_NCURSES_VERSION);
}

// "jnd 0.1.0" on the first line, for scripts; below it how it was built, and the libraries. Those that are linked
// when the program starts say their versions themselves; the others were read when it was compiled.
std::string version_text() {
  return fmt::format("jnd {}\n  {}\n  {}\n  {}\n", kVersion, built_with(), linked_libraries(), compiled_libraries());
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
