// The system's program that plays sound files, started without ever being waited for.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

#include "data/files/scratch_folder.h"
#include "devices/check.h"
#include "runner/sound/wave.h"

namespace jnd {

// A program and its arguments, to which the file's name is added.
struct Player {
  std::vector<std::string> command;
  const std::string& name() const noexcept { return command.front(); }
};

// The players that this machine has, in the order in which they are tried: pw-play (PipeWire), paplay (PulseAudio),
// aplay (ALSA).
std::vector<Player> players();

// Whether one of them can play: a tenth of a second of silence is played by each in turn, for at most three seconds
// each. Throws nothing.
struct PlayerTrial {
  Player player;        // without a command: none can
  std::string trouble;  // of those that could not, with what they said; where there is none, what to install
};
PlayerTrial try_players();

// A finding of jnd doctor.
Check check_sound();

// One sound that is playing. Thread rule: one thread. No call waits for the player.
class PlayingSound {
 public:
  // Starts it; it has no part in this program's terminal and files. Where it cannot be started, failed() says so.
  PlayingSound(const Player& player, const std::filesystem::path& file);
  // Ends it at once.
  ~PlayingSound();
  PlayingSound(PlayingSound&& other) noexcept;
  PlayingSound& operator=(PlayingSound&& other) noexcept;

  // Asks it to end. What does not within half a second is killed by a later look.
  void stop() noexcept;
  // Whether it has ended; leaves no zombie then. Call now and then.
  bool is_over() noexcept;
  // It could not be started, or ended with an error, without having been stopped.
  bool failed() const noexcept { return failed_; }

 private:
  pid_t pid_ = -1;  // and of its group; below 0: it is over
  bool stopped_ = false, failed_ = false;
  std::chrono::steady_clock::time_point stopped_at_{};
};

// A folder of this program's own, in which a player finds its sounds.
class SoundFolder {
 public:
  // As NAME.wav; returns its path. Throws StorageError where there is no room.
  std::filesystem::path write(const std::string& name, const Wave& wave) const;

 private:
  ScratchFolder folder_{"sound"};  // throws StorageError where none can be made
};

}  // namespace jnd
