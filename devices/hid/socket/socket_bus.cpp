#include "devices/hid/socket/socket_bus.h"

#include <array>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "devices/hid/page_exchange.h"
#include "devices/hid/report_words.h"
#include "devices/hid/socket/local_socket.h"
#include "devices/hid/socket/shared_socket.h"
#include "devices/machine/child_process.h"

namespace jnd {

// A program that serves a device to this one, which started it: its end, and what it says on its standard error.
// Thread rule: any thread.
class ServedProgram {
 public:
  // Starts it in that folder (empty: here). socket: its end, which becomes its file descriptor 3. Throws DeviceError.
  ServedProgram(const std::vector<std::string>& command, const std::filesystem::path& folder, const OwnedFile& socket)
      : child_(command, folder, ChildInput::none, socket.get()) {}

  // Reads what it says, so that it never waits for a reader; the last line is kept.
  void hear() noexcept {
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
  bool has_exited() const noexcept {
    const std::lock_guard lock(mutex_);
    return child_.has_exited();
  }
  // Its connection is closed: ends it where it does not end by itself. "has ended (exit code 3)".
  std::string end() {
    const auto patience = std::chrono::steady_clock::now() + kGrace;
    while (!has_exited() && std::chrono::steady_clock::now() < patience)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    hear();
    const std::lock_guard lock(mutex_);
    return fmt::format("has ended ({})", child_.end());
  }
  // ", and said last: ..."; empty where it said nothing. It may name the stimulus.
  std::string said() const {
    const std::lock_guard lock(mutex_);
    const std::string& said = line_.empty() ? last_line_ : line_;
    return said.empty() ? std::string() : ", and said last: " + said;
  }

 private:
  static constexpr std::chrono::milliseconds kGrace{100};
  static constexpr std::size_t kMostKept = 120;  // of a line
  static constexpr int kMostReads = 16;          // at once: a program that floods is not listened to for ever

  // What is no printable ASCII becomes a question mark: it reaches terminals and JSON.
  void keep(std::string_view text) {
    for (const char letter : text) {
      if (letter == '\n') {
        if (!line_.empty()) last_line_ = std::exchange(line_, {});
      } else if (line_.size() < kMostKept) {
        line_ += letter < ' ' || letter > '~' ? '?' : letter;
      }
    }
  }

  mutable std::mutex mutex_;
  ChildProcess child_;
  std::string line_, last_line_;
};

namespace {

using SocketTime = std::chrono::steady_clock::time_point;

constexpr std::chrono::seconds kStartEvery{1};
constexpr PagePatience kAskedWho{.read_ms = 150, .write_ms = 150, .tries = 2};
// A program that starts may take a while until it answers, an interpreter longer than that.
constexpr PagePatience kAskedFirst{.read_ms = 500, .write_ms = 500, .tries = 6};

HidInfo info_of(const SocketDevice& device, const jnd_identity& identity) {
  HidInfo info;
  info.path = device.path;
  info.usage_page = JND_USAGE_PAGE;
  info.usage = identity.model == JND_MODEL_TRACKER ? JND_USAGE_TRACKER : JND_USAGE_FINGERTIP;
  info.serial = serial_of(identity);
  info.product_name = identity.model == JND_MODEL_TRACKER ? "jnd tracker" : "jnd fingertip device";
  if ((identity.capabilities & JND_IS_MODEL) != 0) info.product_name += " (virtual)";
  info.transport = device.command.empty() ? "socket" : "program";
  return info;
}

}  // namespace

// One device: its connection while there is one, and its program.
class SocketBus::Source {
 public:
  explicit Source(SocketDevice device) : device_(std::move(device)) {}
  ~Source() {
    kept_.reset();  // a program that serves well ends when its connection does
    if (program_) (void)program_->end();
  }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  const std::string& path() const noexcept { return device_.path; }

  // Who it is, where it is there.
  std::optional<HidInfo> look() {
    const std::lock_guard lock(mutex_);
    try {
      const std::shared_ptr<SharedSocket> live = connection();
      if (!known_) {
        const std::unique_ptr<HidHandle> handle = live->handle();
        PageExchange pages(*handle, device_.path, {}, asked_first_ ? kAskedFirst : kAskedWho);
        asked_first_ = false;
        known_ = info_of(device_, pages.identity());
      }
      trouble_.clear();
      said_.clear();
      return known_;
    } catch (const DeviceError& error) {
      trouble_ = error.what();
      if (end_program()) trouble_ = words() + " " + how_it_ended_;
      trouble_ += said_;
      return std::nullopt;
    }
  }

  std::unique_ptr<HidHandle> open() {
    const std::lock_guard lock(mutex_);
    return connection()->handle();
  }

  std::string trouble() const {
    const std::lock_guard lock(mutex_);
    return trouble_;
  }

 private:
  // The one that there is, or a new one. Throws DeviceError.
  std::shared_ptr<SharedSocket> connection() {
    if (std::shared_ptr<SharedSocket> live = live_.lock(); live && !live->is_gone() && !is_over()) return live;
    known_.reset();
    std::shared_ptr<SharedSocket> made =
        device_.command.empty() ? std::make_shared<SharedSocket>(connect_local(device_.socket)) : start();
    live_ = made;
    return made;
  }

  bool is_over() const { return program_ && program_->has_exited(); }

  // One whose connection is closed, by whichever side. False: there is none.
  bool end_program() {
    if (!program_ || (kept_ && !kept_->is_gone() && !is_over())) return false;
    kept_.reset();
    how_it_ended_ = program_->end();
    said_ = program_->said();
    program_.reset();
    return true;
  }

  std::string words() const { return fmt::format("{}", fmt::join(device_.command, " ")); }

  std::shared_ptr<SharedSocket> start() {
    (void)end_program();
    const SocketTime now = std::chrono::steady_clock::now();
    if (started_ && now < *started_ + kStartEvery)
      throw DeviceError(fmt::format("{} {}", words(), how_it_ended_.empty() ? "is being started" : how_it_ended_));
    started_ = now;
    auto [ours, its] = local_pair();
    try {
      program_ = std::make_shared<ServedProgram>(device_.command, device_.folder, its);
    } catch (const DeviceError& error) {
      how_it_ended_ = error.what();
      throw DeviceError(fmt::format("{} {}", words(), how_it_ended_));
    }
    said_.clear();
    asked_first_ = true;
    kept_ = std::make_shared<SharedSocket>(std::move(ours), [program = program_] { program->hear(); });
    return kept_;
  }

  mutable std::mutex mutex_;
  const SocketDevice device_;
  std::weak_ptr<SharedSocket> live_;
  std::optional<HidInfo> known_;  // of this connection
  std::string trouble_;
  // Of a program.
  std::shared_ptr<SharedSocket> kept_;
  std::shared_ptr<ServedProgram> program_;
  std::optional<SocketTime> started_;
  std::string how_it_ended_, said_;  // said_: by a program that has ended; never in what a session may show
  bool asked_first_ = false;
};

SocketBus::SocketBus(std::vector<SocketDevice> devices) {
  for (SocketDevice& device : devices) sources_.push_back(std::make_unique<Source>(std::move(device)));
}

SocketBus::~SocketBus() = default;

std::vector<HidInfo> SocketBus::list() {
  std::vector<HidInfo> found;
  for (const std::unique_ptr<Source>& source : sources_)
    if (std::optional<HidInfo> info = source->look()) found.push_back(std::move(*info));
  return found;
}

std::unique_ptr<HidHandle> SocketBus::open(const std::string& path) {
  for (const std::unique_ptr<Source>& source : sources_)
    if (source->path() == path) return source->open();
  throw DeviceError(fmt::format("{} is no device that this program was told of", path));
}

std::string SocketBus::absent() const {
  std::string text;
  for (const std::unique_ptr<Source>& source : sources_)
    if (const std::string why = source->trouble(); !why.empty()) text += (text.empty() ? "" : "; ") + why;
  return text;
}

JoinedBus::JoinedBus(std::unique_ptr<HidBus> first, std::unique_ptr<HidBus> second)
    : first_(std::move(first)), second_(std::move(second)) {}

std::vector<HidInfo> JoinedBus::list() {
  std::vector<HidInfo> found = first_->list();
  for (HidInfo& info : second_->list()) found.push_back(std::move(info));
  return found;
}

std::unique_ptr<HidHandle> JoinedBus::open(const std::string& path) {
  return path.starts_with("/dev/hidraw") ? second_->open(path) : first_->open(path);
}

}  // namespace jnd
