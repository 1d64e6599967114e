// jnd backup, merge and recover: new files out of studies.
#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "data/copies/backup.h"
#include "data/copies/merge.h"
#include "data/copies/recover.h"
#include "data/fields/number_text.h"
#include "data/study/blinding.h"
#include "runner/keys/interrupt.h"
#include "runner/study_commands/blinded_problem.h"
#include "runner/study_commands/recovery_words.h"
#include "runner/study_commands/study_commands.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

struct BackupOptions {
  std::string study, to;
  bool replace = false;
  bool json = false;
};

struct MergeOptions {
  std::vector<std::string> studies;
  std::string to;
  bool json = false;
};

struct RecoverOptions {
  std::string damaged, to;
  std::optional<std::string> protocol;  // a file, where the study's own copy is lost
  bool json = false;
};

using Json = nlohmann::ordered_json;
using Align = TextTable::Align;

Json backup_json(const BackupOptions& options, const BackupReport& report) {
  Json out = {{"to", options.to},
              {"written", report.written},
              {"sessions", report.verified.sessions},
              {"events", report.verified.events},
              {"bytes", report.bytes},
              {"problems", report.verified.problems.size()},
              {"study_head", report.study_head},
              {"heads", Json::array()}};
  for (const SessionInfo& session : report.sessions)
    out["heads"].push_back({{"session", session.id},
                            {"participant", session.participant},
                            {"kind", to_string(session.kind)},
                            {"state", session.state},
                            {"head", session.head}});
  return out;
}

// In words, where a signal leaves the time to look whether the new study is sealed.
std::vector<std::string> problems_of(const RecoveryReport& report, const std::string& to) {
  try {
    return unsealed_problems(report.verified.problems, *Study::open(to, Study::Access::read_only));
  } catch (const Stopped&) {
    write_marked_message(fmt::format(
        "interrupted when {} was already written: it stays, and this is its report; jnd verify {} says all of its "
        "problems",
        to, shell_word(to)));
    return sealed_problems(report.verified.problems);
  }
}

int command_backup(const BackupOptions& options) {
  const HoldInterrupts hold;
  BackupReport report;
  {
    const WorkLine working("copying " + options.study);
    const std::unique_ptr<Study> study = Study::open(options.study, Study::Access::read_only);
    report = back_up(*study, options.to, options.replace, [] { return interrupt_requested().load(); });
    const bool sealed = !report.sessions.empty() && is_sealed(*study);
    for (SessionInfo& session : report.sessions) session.head = shown_head(session, sealed);
  }
  if (report.interrupted) {
    write_message("jnd: interrupted; nothing was written\n");
    return exit_code::kInterrupted;
  }
  if (options.json) {
    print_json(backup_json(options, report));
  } else if (report.written) {
    fmt::print("{}: {} and {}, verified, {} bytes\n", bold(printable(options.to)),
               counted(report.verified.sessions, "session"), counted(report.verified.events, "event"), report.bytes);
    TextTable table({"participant", "kind", "state", "head"}, {Align::left, Align::left, Align::left, Align::left});
    for (const SessionInfo& session : report.sessions)
      table.add({printable(session.participant), std::string(to_string(session.kind)), session.state, session.head});
    table.add({"(the study)", "", "", report.study_head});
    fmt::print("{}", table.text());
  } else {
    fmt::print("{}: was not written: verification finds {} in the study; jnd verify lists {}, jnd recover may help\n",
               printable(options.to), counted(static_cast<std::int64_t>(report.verified.problems.size()), "problem"),
               report.verified.problems.size() == 1 ? "it" : "them");
  }
  return report.written ? exit_code::kDone : exit_code::kProblemFound;
}

int command_merge(const MergeOptions& options) {
  const HoldInterrupts hold;
  const MergeReport report = [&options] {
    const WorkLine working("merging into " + options.to);
    return merge({options.studies.begin(), options.studies.end()}, options.to, stamp_now());
  }();
  if (options.json) {
    Json out = {{"to", options.to},
                {"sessions", report.verified.sessions},
                {"events", report.verified.events},
                {"sources", Json::array()}};
    for (const MergedSource& source : report.sources)
      out["sources"].push_back({{"file", source.file},
                                {"sessions", source.sessions},
                                {"events", source.events},
                                {"carried", source.imported},
                                {"unblinded", source.unblinded},
                                {"same_meaning", source.reworded}});
    print_json(out);
    return exit_code::kDone;
  }
  fmt::print("{}: {} and {}, verified\n", bold(printable(options.to)), counted(report.verified.sessions, "session"),
             counted(report.verified.events, "event"));
  for (const MergedSource& source : report.sources) {
    fmt::print("  {}: {}, {}; {} of the study itself go on to hold\n", printable(source.file),
               counted(source.sessions, "session"), counted(source.events, "event"), counted(source.imported, "event"));
    if (source.reworded)
      fmt::print("    its protocol is written differently and means the same; both files are kept\n");
    if (source.unblinded)
      fmt::print("{}\n", warn("    it was unblinded, and so the new study is unblinded as a whole"));
  }
  return exit_code::kDone;
}

int command_recover(const RecoverOptions& options) {
  const HoldInterrupts hold;
  std::optional<std::filesystem::path> protocol;
  if (options.protocol) protocol = *options.protocol;
  const RecoveryReport report = [&] {
    const WorkLine working("recovering " + options.damaged);
    return recover(options.damaged, options.to, protocol, stamp_now());
  }();
  const std::vector<std::string> problems = problems_of(report, options.to);
  const RecoveryFiles files{options.damaged, options.to};
  if (options.json)
    print_json(recovery_json(files, report, problems));
  else
    fmt::print("{}", recovery_text(files, report, problems, table_width()));
  return report.whole() ? exit_code::kDone : exit_code::kProblemFound;
}

}  // namespace

void add_backup(CommandTree& tree) {
  const auto [command, options] = tree.add("backup", "Copy a study, also while a session runs, and verify the copy",
                                           "jnd backup s.sqlite --to /media/usb/s-backup.sqlite", command_backup);
  command.add_flag("--json", options.json, "machine-readable");
  command.add_option("STUDY", options.study, "the study's file").required();
  command.add_option("--to", options.to, "the file to write").required();
  command.add_flag("--replace", options.replace, "replace an earlier backup, when the new one is whole");
}

void add_merge(CommandTree& tree) {
  const auto [command, options] = tree.add("merge", "Bring studies of one protocol together in a new one",
                                           "jnd merge lab-a.sqlite lab-b.sqlite --to both.sqlite", command_merge);
  command.add_flag("--json", options.json, "machine-readable");
  command.add_option("STUDIES", options.studies, "two or more studies; they are not changed").required().values(2, 64);
  command.add_option("--to", options.to, "the new study's file").required();
}

void add_recover(CommandTree& tree) {
  const auto [command, options] =
      tree.add("recover", "Save what can be read of a damaged study, to the last whole event, in a new one",
               "jnd recover damaged.sqlite --to saved.sqlite", command_recover);
  command.add_flag("--json", options.json, "machine-readable");
  command.add_option("DAMAGED", options.damaged, "the damaged file; it is not changed").required();
  command.add_option("--to", options.to, "the new study's file").required();
  command.add_option("--protocol", options.protocol, "the protocol's file, where the study's copy of it is lost");
}

}  // namespace jnd
