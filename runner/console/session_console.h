// What the operator is asked and told, in which order, on whichever display: prompts, dialogs, answers, pages.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runner/console/console.h"
#include "runner/console/console_display.h"
#include "runner/console/console_input.h"
#include "runner/console/force_trace.h"
#include "runner/console/session_phases.h"

namespace jnd {

class SessionConsole final : public Console, private Responder {
 public:
  SessionConsole(const ConsoleOptions& options, const Protocol& protocol, Keyboard* keyboard, Clock& clock,
                 const Interrupts& interrupts, std::unique_ptr<Display> display);

  Responder& responder() override { return *this; }
  void begin(const SessionCard& card) override;
  void announce(const std::string& text, bool warning) override;
  bool confirm(const std::string& question) override;
  std::string ask_text(const std::string& question) override;
  void end(const std::string& last_words) override;

  OperatorRequest ready(const TrialOutline& outline) override;
  OperatorRequest meanwhile() override;
  OperatorRequest paused(const std::string& cause) override;
  void progress(const std::vector<ConditionProgress>& by_condition) override;
  void time_left(double left_s) override { display_->time_left(left_s); }
  bool gap(double left_s, double total_s) override;
  void health(const DeviceHealth& health) override;
  void cue(CuePlace place, const CueSignal& cue) override;
  OperatorRequest hand_over(const HandOver& what) override;
  void saved(const TrialOutline& outline, const Answer& answer) override;
  void off_prescription(const TrialOutline& outline) override;
  void not_as_asked(const Deliveries& deliveries) override;
  void voided(const TrialOutline& outline, const std::string& reason, bool will_repeat) override;
  void took_back(bool will_repeat) override;
  bool waiting(double left_s, double total_s) override;
  OperatorRequest recover(const std::string& stopped_by) override;
  OperatorRequest missing(const std::string& what, const std::function<bool()>& back) override;
  bool storage_trouble(const std::string& message) override;
  void feedback(bool correct) override;
  void practice_over(int rounds, double share_correct, bool passed) override;
  void break_begins(const Break& pause, bool asked_by_operator) override;
  OperatorRequest break_over(const Break& pause) override;
  OperatorRequest instruct(const Instruction& instruction) override;
  std::optional<bool> consent(const std::string& text) override;
  OperatorRequest ready_to_explore(const ExplorationOutline& outline) override;
  bool exploring(double left_s) override;
  void explored() override;

 private:
  std::optional<Answer> judge(const TrialQuestion& question) override;
  bool enough(const IntervalId& id, double elapsed_s) override;
  std::optional<Answer> stopped_unanswered();
  // Typed, where the task is answered with a number.
  std::optional<Answer> judge_number(const TrialQuestion& question);
  std::optional<std::string> reply(const Question& question, int condition) override;
  std::optional<Replies> reply_all(const std::vector<AskedQuestion>& page) override;

  // What participants are to be told before this trial; empty: they have heard it.
  std::string words_before(const TrialOutline& outline);
  // Shows a scene and waits for one of its keys. Pauses, stops and ends come back as requests. over: asked some 50 times
  // a second; true ends it as go_on.
  OperatorRequest request_at(const Scene& scene, const KeyMap& keys, bool pausable,
                             const std::function<bool()>& over = {});
  void show(const Scene& scene);
  // Says what the keys are after another one was pressed.
  void explain(const KeyMap& keys, const Key& pressed);
  // Whether what is to be read was not all seen yet, of which the operator is told; turns_page: instead it is scrolled.
  bool still_to_read(bool turns_page = false);
  // Something comes before the answer that is waited for.
  bool interrupted() const noexcept { return keys_.ended() || keys_.pause_asked() || keys_.stopped(); }
  // Until the operator has read it.
  void acknowledge(const std::string& heading, const std::string& text);
  // What a key asks for, after its dialog; none where the operator thought better of it.
  std::optional<OperatorRequest> request_of(const KeyBinding& key, const KeyMap& keys);
  std::optional<OperatorRequest> with_reason(Request request, const std::string& label);
  std::optional<OperatorRequest> ask_end();
  // One of the keys; 0 for Escape and where the session is to end.
  char32_t choose(const std::string& question, const std::vector<KeyHint>& keys);
  void help(const KeyMap& keys);
  // Keys pressed while nothing was asked: what they mean, for later.
  void note_requests(const std::vector<Key>& keys, const KeyMap& map);
  // During a trial: what was pressed so far is noted, and the operator told when it is done.
  void hear_in_trial();
  void note_in_trial(const std::vector<Key>& keys);
  // What the devices do, where the operator may see it. over: the presentation is.
  void show_forces(bool over);
  // What is noted, on the screen.
  void tell_queued();
  std::optional<OperatorRequest> noted_request(const KeyMap& keys);
  // pressed_ns: on the machine's monotonic clock.
  Answer answer_of(GivenAnswer given, EnteredBy who, std::int64_t pressed_ns) const;
  std::optional<Answer> question_over(const std::optional<Answer>& answer, double time_out_s);
  // What the participant's buttons say to the question.
  struct ButtonReply {
    std::optional<Answer> answer;
    bool pending = false;  // a press that has yet to stay alone
    bool stopped = false;
  };
  ButtonReply hear_buttons();
  // What happened to the button box.
  void tell_events();
  // False: it was left.
  bool ask_by_keys(QuestionnairePage& page);
  bool ask_by_lines(QuestionnairePage& page);
  bool leaves_page();
  // Tells those who listen beside the screen.
  void happened(std::string_view moment);
  // A request that was waited for in such a moment: it is over.
  OperatorRequest over(std::string_view moment, const std::function<OperatorRequest()>& ask);
  bool heard(CuePlace place, const CueSignal& cue) const;

  ConsoleOptions options_;
  const Protocol& protocol_;
  Keyboard* keyboard_;
  Clock& clock_;
  std::optional<ForceTrace> forces_;  // where the operator may see them; outlives the display
  std::unique_ptr<Display> display_;
  SessionPhases phases_;
  PromptKeys keys_;
  KeyMap question_keys_;
  std::string announced_;  // before the screen came
  bool warned_ = false;
  Scene scene_;                             // the latest
  std::string last_answered_;               // "trial 5 (plan no. 13)"; empty: none of this run
  std::int64_t looked_ns_ = 0;              // at the keys between trials and in a gap, of the machine's clock
  std::vector<KeyBinding> noted_;           // asked for while nothing could be done about it
  std::optional<OperatorRequest> decided_;  // what meanwhile() is to say
  std::int64_t cue_shown_ns_ = 0;           // the question's, of clock_
  Scene break_scene_;
  double exploring_s_ = 0;                   // length of the free interaction that goes on
  std::optional<KeyBinding> broken_off_by_;  // of it: what meanwhile() is to ask about
  std::vector<std::string> unfinished_;      // what was typed on a page that a pause or a dialog broke off
  std::vector<std::string> unfinished_ids_;
  AnswerCounts counts_;
  bool presenting_ = false;   // an interval is being felt
  bool asks_enough_ = false;  // of that interval, which a key ends
  std::string prescribed_;    // what was said last, with its round of practice and block
  bool exploring_ = false;    // an object of free interaction is
};

}  // namespace jnd
