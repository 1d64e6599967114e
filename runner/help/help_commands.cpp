#include "runner/help/help_commands.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "data/files/draft.h"
#include "runner/help/command_page.h"
#include "runner/help/completions.h"
#include "runner/help/help_text.h"
#include "runner/help/manual.h"
#include "runner/help/usage_error.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

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

constexpr std::size_t kWidest = 100;  // columns that are still read with ease

}  // namespace

std::string help_of(const CLI::App& command) {
  const auto columns = static_cast<std::size_t>(std::max(terminal_width(), 0));
  const std::size_t width = std::min(columns, kWidest);
  const std::string text = help_text(command_page(command), width);
  return command.get_parent() == nullptr ? text + program_closing(width) : text;
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

}  // namespace jnd
