// The seam between an experiment and the person who answers: a keyboard, a button box, or a simulated participant.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/rig.h"
#include "protocols/protocol.h"
#include "protocols/vocabulary.h"

namespace jnd {

// What a responder is told when a trial's two intervals are over.
struct TrialQuestion {
  const Trial& trial;
  int attempt = 1;
  std::span<const Presentation> presentations;  // what was delivered, felt by simulated participants only
  double time_out_s = 0;
  int look = 0;  // from 0, where answers move a stimulus and the question comes again
};

struct AskedQuestion {
  const Question& question;
  int condition = -1;  // place in Protocol::conditions, or -1
};
using Replies = std::vector<std::optional<std::string>>;

class Responder {
 public:
  virtual ~Responder() = default;
  // None where no answer came within the time-out (or the operator interrupts: see the implementation).
  virtual std::optional<Answer> judge(const TrialQuestion& question) = 0;
  // Of an interval that a key ends: whether it has been felt enough. Asked some 20 times a second once it is touched;
  // elapsed_s: since it began.
  virtual bool enough(const IntervalId& /*id*/, double /*elapsed_s*/) { return false; }
  // The answer as text: a number in plain decimals, one of the options, or free text; none = skipped.
  // condition: the condition's place in Protocol::conditions, or -1.
  virtual std::optional<std::string> reply(const Question& question, int condition) = 0;
  // A page of questions, answered together: with a person one may go back and change until the page is done. In the
  // order of the questions; none where the session is to end.
  virtual std::optional<Replies> reply_all(const std::vector<AskedQuestion>& page) {
    Replies replies;
    for (const AskedQuestion& asked : page) {
      replies.push_back(reply(asked.question, asked.condition));
      if (!replies.back() && asked.question.required) return std::nullopt;
    }
    return replies;
  }
};

}  // namespace jnd
