// jnd init: asks what a protocol is to be, and writes it.
#include <iostream>

#include <fmt/format.h>

#include "runner/commands/commands.h"
#include "runner/commands/new_protocol.h"
#include "runner/commands/protocol_wizard.h"
#include "runner/commands/readable_json.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

struct InitOptions {
  std::string file;  // to write; asked for where empty
};

int command_init(const InitOptions& options) {
  fmt::print("Enter takes what stands in [brackets]; Ctrl-C leaves, and nothing is written.\n\n");
  ProtocolWizard wizard(std::cin);
  const std::filesystem::path file = wizard.ask_file(options.file);
  const StartingPoint point = wizard.ask();
  const HoldInterrupts hold;  // until here a signal has ended the program
  const std::string name = file.string();
  write_new_protocol(file, readable_json(starting_protocol(point)),
                     fmt::format("the task {} on the rig {}", to_string(point.task), point.rig));
  if (!report_check(name)) return exit_code::kInvalidInput;
  fmt::print(
      "\nNext:\n"
      "  jnd plan {0} --participant P01\n"
      "  jnd run {0} --study rehearsal.sqlite --participant P01 --fast{2}\n"
      "  jnd simulate {0} --participants {1} --study simulated.sqlite --seed 1\n",
      shell_word(name), *filled_in(point).participants, point.rig == kSpecimenRig ? " --kind pilot" : "");
  return exit_code::kDone;
}

}  // namespace

void add_init(CommandTree& tree) {
  const auto [command, options] =
      tree.add("init", "Ask what a study is to be, and write its protocol", "jnd init my-study.json", command_init);
  command.add_option("FILE", options.file, "the file to write; it must not exist (default: asked for)");
}

}  // namespace jnd
