// What can happen in a session, and what has happened so far, as values: the state follows from the events alone, so
// that a session that runs and a replay of its log have the same.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocols/vocabulary.h"

namespace jnd {

// A stimulus that was presented to a person and has no answer.
struct PendingTrial {
  int index = 0;
  int attempt = 1;
  bool operator==(const PendingTrial&) const = default;
};

// Free interaction so far; slots are named by ExplorationSlot::index.
struct ExplorationHistory {
  std::map<int, int> attempts;  // highest attempt of a slot that began
  std::map<int, int> used;      // attempts that count against the protocol's most
  std::set<int> given_up;       // slots that do not come again
  std::optional<int> pending;   // slot that began, and neither ended nor was voided
  bool operator==(const ExplorationHistory&) const = default;
};

// What a log says has happened: where a session goes on.
struct SessionState {
  bool opened = false;
  bool closed = false;
  std::vector<TrialRecord> completed;  // in order; without those that were voided afterwards
  std::map<int, int> attempts;         // trial index -> attempts made so far, whatever became of them
  std::map<int, int> voided;           // trial index -> attempts used up: voided ones that count
  std::set<int> abandoned;             // trial indices whose attempts were used up, or whose block was ended
  std::vector<int>
      void_order;  // trial indices in the order in which they were voided (last time each); not those that come anew
  std::optional<PendingTrial> pending;  // began, with neither answer nor void
  bool practice_ended = false;
  bool practice_due = false;         // a resume asked for practice again, and none was answered since
  bool redo_due = false;             // a resume asked for the interrupted block anew, and no trial came since
  bool taken_back = false;           // the last answer was, and no other was given since
  std::set<std::string> checked;     // items of the checklist answered since the session was last taken up, by id
  std::set<std::string> answered;    // question_key of each
  std::set<std::string> instructed;  // instructions, by id
  bool consented = false;
  std::set<int> breaks_after;      // main trials done when a break was taken
  std::set<int> explored;          // ExplorationSlot::index of those completed
  ExplorationHistory exploration;  // what became of the attempts
  // How it was left.
  bool left = false;            // ended by the operator; otherwise the program was killed, or the machine
  bool ended_for_good = false;  // by the operator, or without consent: nothing of it is still to do but to close it
  std::string boot_id;          // of the machine's run in which the last part of the session ran; empty where unknown
  std::int64_t last_monotonic_ns = 0;
  std::int64_t last_utc_ns = 0;
};

// The events that change what is still to do. Notes, pauses and faults change nothing.
struct SessionOpened {
  std::string boot_id;
};
struct SessionResumed {
  std::string boot_id;
  bool redo_block = false;      // the interrupted block begins anew
  bool practice_again = false;  // the last practice round
};
struct SessionClosed {};
struct SessionLeft {
  bool for_good = false;
};
struct ItemChecked {
  std::string id;
};
struct InstructionShown {
  std::string id;
};
struct ConsentAsked {
  bool given = false;
};
struct QuestionAnswered {
  std::string key;  // question_key
};
struct BreakTaken {
  int after_trial = 0;
};
struct TrialBegan {
  int index = 0;
  int attempt = 1;
};
struct TrialAnswered {
  TrialRecord record;
};
// Also of a trial that was answered: the answer is taken back.
struct TrialVoided {
  int index = 0;
  int attempt = 1;
  bool counts = true;       // it uses up one of the trial's attempts
  bool anew = false;        // as if it had never been tried, in its planned place; otherwise at the end of its block
  bool taken_back = false;  // by the operator's word
};
// Its attempts are used up.
struct TrialGivenUp {
  int index = 0;
};
// The rest of a block, or of practice, is given up.
struct BlockEnded {
  std::vector<int> trials;  // indices
  bool practice = false;
};
struct PracticeEnded {};
struct ExplorationBegan {
  int index = 0;
  int attempt = 1;
};
struct ExplorationEnded {
  int index = 0;
  int attempt = 1;
};
struct ExplorationVoided {
  int index = 0;
  int attempt = 1;
  bool counts = true;
  bool will_repeat = true;
};

using CourseEvent =
    std::variant<SessionOpened, SessionResumed, SessionClosed, SessionLeft, ItemChecked, InstructionShown, ConsentAsked,
                 QuestionAnswered, BreakTaken, TrialBegan, TrialAnswered, TrialVoided, TrialGivenUp, BlockEnded,
                 PracticeEnded, ExplorationBegan, ExplorationEnded, ExplorationVoided>;

void apply(const CourseEvent& event, SessionState& state);

// Which asking of a question an answer belongs to: "id", "id/condition", and "@n" behind it where the question comes
// again in a session (n: main trials planned up to there; 0 before and after the session, where nothing is added).
std::string question_key(std::string_view id, std::string_view condition, int after_trial);

}  // namespace jnd
