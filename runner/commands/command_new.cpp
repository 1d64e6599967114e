// jnd new: a protocol to start from, a copy of a shipped one or a small one of any task; and which ones are shipped.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "protocols/input/read_file.h"
#include "protocols/input/resources.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"
#include "runner/commands/commands.h"
#include "runner/commands/new_protocol.h"
#include "runner/commands/starting_protocol.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

struct NewOptions {
  std::string file;       // to write
  std::string from;       // a shipped protocol
  std::string task;       // instead: of this task,
  std::string rig;        // on this rig, by default rrs3,
  std::string procedure;  // with this procedure, by default constant
  bool list = false;
  bool json = false;
};

constexpr const char* kTutorial = "tutorial";

std::vector<Protocol> shipped_protocols() {
  std::vector<Protocol> protocols;
  for (const std::string& name : shipped_names(Resource::protocol))
    protocols.push_back(load_protocol(find_resource(Resource::protocol, name)));
  return protocols;
}

// Every shipped protocol on a line, under its task.
void print_list() {
  const std::vector<Protocol> protocols = shipped_protocols();
  std::size_t width = 0;
  for (const Protocol& protocol : protocols) width = std::max(width, protocol.name.size());
  std::size_t rig_width = 0;
  for (const Protocol& protocol : protocols) rig_width = std::max(rig_width, protocol.rig.device.size());
  for (const Task* task : all_tasks()) {
    fmt::print("{}: {}\n", bold(to_string(task->kind())), task->summary());
    for (const Protocol& protocol : protocols)
      if (protocol.task.kind == task->kind())
        fmt::print("  {:{}}  {:{}}  {}\n", protocol.name, width, protocol.rig.device, rig_width,
                   printable(protocol.title));
    fmt::print("\n");
  }
  fmt::print(
      "Copy one:                        jnd new my-study.json --from {}\n"
      "A small one of a task and a rig: jnd new my-study.json --task which --rig external\n",
      kTutorial);
}

void print_list_json() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Protocol& protocol : shipped_protocols())
    list.push_back({{"name", protocol.name},
                    {"task", to_string(protocol.task.kind)},
                    {"rig", protocol.rig.device},
                    {"title", protocol.title},
                    {"source", protocol.source.citation},
                    {"adaptive", !levels_given(protocol)}});
  print_json(list);
}

std::vector<std::string> words_of_procedures() {
  std::vector<std::string> words = {"constant"};
  for (const auto& [word, kind] : procedure_words()) words.emplace_back(word);
  return words;
}

std::vector<std::string> words_of_tasks() {
  std::vector<std::string> words;
  for (const Task* task : all_tasks()) words.emplace_back(to_string(task->kind()));
  return words;
}

std::vector<std::string> words_of_rigs() {
  std::vector<std::string> words;
  for (const StartingRig& rig : starting_rigs()) words.emplace_back(rig.name);
  return words;
}

int command_new(const NewOptions& options) {
  if (options.list) {
    if (!options.file.empty()) throw UsageError("--list writes nothing: leave the file out");
    options.json ? print_list_json() : print_list();
    return exit_code::kDone;
  }
  if (options.json) throw UsageError("--json belongs to --list");
  if (options.file.empty()) throw UsageError("say which file to write, or --list for what is shipped");
  if (options.task.empty() && !(options.rig.empty() && options.procedure.empty()))
    throw UsageError("--rig and --procedure belong to --task");
  const HoldInterrupts hold;
  const std::string name = options.from.empty() ? kTutorial : options.from;
  const std::filesystem::path file = protocol_file(options.file);
  std::string bytes, what;
  if (options.task.empty()) {
    bytes = read_input_file(find_resource(Resource::protocol, name));
    what = fmt::format("a copy of {}", printable(name));
  } else {
    StartingPoint point;
    point.task = *task_kind_from(options.task);
    if (!options.rig.empty()) point.rig = options.rig;
    if (!options.procedure.empty()) point.procedure = options.procedure;
    bytes = readable_json(starting_protocol(point));
    what = fmt::format("the task {} on the rig {}", options.task, point.rig);
  }
  write_new_protocol(file, bytes, what);
  fmt::print("  edit it, then:  jnd check {}\n", shell_word(file.string()));
  return exit_code::kDone;
}

}  // namespace

void add_new(CommandTree& tree) {
  const auto [command, options] = tree.add("new", "Write a protocol to start from",
                                           "jnd new my-study.json --task which --rig external", command_new);
  command.add_option("FILE", options.file, "the file to write; it must not exist");
  const CommandOption from =
      command.add_option("--from", options.from, "the shipped protocol to copy (default: tutorial)");
  command.add_option("--task", options.task, "instead a small one of this task")
      .one_of(words_of_tasks())
      .excludes(from);
  command.add_option("--rig", options.rig, "with --task: what presents the stimuli (default: rrs3)")
      .one_of(words_of_rigs());
  command.add_option("--procedure", options.procedure, "with --task: what sets the levels (default: constant)")
      .one_of(words_of_procedures());
  command.add_flag("--list", options.list, "which protocols are shipped, by task");
  command.add_flag("--json", options.json, "with --list: as JSON");
}

}  // namespace jnd
