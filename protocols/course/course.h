// The course of a session, said once: what comes after what, and what is next where a session stands. The session that
// runs, the one that is taken up again after any interruption, and the estimate of how long one takes all ask here.
// (jnd verify --deep tells the course a second time, on purpose: data/verify/verify_course.h.)
//
// What is next follows from protocol, plan and the events so far alone. First what an interruption left behind: answers
// that come anew, a stimulus that was felt and has no answer. Then checklist, instructions, consent, questions,
// practice, and the main part, block by block: trials never tried in the planned order, then the voided ones in the
// order in which they failed; after the last one of a block its questions, and the break behind it.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "protocols/course/session_state.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/plan.h"
#include "protocols/protocol.h"

namespace jnd {

// A block of the main part; of free interaction, a condition's turn.
struct CourseBlock {
  std::size_t begin = 0, end = 0;  // places in Plan::trials, or in Plan::explorations
  int planned = 0;                 // trials, or slots, that the plan has by its end: the place that keys questions and
                                   // breaks, the same however many trials were repeated or given up
  int condition = 0;               // of its last trial
  bool one_condition = true;       // blocked designs, and free interaction
  bool series_over = false;        // no other block of its series follows
  bool last = false;
};
std::vector<CourseBlock> course_blocks(const Protocol& protocol, const Plan& plan);
// The same of every participant's plan, from the protocol alone: the most trials, and each condition in its own place.
// Of groups, the one with the most conditions.
std::vector<CourseBlock> course_blocks(const Protocol& protocol);

// Questions that are answered together, as a page.
struct CoursePage {
  Question::When when = Question::When::before_session;
  int condition = -1;   // that the page is about, or -1
  int after_trial = 0;  // CourseBlock::planned; 0 before and after the session
  bool operator==(const CoursePage&) const = default;
};
struct AskedPlace {
  int question = 0;    // place in Protocol::questions
  int condition = -1;  // place in Protocol::conditions, or -1
  bool operator==(const AskedPlace&) const = default;
};
std::vector<CoursePage> pages_after(const CourseBlock& block);
// conditions: that the participant gets.
std::vector<AskedPlace> questions_on(const CoursePage& page, const Protocol& protocol,
                                     const std::vector<int>& conditions);

// The break at one place, the first that the protocol names; null where there is none. None comes after the last block.
const Break* break_after(const CourseBlock& block, const Protocol& protocol);
const Break* break_within_block(int main_done, const Protocol& protocol);

// What is next.
namespace step {
// An answer is taken back with its block or its practice round, which come anew.
struct TakeBack {
  int index = 0, attempt = 1;
  std::string_view reason;  // of the void
  bool operator==(const TakeBack&) const = default;
};
// A stimulus was felt and has no answer: it is voided, and comes again.
struct SettleTrial {
  int index = 0, attempt = 1;
  bool anew = false;
  bool operator==(const SettleTrial&) const = default;
};
struct CheckList {
  bool operator==(const CheckList&) const = default;
};
struct Instruct {
  int instruction = 0;  // place in Protocol::instructions
  bool operator==(const Instruct&) const = default;
};
struct AskConsent {
  bool operator==(const AskConsent&) const = default;
};
struct Ask {
  CoursePage page;
  std::vector<AskedPlace> questions;  // those without an answer
  bool operator==(const Ask&) const = default;
};
struct Present {
  Trial trial;  // with its stimuli known
  bool operator==(const Present&) const = default;
};
struct GiveUp {
  Trial trial;
  bool operator==(const GiveUp&) const = default;
};
struct EndPractice {
  int round = 1;
  double share_correct = 0;
  bool passed = false;
  bool operator==(const EndPractice&) const = default;
};
struct TakeBreak {
  int place = 0;        // in Protocol::breaks
  int after_trial = 0;  // that keys it
  bool operator==(const TakeBreak&) const = default;
};
struct SettleExploration {
  ExplorationSlot slot;
  int attempt = 1;
  bool operator==(const SettleExploration&) const = default;
};
struct Explore {
  ExplorationSlot slot;
  int attempt = 1;
  bool operator==(const Explore&) const = default;
};
struct Done {
  bool operator==(const Done&) const = default;
};
}  // namespace step
using Step = std::variant<step::TakeBack, step::SettleTrial, step::CheckList, step::Instruct, step::AskConsent,
                          step::Ask, step::Present, step::GiveUp, step::EndPractice, step::TakeBreak,
                          step::SettleExploration, step::Explore, step::Done>;

// Follows a session by its events, and knows what is next after each.
class Course {
 public:
  // protocol and plan must outlive it. person: checklist, instructions and consent are for people.
  Course(const Protocol& protocol, const Plan& plan, bool person);
  // Goes on from what a log says.
  void start(SessionState state);

  void apply(const CourseEvent& event);
  Step next_step() const;

  const SessionState& state() const noexcept { return state_; }
  // Of the block, or the practice round, of a trial: those still to do, in order.
  std::vector<Trial> left_of_block(const Trial& trial) const;
  // The last answer, where it may be taken back before `next`: of this practice round, or of the main part; one answer,
  // not one after the other.
  const TrialRecord* last_answer(const Trial& next) const;
  // The planned trial with the stimuli that it has if it is presented now.
  Trial resolved(const Trial& planned) const { return adaptive_.resolved(planned); }
  const Trial* planned(int index) const;  // null where the plan has none
  int next_attempt(int index) const;
  int next_exploration_attempt(int index) const;
  int attempts_used(int index) const;
  bool finished(int index) const;                                            // answered or given up
  bool over(const Trial& planned) const { return adaptive_.over(planned); }  // its track has its reversals
  bool exploration_over(int index) const;                                    // explored or given up
  int main_done() const noexcept { return main_done_; }                      // answered or given up
  int main_left() const;                               // at most so many where the answers may end a track
  int explorations_done() const;                       // explored or given up
  step::EndPractice end_of_practice(int round) const;  // with its share of correct answers so far
  int round_answered(int round) const;                 // of a practice round
  int practice_left() const;                           // trials of the round that is under way, or comes next

 private:
  struct Span {
    std::size_t begin = 0, end = 0;
  };
  struct Tally {
    int answered = 0, correct = 0;
  };
  void follow_answers();
  void follow(const TrialRecord& record);
  void finish(int index);
  void mark_failed(int index, bool failed);
  bool open(const Trial& planned) const { return !finished(planned.index) && !over(planned); }
  Span span_of(const Trial& trial) const;
  const Trial* first_open(Span block) const;
  std::optional<Step> left_behind() const;
  std::optional<Step> opening() const;
  std::optional<Step> practise() const;
  std::optional<Step> instruct(Instruction::When when) const;
  std::optional<Step> ask(const CoursePage& page) const;
  std::optional<Step> take_break(const Break* pause, int after_trial) const;
  std::optional<Step> after_block(const CourseBlock& block) const;
  std::optional<Step> main_part() const;
  std::optional<Step> free_interaction() const;
  Step present(const Trial& trial) const;

  const Protocol& protocol_;
  const Plan& plan_;
  bool person_;
  std::vector<CourseBlock> blocks_;
  std::vector<Span> rounds_;  // of practice, in Plan::trials
  SessionState state_;
  // What follows from it, kept so that a step need not look at every event.
  AdaptiveRun adaptive_;
  std::vector<char> finished_;   // by index: answered or given up
  std::vector<char> failed_;     // by index: in SessionState::void_order
  std::vector<Tally> practice_;  // by round, from 1
  int main_done_ = 0;
};

// The same at one moment: a pure function.
Step next_step(const Protocol& protocol, const Plan& plan, const SessionState& state, bool person);

}  // namespace jnd
