// A participant as a command line names one: by the code of the person ("P01"), or by a number ("1").
//
// A code is whose session it is, a number the place in the plan. Simulated participants have code P07 for number 7; people
// get the lowest number that is free when they begin, whatever their code. So a number alone is read as the code that jnd
// writes for it where a person is meant, and as a place where a plan is.
#pragma once

#include <string>
#include <vector>

#include "data/study/study.h"

namespace jnd {

// The person who is meant: the text where a session has that code, else of one to three digits the code that jnd writes
// for the number, "P07" for 7. So `--participant 1` and `--participant P01` are one person, and codes of a laboratory's
// own, also of digits, stay as they are.
std::string participant_meant(const std::string& text, const std::vector<SessionInfo>& sessions);

// The place in the plan that is meant, from 1: a number, or the code of one who has a session in the study; without
// sessions P07 is 7. Throws UsageError where it is none, or may be two.
int plan_number_meant(const std::string& text, const std::vector<SessionInfo>& sessions);

// Whose place it is, for headings: "participant P07"; in a study, with its sessions, "participant P03, number 2 of the
// plan", or "number 5 of the plan, which nobody has yet".
std::string participant_title(int number, const std::vector<SessionInfo>* sessions);

}  // namespace jnd
