#include "protocols/vocabulary.h"

namespace jnd {

std::string_view to_string(SessionKind kind) noexcept {
  switch (kind) {
    case SessionKind::real:
      return "real";
    case SessionKind::pilot:
      return "pilot";
    case SessionKind::simulated:
      return "simulated";
  }
  return "";
}

std::string_view to_string(Judgement judgement) noexcept {
  return judgement == Judgement::same ? "same" : "different";
}

std::string_view to_string(EnteredBy who) noexcept {
  return who == EnteredBy::participant ? "participant" : "operator";
}

std::string_view to_string(Fault fault) noexcept {
  switch (fault) {
    case Fault::none:
      return "none";
    case Fault::no_contact:
      return "no_contact";
    case Fault::stale_pose:
      return "stale_pose";
    case Fault::non_finite:
      return "non_finite";
    case Fault::device_lost:
      return "device_lost";
    case Fault::emergency_stop:
      return "emergency_stop";
    case Fault::interrupted:
      return "interrupted";
  }
  return "";
}

std::optional<SessionKind> session_kind_from(std::string_view text) noexcept {
  for (const SessionKind kind : {SessionKind::real, SessionKind::pilot, SessionKind::simulated})
    if (text == to_string(kind)) return kind;
  return std::nullopt;
}

std::optional<Judgement> judgement_from(std::string_view text) noexcept {
  for (const Judgement judgement : {Judgement::same, Judgement::different})
    if (text == to_string(judgement)) return judgement;
  return std::nullopt;
}

}  // namespace jnd
