#include "runner/sound/player.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "data/log/storage_error.h"
#include "devices/device_error.h"
#include "devices/machine/child_process.h"
#include "protocols/input/file_trouble.h"
#include "runner/sound/wave.h"
#include "runner/terminal/other_programs.h"

namespace jnd {

namespace {

using SoundTime = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPatience{2000};  // from asking a player to end to killing it
constexpr std::chrono::seconds kLongestTrial{3};
constexpr const char* kInstall =
    "no player of sounds is installed: install pipewire-bin (pw-play), pulseaudio-utils (paplay) or alsa-utils (aplay)";

std::vector<std::string> words_of(const Player& player, const std::filesystem::path& file) {
  std::vector<std::string> words = player.command;
  words.push_back(file.string());
  return words;
}

// The first line, in printable ASCII, of what a player said on its standard error.
std::string said_by(const ChildProcess& child) {
  std::array<char, 400> bytes{};
  const ssize_t count = ::read(child.errors(), bytes.data(), bytes.size());
  std::string text;
  for (ssize_t i = 0; i < count && bytes[static_cast<std::size_t>(i)] != '\n'; ++i) {
    const char letter = bytes[static_cast<std::size_t>(i)];
    text += letter < ' ' || letter > '~' ? '?' : letter;
  }
  return text;
}

// Plays it, and waits; empty: it did.
std::string why_not(const Player& player, const std::filesystem::path& file) {
  try {
    ChildProcess child(words_of(player, file), {});
    const auto deadline = SoundTime::now() + kLongestTrial;
    while (!child.has_exited() && SoundTime::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (!child.has_exited()) return fmt::format("{} does not end", player.name());
    const std::string said = said_by(child);
    const std::string how = child.end();
    if (how == "exit code 0") return {};
    return fmt::format("{} cannot play ({}{}{})", player.name(), how, said.empty() ? "" : ": ", said);
  } catch (const DeviceError& error) {
    return fmt::format("{} {}", player.name(), error.what());
  }
}

}  // namespace

std::vector<Player> players() {
  std::vector<Player> found;
  for (std::vector<std::string> command : {std::vector<std::string>{"pw-play"}, {"paplay"}, {"aplay", "-q"}})
    if (is_on_path(command.front())) found.push_back({std::move(command)});
  return found;
}

PlayerTrial try_players() {
  constexpr double kSilence_s = 0.1;
  PlayerTrial trial;
  const std::vector<Player> all = players();
  if (all.empty()) trial.trouble = kInstall;
  try {
    if (all.empty()) return trial;
    const SoundFolder folder;
    const std::filesystem::path file = folder.write("silence", silence(kSilence_s));
    for (const Player& player : all) {
      const std::string why = why_not(player, file);
      if (why.empty()) {
        trial.player = player;
        return trial;
      }
      trial.trouble += (trial.trouble.empty() ? "" : "; ") + why;
    }
  } catch (const StorageError& error) {
    trial.trouble = error.what();
  }
  return trial;
}

Check check_sound() {
  const PlayerTrial trial = try_players();
  if (!trial.player.command.empty())
    return {.what = "sound", .verdict = Verdict::ok, .found = trial.player.name() + " plays"};
  return {.what = "sound",
          .verdict = Verdict::warn,
          .found = trial.trouble,
          .what_to_do =
              "cues of the kind \"sound\" ring the terminal's bell instead, and there is no masking noise: "
              "install a player, and look whether its sound service runs for this login"};
}

PlayingSound::PlayingSound(const Player& player, const std::filesystem::path& file) {
  const QuietSpawn quiet;
  std::vector<std::string> words = words_of(player, file);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  if (posix_spawnp(&pid_, arguments[0], &quiet.files, &quiet.attributes, arguments.data(), environ) != 0) {
    pid_ = -1;
    failed_ = true;
  }
}

PlayingSound::~PlayingSound() {
  if (is_over()) return;
  (void)kill(-pid_, SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

PlayingSound::PlayingSound(PlayingSound&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      stopped_(other.stopped_),
      failed_(other.failed_),
      stopped_at_(other.stopped_at_) {}

PlayingSound& PlayingSound::operator=(PlayingSound&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(stopped_, other.stopped_);
  std::swap(failed_, other.failed_);
  std::swap(stopped_at_, other.stopped_at_);
  return *this;
}

void PlayingSound::stop() noexcept {
  if (stopped_ || is_over()) return;
  stopped_ = true;
  stopped_at_ = SoundTime::now();
  (void)kill(-pid_, SIGTERM);
}

bool PlayingSound::is_over() noexcept {
  if (pid_ < 0) return true;
  if (stopped_ && SoundTime::now() > stopped_at_ + kPatience) (void)kill(-pid_, SIGKILL);
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return false;
  failed_ = !stopped_ && !(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  pid_ = -1;
  return true;
}

std::filesystem::path SoundFolder::write(const std::string& name, const Wave& wave) const {
  std::filesystem::path file = folder_.path() / (name + ".wav");
  const std::string bytes = wav_bytes(wave);
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out)
    throw StorageError(fmt::format("the sound {} cannot be written: {}; or set TMPDIR to another folder", file.string(),
                                   file_trouble(file, errno, FileUse::write).text()));
  return file;
}

}  // namespace jnd
