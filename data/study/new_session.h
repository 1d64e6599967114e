// What a study asks of a session before it takes it, and how the session's first event reads. Inside of this wing.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "data/study/study_impl.h"

namespace jnd {

// Throws StorageError where the participant's code or the session's name cannot be used, the session or its number
// exists already, the participant was excluded, or a number would be of two participants.
void require_admissible(const NewSession& session, const Study::Impl& study);

// The body of session.opened. study_head: of the study's own chain just now.
nlohmann::ordered_json opened_body(const NewSession& session, const StudyInfo& study, const std::string& study_head);

}  // namespace jnd
