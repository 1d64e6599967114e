// The thread of a FingertipLink that writes.
#include <algorithm>
#include <array>
#include <chrono>
#include <exception>

#include "devices/device_error.h"
#include "devices/hid/link/fingertip_link.h"

namespace jnd {

namespace {

// Commands of mode rest after a connection: they begin the numbering anew, leave the device at rest whoever used it
// before, and their echoes tell how its clock runs.
constexpr int kFirstCommands = 20;
constexpr std::chrono::milliseconds kBetweenFirst{2};

}  // namespace

// What one connection is written to with. Lives in the writer's thread only.
class FingertipLink::Writer {
 public:
  explicit Writer(FingertipLink& link) noexcept : link_(link) {}

  void connect(std::uint32_t connection) {
    handle_.reset();
    connection_ = connection;
    sequence_ = 0;
    engagement_ = 0;
    link_.written_.clear();
    if (connection == 0) return;
    std::string path;
    {
      const std::lock_guard lock(link_.mutex_);
      path = link_.path_;
    }
    try {
      handle_ = link_.bus_.open(path);
    } catch (const DeviceError& error) {  // gone already: the reader will see that too
      const std::lock_guard lock(link_.mutex_);
      link_.write_trouble_ = error.what();
      return;
    }
    // No telemetry before it is of an engagement.
    link_.engaged_.store(1, std::memory_order_release);
    for (int i = 0; i < kFirstCommands && current(); ++i) {
      write(jnd_command{});
      std::this_thread::sleep_for(kBetweenFirst);
    }
    if (current()) link_.writing_.store(connection);
  }

  void write(const PostedCommand& posted) {
    if (!handle_) return;
    if (posted.engagement != engagement_) {
      engagement_ = posted.engagement;
      link_.engaged_.store(std::uint64_t{engagement_} << 32U | (sequence_ + 1U), std::memory_order_release);
      if (posted.command.mode != JND_MODE_REST) write(jnd_command{});
    }
    write(posted.command);
  }

  // Whatever was commanded last, the device is left at rest.
  void finish() {
    if (handle_ && link_.assigned_.load() == connection_) write(jnd_command{});
  }

  std::uint32_t connection() const noexcept { return connection_; }
  std::uint32_t engagement() const noexcept { return engagement_; }

 private:
  bool current() const noexcept { return !link_.ends_.load() && link_.assigned_.load() == connection_; }

  void write(jnd_command command) {
    if (++sequence_ == 0) ++sequence_;  // 0 says "none yet" in telemetry
    command.sequence = sequence_;
    std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
    jnd_encode_command(&command, bytes.data());
    link_.written_.note(sequence_, link_.clock_.now_ns());
    if (handle_->write(bytes)) {
      link_.sent_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    const std::lock_guard lock(link_.mutex_);
    link_.write_trouble_ = "it takes no commands (" + handle_->error() + ")";
  }

  FingertipLink& link_;
  std::unique_ptr<HidHandle> handle_;
  std::uint32_t connection_ = 0;
  std::uint32_t sequence_ = 0;
  std::uint32_t engagement_ = 0;
};

void FingertipLink::write_commands() noexcept {
  Writer writer(*this);
  std::uint64_t written = 0;
  while (!ends_.load()) {
    const std::uint32_t seen = wake_.load(std::memory_order_acquire);
    if (assigned_.load() != writer.connection()) {
      writer.connect(assigned_.load());
      written = posted_.look().number;  // what was meant for the connection before is not for this one
    }
    const PostedCommand posted = posted_.look();
    if (posted.number == written) {
      wake_.wait(seen, std::memory_order_acquire);  // returns at once where anything came since
      continue;
    }
    // Mode rest before a new engagement is written also where a command has replaced it already.
    const bool rest_is_made_up = posted.engagement != writer.engagement() && posted.command.mode != JND_MODE_REST;
    const auto skipped = static_cast<std::int64_t>(posted.number - written - 1);
    overwritten_.fetch_add(std::max<std::int64_t>(skipped - (rest_is_made_up ? 1 : 0), 0), std::memory_order_relaxed);
    written = posted.number;
    writer.write(posted);
  }
  writer.finish();
}

}  // namespace jnd
