#include "runner/commands/care_commands.h"

#include <memory>

#include <CLI/CLI.hpp>

#include "runner/keys/interrupt.h"

namespace jnd {

namespace {

// Everything that the arguments fill in; it lives as long as the parser.
struct Arguments {
  NoteOptions note;
  ExcludeOptions exclude;
  UnblindOptions unblind;
  BackupOptions backup;
  MergeOptions merge;
  RecoverOptions recover;
};

}  // namespace

void add_care_commands(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<Arguments>();
  const auto add = [&](const char* name, const char* what, const std::string& example, std::function<int()> run,
                       bool& json) {
    CLI::App* command = app.add_subcommand(name, what);
    command->footer("Example:\n  " + example);
    command->add_flag("--json", json, "machine-readable");
    command->callback([&chosen, arguments, run = std::move(run)] {
      chosen = holding_interrupts(run);  // each of them writes
    });
    return command;
  };

  NoteOptions& note = arguments->note;
  CLI::App* command = add(
      "note", "Write a note into a study", "jnd note s.sqlite \"lab repainted\" --participant P01",
      [&note] { return command_note(note); }, note.json);
  command->add_option("STUDY", note.study, "the study's file")->required();
  command->add_option("TEXT", note.text, "what there is to say")->required();
  command->add_option("--participant", note.participant, "the participant that it is about");

  ExcludeOptions& exclude = arguments->exclude;
  command = add(
      "exclude", "Leave a participant out of every analysis; nothing is deleted",
      "jnd exclude s.sqlite --participant P03 --reason \"felt ill\" --replace",
      [&exclude] { return command_exclude(exclude); }, exclude.json);
  command->add_option("STUDY", exclude.study, "the study's file")->required();
  command->add_option("--participant", exclude.participant, "the participant's code")->required();
  command->add_option("--reason", exclude.reason, "why, in a few words")->required();
  command->add_option("--kind", exclude.kind, "kind of sessions (default: the only one that the participant has)")
      ->check(CLI::IsMember({"real", "pilot", "simulated"}));
  command->add_flag("--replace", exclude.replace, "the number is free again: the next newcomer gets the same plan");

  UnblindOptions& unblind = arguments->unblind;
  command = add(
      "unblind", "Show real results as they are, before the study is complete",
      "jnd unblind s.sqlite --reason \"interim safety check\"", [&unblind] { return command_unblind(unblind); },
      unblind.json);
  command->add_option("STUDY", unblind.study, "the study's file")->required();
  command->add_option("--reason", unblind.reason, "why, in a few words")->required();

  BackupOptions& backup = arguments->backup;
  command = add(
      "backup", "Copy a study, also while a session runs, and verify the copy",
      "jnd backup s.sqlite --to /media/usb/s-backup.sqlite", [&backup] { return command_backup(backup); }, backup.json);
  command->add_option("STUDY", backup.study, "the study's file")->required();
  command->add_option("--to", backup.to, "the file to write")->required();
  command->add_flag("--replace", backup.replace, "replace an earlier backup, when the new one is whole");

  MergeOptions& merge = arguments->merge;
  command = add(
      "merge", "Bring studies of one protocol together in a new one",
      "jnd merge lab-a.sqlite lab-b.sqlite --to both.sqlite", [&merge] { return command_merge(merge); }, merge.json);
  command->add_option("STUDIES", merge.studies, "two or more studies; they are not changed")
      ->required()
      ->expected(2, 64);
  command->add_option("--to", merge.to, "the new study's file")->required();

  RecoverOptions& recover = arguments->recover;
  command = add(
      "recover", "Save what can be read of a damaged study, to the last whole event, in a new one",
      "jnd recover damaged.sqlite --to saved.sqlite", [&recover] { return command_recover(recover); }, recover.json);
  command->add_option("DAMAGED", recover.damaged, "the damaged file; it is not changed")->required();
  command->add_option("--to", recover.to, "the new study's file")->required();
  command->add_option("--protocol", recover.protocol, "the protocol's file, where the study's copy of it is lost");
}

}  // namespace jnd
