// What the console calls things: trials, why one did not count, what is said where the protocol has no words.
#pragma once

#include <string>

#include "protocols/protocol.h"
#include "runner/session/session_view.h"

namespace jnd {

// "trial 5": as messages name it, which outlive its heading.
std::string name_of(const TrialOutline& outline);
// "trial 5 (plan no. 13)": where it could be mistaken. A trial that did not count and the one after it have the same number.
std::string full_name_of(const TrialOutline& outline);
// What stands beside the heading of a trial: "condition B  block 2 of 4  about 12 min left  plan no. 13".
std::string beside_heading(const TrialOutline& outline);
// Why a trial did not count; an unknown code as it is.
std::string reason_text(const std::string& reason);
// What is said where the protocol gives no words: "first sphere", "same or different?".
std::string usual_words(CuePlace place, const Protocol& protocol);
// Of what was said: "same", "second"; the names of classes (identify) are the protocol's own.
std::string shown_answer(const TaskSpec& task, int said);
// Of an interval, to be read from afar: "FIRST"; "FEEL" where it is the only one.
std::string interval_word(CuePlace place, const Protocol& protocol);
// "first: A7   second: B2"
std::string items_text(const HandOver& what);

}  // namespace jnd
