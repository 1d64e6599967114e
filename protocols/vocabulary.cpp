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

std::string_view to_string(StiffnessUnit unit) noexcept {
  return unit == StiffnessUnit::n_per_m ? "N/m" : "N/rad";
}

std::string_view name_suffix(StiffnessUnit unit) noexcept {
  return unit == StiffnessUnit::n_per_m ? "n_per_m" : "n_per_rad";
}

std::string_view length_suffix(StiffnessUnit unit) noexcept {
  return unit == StiffnessUnit::n_per_m ? "m" : "rad";
}

std::string_view to_string(Channel channel) noexcept {
  return channel == Channel::cutaneous ? "cutaneous" : "kinaesthetic";
}

std::string_view to_string(RenderingMode mode) noexcept {
  switch (mode) {
    case RenderingMode::wrench:
      return "wrench";
    case RenderingMode::pd:
      return "pd";
    case RenderingMode::pd_literal:
      return "pd-literal";
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
    case Fault::stale_reading:
      return "stale_reading";
    case Fault::command_gap:
      return "command_gap";
    case Fault::non_finite:
      return "non_finite";
    case Fault::sensor_stuck:
      return "sensor_stuck";
    case Fault::device_lost:
      return "device_lost";
    case Fault::device_fault:
      return "device_fault";
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

std::optional<StiffnessUnit> stiffness_unit_from(std::string_view text) noexcept {
  for (const StiffnessUnit unit : {StiffnessUnit::n_per_m, StiffnessUnit::n_per_rad})
    if (text == to_string(unit)) return unit;
  return std::nullopt;
}

std::optional<Channel> channel_from(std::string_view text) noexcept {
  for (const Channel channel : {Channel::cutaneous, Channel::kinaesthetic})
    if (text == to_string(channel)) return channel;
  return std::nullopt;
}

std::optional<Fault> fault_from(std::string_view text) noexcept {
  for (const Fault fault :
       {Fault::none, Fault::no_contact, Fault::stale_pose, Fault::stale_reading, Fault::command_gap, Fault::non_finite,
        Fault::sensor_stuck, Fault::device_lost, Fault::device_fault, Fault::emergency_stop, Fault::interrupted})
    if (text == to_string(fault)) return fault;
  return std::nullopt;
}

std::optional<RenderingMode> rendering_mode_from(std::string_view text) noexcept {
  for (const RenderingMode mode : {RenderingMode::wrench, RenderingMode::pd, RenderingMode::pd_literal})
    if (text == to_string(mode)) return mode;
  return std::nullopt;
}

std::optional<Judgement> judgement_from(std::string_view text) noexcept {
  for (const Judgement judgement : {Judgement::same, Judgement::different})
    if (text == to_string(judgement)) return judgement;
  return std::nullopt;
}

}  // namespace jnd
