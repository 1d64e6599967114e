// What hears of a session beside the console, such as the sounds of the cues. It is told what the operator's screen is
// told and nothing more: no stimulus, no condition, and not whether an answer was right.
#pragma once

#include <string>
#include <string_view>

#include "protocols/protocol.h"
#include "protocols/vocabulary.h"
#include "runner/session/session_view.h"

namespace jnd {

// What happens between trials and around them.
namespace moment {
inline constexpr std::string_view kBegan = "session.began";
inline constexpr std::string_view kBreakBegan = "break.began";
inline constexpr std::string_view kPaused = "paused";
inline constexpr std::string_view kStopped = "stopped";  // an emergency stop is set
inline constexpr std::string_view kMissing = "missing";  // something of the rig is
inline constexpr std::string_view kGoesOn = "goes_on";   // after one of those
inline constexpr std::string_view kExplorationBegan = "exploration.began";
inline constexpr std::string_view kExplorationEnded = "exploration.ended";
inline constexpr std::string_view kTakenBack = "taken_back";  // the last answer
inline constexpr std::string_view kEnded = "session.ended";
}  // namespace moment

// Thread rule: the session's thread only. It waits for what it calls: nothing here may block.
class SessionListener {
 public:
  virtual ~SessionListener() = default;
  // The operator has let it begin.
  virtual void trial(const TrialOutline&) {}
  // The interval begins, or the question is asked. True: the participant heard it, so that no bell need ring.
  virtual bool cue(CuePlace, const CueSignal&) { return false; }
  virtual void interval_over() {}
  virtual void answered(const TrialOutline&, const Answer&) {}
  // reason: as the log has it.
  virtual void voided(const TrialOutline&, const std::string& /*reason*/) {}
  virtual void happened(std::string_view /*moment*/) {}
};

}  // namespace jnd
