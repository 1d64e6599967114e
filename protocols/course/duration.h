// How long a session takes.
#pragma once

#include "protocols/protocol.h"

namespace jnd {

// Seconds from the first question to the last: cues and explorations, one round of practice, breaks, questions; free
// interaction for its set time.
// Assumed: first contact 0.7 s after a cue, an answer 1.5 s after the question, 10 s a question, no repeated trial.
double expected_duration_s(const Protocol& protocol);
// One trial, from its first cue to the next trial's.
double expected_trial_s(const Protocol& protocol);

}  // namespace jnd
