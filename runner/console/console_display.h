// What a console can put before the operator's eyes: a full screen, or lines. What is shown and when is the same for
// both and stands in session_console.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runner/console/console.h"
#include "runner/console/console_keys.h"
#include "runner/console/force_trace.h"
#include "runner/console/questionnaire_page.h"
#include "runner/keys/line_editor.h"

namespace jnd {

// What a part of the screen stands for, and has its colour from.
enum class Shade {
  none,       // the terminal's own colours
  real,       // a session that counts as data
  rehearsal,  // one that does not
  question,   // an answer is due
  say,        // words for the participant
  warning,    // something is to be seen to
  stop        // the devices give nothing
};

enum class Tone { plain, strong, quiet, warning };

struct TonedLine {
  Tone tone = Tone::plain;
  std::string text;
};

// What the session stands at, and the keys that work there.
struct Scene {
  Tone tone = Tone::strong;  // of the heading
  std::string heading{};     // "Trial 3 of 16"
  std::string beside{};      // more about it, in a normal tone
  std::string text{};        // to be read: an instruction, a consent; may be long, with line ends
  std::vector<KeyHint> keys{};
  std::string task{};    // what the operator is to do, in the place of heading and beside; lines do without
  bool to_read = false;  // the keys answer the text: not before it was seen (Display::unread)
};

// What goes on now, in a word that is read from afar, and its time.
struct Phase {
  std::string word{};              // "FIRST", "GAP", "QUESTION", "PAUSED"
  std::string more{};              // "no contact yet"
  std::optional<double> left_s{};  // counts down
  double total_s = 0;              // of the countdown
  std::int64_t since_ns = 0;       // counts up, from this time of the machine's steady clock; 0: it does not
  bool holds = false;              // until a person goes on: the end of the session moves with it
  Shade shade = Shade::say;
};

// A stop that is latched.
struct StopShown {
  std::string by;             // "key"
  std::int64_t since_ns = 0;  // of the machine's steady clock
};

// Of this run of the session.
struct AnswerCounts {
  int voids = 0;
  int no_contact = 0;  // the latest attempts that were voided because nothing was touched, in a row
};

// "Trial 5 of 16": how far the session is. A trial that did not count and the one after it have the same number; what
// tells them apart is the plan's.
std::string trial_heading(const TrialOutline& outline);

// Texts are printable (runner/terminal/terminal.h) but for the line ends of Scene::text. Thread rule: the session's
// thread only.
class Display {
 public:
  virtual ~Display() = default;
  virtual void begin(const SessionCard& card) = 0;
  virtual void end(const std::string& last_words) = 0;
  virtual void announce(const std::string& text, bool warning) = 0;

  virtual void scene(const Scene& scene) = 0;
  // The keys of the scene once more: after a dialog, or when a key was let go.
  virtual void keys_again() = 0;
  // Keys that are heard while the session works: on a screen they are seen at a glance.
  virtual void working_keys(const std::vector<KeyHint>&) {}
  // The cue. words: what to say to the participant, or where it is not to be said aloud the name of what begins.
  virtual void say(CuePlace place, const std::string& words, bool aloud, bool beep) = 0;
  virtual void feedback(const std::string& words) = 0;                            // to say to the participant
  virtual void tell(Tone tone, const std::string& text) = 0;                      // what happened
  virtual void explain(Tone tone, const std::string& text) { tell(tone, text); }  // about a key, until the next one
  // The last one, which is saved. trial: "trial 5". What was told before this trial has gone with it.
  virtual void answer(const std::string& trial, const std::string& words, const std::string& by) = 0;
  virtual void answer_taken_back() {}
  virtual void outline(const TrialOutline&) {}
  virtual void phase(const Phase&) {}
  // What was asked for and comes later: "pause after this trial". Empty: nothing is.
  virtual void queued(const std::vector<std::string>&) {}
  // For the log pane: what lines do not print.
  virtual void log(const std::string&) {}
  virtual void counts(const AnswerCounts&) {}
  // The devices give nothing, from now on; none: it is cleared.
  virtual void stopped(const std::optional<StopShown>&) {}
  // What is left of the session, with its questions and breaks.
  virtual void time_left(double) {}
  // The terminal's bell, where the operator is to look up.
  virtual void alert() {}
  virtual void progress(const std::vector<ConditionProgress>&) {}
  virtual void health(const DeviceHealth&) {}
  // Of a technician's view, as often as health. The trace outlives the display.
  virtual void forces(const ForceTrace&) {}
  virtual void countdown(const std::string& what, double left_s, double total_s) = 0;
  virtual void countdown_over() {}

  // A line that is being typed. done: it is finished or given up.
  virtual void field(const std::string& label, const LineEditor& editor) = 0;
  virtual void field_done() = 0;
  // A choice by single keys.
  virtual void ask(const std::string& question, const std::vector<KeyHint>& keys) = 0;
  virtual void asked() {}

  virtual void page(const QuestionnairePage& page) = 0;
  virtual void page_done() {}

  // Puts up the page of the keys that work now, over what is shown, or takes it away; false: there was nothing to do.
  virtual bool help(bool /*on*/) { return false; }
  // Texts for the participant in large letters, or no longer.
  virtual void enlarge() {}
  // Some times a second while anything waits.
  virtual void refresh() {}
  // Up, down, page up, page down in a long text; false where there is nothing to scroll.
  virtual bool scroll(KeyName) { return false; }
  // Why what is to be read, a text, a page of questions or a dialog, cannot be answered yet: some of it was not seen,
  // or the window is too small for it. Empty: it can.
  virtual std::string unread() { return {}; }
  // Answers come as lines, asked one after the other.
  virtual bool by_lines() const noexcept = 0;
};

}  // namespace jnd
