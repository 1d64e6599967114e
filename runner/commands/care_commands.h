// Looking after a study: note, exclude, unblind, backup, merge, recover. runner/commands/care_commands.cpp turns
// arguments into these options.
//
// Each command returns the exit code and prints to stdout. They throw InputError, StorageError and UsageError.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace jnd {

// Adds the commands. chosen becomes the one that the arguments name.
void add_care_commands(CLI::App& app, std::function<int()>& chosen);

struct NoteOptions {
  std::string study, text;
  std::optional<std::string> participant;
  bool json = false;
};
int command_note(const NoteOptions& options);

struct ExcludeOptions {
  std::string study, participant, reason;
  std::optional<std::string> kind;  // of sessions; the only one that the participant has, where not given
  bool replace = false;             // the number is free again
  bool json = false;
};
int command_exclude(const ExcludeOptions& options);

struct UnblindOptions {
  std::string study, reason;
  bool json = false;
};
int command_unblind(const UnblindOptions& options);

struct BackupOptions {
  std::string study, to;
  bool replace = false;
  bool json = false;
};
int command_backup(const BackupOptions& options);

struct MergeOptions {
  std::vector<std::string> studies;
  std::string to;
  bool json = false;
};
int command_merge(const MergeOptions& options);

struct RecoverOptions {
  std::string damaged, to;
  std::optional<std::string> protocol;  // a file, where the study's own copy is lost
  bool json = false;
};
int command_recover(const RecoverOptions& options);

}  // namespace jnd
