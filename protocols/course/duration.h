// How long a session takes.
#pragma once

#include <optional>

#include "protocols/course/course.h"
#include "protocols/planning/plan.h"
#include "protocols/protocol.h"

namespace jnd {

// Seconds from the first question to the last: cues and explorations, one round of practice, breaks, questions; free
// interaction for its set time.
// Assumed: first contact 0.7 s after a cue, an answer 1.5 s after the question, 10 s a question, no repeated trial.
double expected_duration_s(const Protocol& protocol);
// What is left of a session that stands there, on the same assumptions: its trials, breaks, questions and free interaction.
// The same whatever the coming trials present. trial_s: a trial's length, where this participant's pace is known.
double expected_left_s(const Protocol& protocol, const Plan& plan, const Course& course,
                       std::optional<double> trial_s = std::nullopt);
// One trial, from its first cue to the next trial's.
double expected_trial_s(const Protocol& protocol);
// The part of it in which the devices are at work.
double expected_presented_s(const Protocol& protocol);

}  // namespace jnd
