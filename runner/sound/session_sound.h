// What a participant hears in a session: cues of the kind "sound", and masking noise over the motors' own.
//
// Nothing of it follows from a stimulus: every cue is the same file, started at the same place of the trial, and the
// noise is the same samples from the first interval's cue to the question, as is the metronome of a prescribed pace from
// an interval's cue to its end. The terminal's bell is the cue where nothing
// can be played.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "devices/check.h"
#include "devices/rigs/rig_file.h"
#include "protocols/protocol.h"
#include "runner/session/session_listener.h"
#include "runner/sound/player.h"

namespace jnd {

// The paces that the protocol prescribes in any condition, in Hz.
std::set<double> paces_of(const Protocol& protocol);
// Whether the protocol and the rig file ask for any sound.
bool asks_for_sound(const Protocol& protocol, const SoundSettings& settings);

// Thread rule: the session's thread.
class SessionSound final : public SessionListener {
 public:
  // Makes the sounds and tries the players, which takes up to some seconds. Throws InputError for a sound that cannot be
  // used, DeviceError where masking noise is asked for and cannot be played.
  SessionSound(const Protocol& protocol, const SoundSettings& settings);

  void trial(const TrialOutline& outline) override { pace_hz_ = outline.pace_hz; }
  bool cue(CuePlace place, const CueSignal& cue) override;
  void interval_over() override;
  void voided(const TrialOutline& outline, const std::string& reason) override;
  void happened(std::string_view moment) override;

  // What is heard, or why only the bell: a finding of readiness.
  const Check& check() const noexcept { return check_; }
  // Sounds that were to be played and were not; the bell rang for the cues among them.
  int failures() const noexcept { return failures_; }

 private:
  void start_noise();
  void stop_noise();
  void stop_metronome();
  void end(std::optional<PlayingSound>& sound);
  void look_after();

  std::optional<SoundFolder> folder_;
  Player player_;
  std::filesystem::path cue_file_, noise_file_;  // empty: not to be heard
  std::vector<PlayingSound> playing_;            // cues, and noise that was told to end
  std::optional<PlayingSound> noise_, metronome_;
  std::map<double, std::filesystem::path> metronomes_;  // by their pace in Hz
  double pace_hz_ = 0;                                  // of the trial; 0: none
  Check check_;
  int failures_ = 0;
  bool bell_ = false;  // the last sound failed
};

}  // namespace jnd
