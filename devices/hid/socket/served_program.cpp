#include "devices/hid/socket/served_program.h"

#include <array>
#include <chrono>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace jnd {

namespace {
constexpr std::chrono::milliseconds kGrace{100};
constexpr std::size_t kMostKept = 120;  // of a line
constexpr int kMostReads = 16;          // at once: a program that floods is not listened to for ever
}  // namespace

ServedProgram::ServedProgram(const std::vector<std::string>& command, const std::filesystem::path& folder,
                             const OwnedFile& socket)
    : child_(command, folder, ChildInput::none, socket.get()) {}

void ServedProgram::hear() noexcept {
  const std::lock_guard lock(mutex_);
  std::array<char, 4096> bytes{};
  for (const int file : {child_.output(), child_.errors()}) {
    for (int i = 0; file >= 0 && i < kMostReads; ++i) {
      const ssize_t count = ::read(file, bytes.data(), bytes.size());
      if (count <= 0) break;
      if (file == child_.errors()) keep({bytes.data(), static_cast<std::size_t>(count)});
    }
  }
}

bool ServedProgram::has_exited() const noexcept {
  const std::lock_guard lock(mutex_);
  return child_.has_exited();
}

std::string ServedProgram::end() {
  const auto patience = std::chrono::steady_clock::now() + kGrace;
  while (!has_exited() && std::chrono::steady_clock::now() < patience)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  hear();
  const std::lock_guard lock(mutex_);
  return fmt::format("has ended ({})", child_.end());
}

std::string ServedProgram::said() const {
  const std::lock_guard lock(mutex_);
  const std::string& said = line_.empty() ? last_line_ : line_;
  return said.empty() ? std::string() : ", and said last: " + said;
}

// What is no printable ASCII becomes a question mark: it reaches terminals and JSON.
void ServedProgram::keep(std::string_view text) {
  for (const char letter : text) {
    if (letter == '\n') {
      if (!line_.empty()) last_line_ = std::exchange(line_, {});
    } else if (line_.size() < kMostKept) {
      line_ += letter < ' ' || letter > '~' ? '?' : letter;
    }
  }
}

}  // namespace jnd
