#include "data/study/new_session.h"

#include <fmt/format.h>

#include "data/log/event_body.h"
#include "data/log/plain_name.h"
#include "data/log/storage_error.h"
#include "data/study/schema.h"
#include "data/study/study_facts.h"

namespace jnd {

namespace {

void refuse_names(const NewSession& session, const Study::Impl& study) {
  if (!plain_code(session.participant))
    throw StorageError(
        fmt::format("the participant code \"{}\" cannot be used: take letters and digits, at most 32, such as P01",
                    session.participant));
  if (!plain_name(session.id))
    throw StorageError(fmt::format(
        "the session name \"{}\" cannot be used: take letters, digits, '-', '_' and '.', at most 64", session.id));
  if (study.ends.contains(session.id))
    throw StorageError(fmt::format("{}: session {} exists already", study.path.string(), session.id));
}

// A participant has one number, and a number is of one participant; of an excluded one it may be free again.
void refuse_numbers(const NewSession& session, const Study::Impl& study) {
  const std::string where = study.path.string();
  if (session.number < 1)
    throw StorageError(fmt::format("{}: sessions of a participant are numbered from 1, not {}", where, session.number));
  if (study.excluded.contains({session.kind, session.participant}))
    throw StorageError(fmt::format("{}: participant {} was excluded from this study ({} sessions); take another code",
                                   where, session.participant, to_string(session.kind)));
  for (const auto& [id, end] : study.ends) {
    if (id == kStudyChain || end.kind != session.kind) continue;
    const bool same_code = end.participant == session.participant;
    if (same_code && end.participant_number == session.participant_number && end.number == session.number)
      throw StorageError(fmt::format("{}: session {} of participant {} exists already ({}); jnd status lists them",
                                     where, session.number, session.participant, id));
    if (same_code == (end.participant_number == session.participant_number)) continue;
    const auto excluded = study.excluded.find({end.kind, end.participant});
    if (!same_code && excluded != study.excluded.end() && excluded->second) continue;
    throw StorageError(fmt::format("{}: participant {} has number {} in session {}, so that {} cannot be number {}",
                                   where, end.participant, end.participant_number, id, session.participant,
                                   session.participant_number));
  }
}

}  // namespace

void require_admissible(const NewSession& session, const Study::Impl& study) {
  refuse_names(session, study);
  refuse_numbers(session, study);
}

nlohmann::ordered_json opened_body(const NewSession& session, const StudyInfo& study, const std::string& study_head) {
  nlohmann::ordered_json body = {
      {"participant", session.participant},
      {"participant_number", session.participant_number},
      {"session_number", session.number},
      {"kind", to_string(session.kind)},
      {"responder", session.responder},
      {"profile_sha256", session.profile_sha256.empty() ? nlohmann::ordered_json(nullptr)
                                                        : nlohmann::ordered_json(session.profile_sha256)},
      {"rig", session.rig},
      {"rig_mode", session.rig_mode},
      {"rig_sha256",
       session.rig_sha256.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(session.rig_sha256)},
      {"tracker", session.tracker},
      {"trials_total", session.trials_total},
      {"protocol_sha256", study.protocol_sha256},
      {"seed", std::to_string(study.seed)}};
  if (!session.group.empty()) body["group"] = session.group;
  if (!session.language.empty()) body["language"] = session.language;
  if (!session.boot_id.empty()) body["boot_id"] = session.boot_id;
  // Simulated sessions begin side by side, in an order of their threads; their events must not depend on it.
  if (session.kind != SessionKind::simulated) body[kStudyHeadKey] = study_head;
  return body;
}

}  // namespace jnd
