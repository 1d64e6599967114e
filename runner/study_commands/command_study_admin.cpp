// jnd note, exclude and unblind: what is said about a study outside its sessions.
#include <cstdlib>
#include <filesystem>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "data/study/blinding.h"
#include "data/study/study_admin.h"
#include "protocols/planning/allotment.h"
#include "runner/keys/interrupt.h"
#include "runner/opening/participant_names.h"
#include "runner/opening/study_access.h"
#include "runner/study_commands/study_commands.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/study_variable.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

struct NoteOptions {
  std::string study, text;
  std::optional<std::string> participant;
  bool json = false;
};

struct ExcludeOptions {
  std::string study, participant, reason;
  std::optional<std::string> kind;  // of sessions; the only one that the participant has, where not given
  bool replace = false;             // the number is free again
  bool json = false;
};

struct UnblindOptions {
  std::string study, reason;
  bool json = false;
};

SessionKind kind_of_participant(const Study& study, const ExcludeOptions& options) {
  if (options.kind) return *session_kind_from(*options.kind);
  std::set<SessionKind> kinds;
  for (const SessionInfo& session : study.sessions())
    if (session.participant == options.participant) kinds.insert(session.kind);
  if (kinds.size() > 1) {
    std::string named;
    for (const SessionKind kind : kinds) named += fmt::format("{}{}", named.empty() ? "" : ", ", to_string(kind));
    throw UsageError(fmt::format("participant {} has sessions of several kinds ({}): say which with --kind",
                                 options.participant, named));
  }
  return kinds.empty() ? SessionKind::real : *kinds.begin();
}

// One word alone is the text, where the variable names the study; a file's name is hardly a note.
NoteOptions with_study_of_variable(NoteOptions options) {
  if (!options.text.empty()) return options;
  const char* const study = std::getenv(kStudyVariable);
  std::error_code error;
  if (study == nullptr || options.study == study || std::filesystem::exists(options.study, error))
    refuse_arguments("TEXT is required");
  if (options.study.find(' ') == std::string::npos && options.study.ends_with(".sqlite"))
    throw UsageError(fmt::format("{}: there is no such study, and the name of one is no note", options.study));
  options.text = std::exchange(options.study, study);
  print_message("jnd: the study is {} ({})\n", printable(options.study), kStudyVariable);
  return options;
}

int command_note(const NoteOptions& given) {
  const NoteOptions options = with_study_of_variable(given);
  const HoldInterrupts hold;
  require_sound(options.study);
  const std::unique_ptr<Study> study = Study::open(options.study, Study::Access::read_write);
  std::optional<std::string> participant = options.participant;
  if (participant) participant = participant_meant(*participant, study->sessions());
  add_note(*study, options.text, stamp_now(), participant);
  const Event event = study->study_events().back();
  study->close();
  if (options.json)
    print_json({{"study", options.study}, {"event", event.seq}, {"head", event.hash}});
  else
    fmt::print("{}: the note is event {} of the study\n", printable(options.study), event.seq);
  return exit_code::kDone;
}

int command_exclude(const ExcludeOptions& asked) {
  const HoldInterrupts hold;
  require_sound(asked.study);
  const std::unique_ptr<Study> study = Study::open(asked.study, Study::Access::read_write);
  ExcludeOptions options = asked;
  options.participant = participant_meant(asked.participant, study->sessions());
  const SessionKind kind = kind_of_participant(*study, options);
  exclude_participant(*study, options.participant, kind, options.reason, options.replace, stamp_now());
  const Event event = study->study_events().back();
  const Protocol protocol = protocol_of(*study);
  const bool given = operator_says_group(protocol);
  const int next = next_participant_number(study->sessions(), kind);
  study->close();
  if (options.json) {
    print_json({{"study", options.study},
                {"participant", options.participant},
                {"kind", to_string(kind)},
                {"replace", options.replace},
                {"next_participant_number", given ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(next)},
                {"event", event.seq},
                {"head", event.hash}});
    return exit_code::kDone;
  }
  fmt::print("{}: participant {} ({} sessions) is excluded, with your reason, as event {} of the study\n",
             printable(options.study), printable(options.participant), to_string(kind), event.seq);
  fmt::print("  Every analysis, export and report leaves this participant out from now on; nothing is deleted.\n");
  if (given)
    fmt::print("  The number {}.\n",
               options.replace ? "is free again, for a newcomer of the same group" : "stays taken");
  else if (options.replace)
    fmt::print("  The number is free again: the next newcomer gets number {}.\n", next);
  else
    fmt::print("  The number stays taken; the next newcomer gets number {}.\n", next);
  return exit_code::kDone;
}

int command_unblind(const UnblindOptions& options) {
  const HoldInterrupts hold;
  require_sound(options.study);
  const std::unique_ptr<Study> study = Study::open(options.study, Study::Access::read_write);
  if (!is_unblinded(*study) && !blinding_of(*study, protocol_of(*study), SessionKind::real).blinded)
    throw UsageError(fmt::format("{}: nothing in this study is blinded: its results are shown as they are",
                                 printable(options.study)));
  unblind(*study, options.reason, stamp_now());
  const Event event = study->study_events().back();
  study->close();
  if (options.json) {
    print_json({{"study", options.study}, {"unblinded", true}, {"event", event.seq}, {"head", event.hash}});
    return exit_code::kDone;
  }
  fmt::print("{}: is unblinded, with your reason, as event {} of the study\n", printable(options.study), event.seq);
  fmt::print(
      "  From now on everybody who opens it sees conditions, stimuli and results of real sessions by name.\n"
      "  It cannot be taken back, and reports say that it was done before the study was complete.\n");
  return exit_code::kDone;
}

}  // namespace

void add_note(CommandTree& tree) {
  const auto [command, options] = tree.add("note", "Write a note into a study",
                                           "jnd note s.sqlite \"lab repainted\" --participant P01", command_note);
  command.add_flag("--json", options.json, "machine-readable");
  command.add_option("STUDY", options.study, "the study's file").required();
  command.add_option("TEXT", options.text, "what there is to say; alone, where JND_STUDY names the study");
  command.add_option("--participant", options.participant,
                     "the participant that it is about: a code, or a number (1 is P01)");
}

void add_exclude(CommandTree& tree) {
  const auto [command, options] =
      tree.add("exclude", "Leave a participant out of every analysis; nothing is deleted",
               "jnd exclude s.sqlite --participant P03 --reason \"felt ill\" --replace", command_exclude);
  command.add_flag("--json", options.json, "machine-readable");
  command.add_option("STUDY", options.study, "the study's file").required();
  command.add_option("--participant", options.participant, "the participant's code, or a number: 3 is P03").required();
  command.add_option("--reason", options.reason, "why, in a few words").required();
  command.add_option("--kind", options.kind, "kind of sessions (default: the only one that the participant has)")
      .one_of({"real", "pilot", "simulated"});
  command.add_flag("--replace", options.replace, "the number is free again: the next newcomer gets the same plan");
}

void add_unblind(CommandTree& tree) {
  const auto [command, options] = tree.add("unblind", "Show real results as they are, before the study is complete",
                                           "jnd unblind s.sqlite --reason \"interim safety check\"", command_unblind);
  command.add_flag("--json", options.json, "machine-readable");
  command.add_option("STUDY", options.study, "the study's file").required();
  command.add_option("--reason", options.reason, "why, in a few words").required();
}

}  // namespace jnd
