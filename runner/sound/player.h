// The system's program that plays sound files, started without ever being waited for.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

#include "devices/check.h"

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

}  // namespace jnd
