#include "devices/hid/socket/shared_socket.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

namespace jnd {

namespace {

constexpr std::int64_t kMeanwhileEvery_ns = 100'000'000;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
// How long a command waits for a device that does not read. Its watchdog has let go long before.
constexpr int kLongestWrite_ms = 100;

std::int64_t steady_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

// An open device as the rest of the program sees one.
class SharedSocket::Handle final : public HidHandle {
 public:
  explicit Handle(std::shared_ptr<SharedSocket> shared) : shared_(std::move(shared)) {
    const std::lock_guard lock(shared_->mutex_);
    at_ = shared_->mailboxes_.insert(shared_->mailboxes_.end(), &mailbox_);
  }
  ~Handle() override {
    const std::lock_guard lock(shared_->mutex_);
    shared_->mailboxes_.erase(at_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  int read(std::span<std::uint8_t> bytes, int timeout_ms) noexcept override {
    return shared_->read(mailbox_, bytes, timeout_ms);
  }
  bool write(std::span<const std::uint8_t> bytes) noexcept override { return shared_->write(bytes); }
  std::string error() const override {
    std::string why = shared_->trouble();
    return why.empty() ? "the program that serves it does not read" : why;
  }

 private:
  std::shared_ptr<SharedSocket> shared_;
  Mailbox mailbox_;
  std::list<Mailbox*>::iterator at_;
};

void SharedSocket::Mailbox::put(const Packet& packet) noexcept {
  packets[(first + count) % packets.size()] = packet;
  if (count < packets.size())
    ++count;
  else
    first = (first + 1) % packets.size();
}

int SharedSocket::Mailbox::take(std::span<std::uint8_t> bytes) noexcept {
  const Packet& packet = packets[first];
  const std::size_t size = std::min<std::size_t>(packet.size, bytes.size());
  std::copy_n(packet.bytes.begin(), size, bytes.begin());
  first = (first + 1) % packets.size();
  --count;
  return static_cast<int>(size);
}

SharedSocket::SharedSocket(OwnedFile socket, std::function<void()> meanwhile)
    : socket_(std::move(socket)), meanwhile_(std::move(meanwhile)), allowed_at_(steady_ns()) {}

std::unique_ptr<HidHandle> SharedSocket::handle() {
  return std::make_unique<Handle>(shared_from_this());
}

std::string SharedSocket::trouble() const {
  return trouble_.load();
}

void SharedSocket::lose(const char* why) noexcept {
  trouble_.store(why);
  gone_.store(true);
  (void)::shutdown(socket_.get(), SHUT_RDWR);  // it sees that too, whatever handles are still open
}

int SharedSocket::read(Mailbox& mine, std::span<std::uint8_t> bytes, int timeout_ms) noexcept {
  const Time until = steady_ns() + Time{timeout_ms} * 1'000'000;
  std::unique_lock lock(mutex_);
  for (;;) {
    if (mine.count > 0) return mine.take(bytes);
    if (gone_.load()) return kHidGone;
    if (!listening_) {
      listening_ = true;
      lock.unlock();
      Packet packet;
      const bool came = receive(packet, until);
      lock.lock();
      listening_ = false;
      if (came)
        for (Mailbox* mailbox : mailboxes_) mailbox->put(packet);
      changed_.notify_all();
      if (came || gone_.load()) continue;
      return kHidTimeOut;
    }
    const Time left = until - steady_ns();
    if (left <= 0) return kHidTimeOut;
    changed_.wait_for(lock, std::chrono::nanoseconds(left));
  }
}

bool SharedSocket::may_send(Time now) noexcept {
  const double earned = static_cast<double>(now - allowed_at_) * kMostReportsPerSecond / kSecond_ns;
  allowed_at_ = now;
  allowed_ = std::min(allowed_ + earned, double{kMostReportsAtOnce}) - 1;
  return allowed_ >= 0;
}

bool SharedSocket::receive(Packet& packet, Time until) noexcept {
  for (;;) {
    const Time now = steady_ns();
    if (meanwhile_ && now >= meanwhile_at_) {
      meanwhile_at_ = now + kMeanwhileEvery_ns;
      meanwhile_();
    }
    const Time left = std::max<Time>(until - now, 0);
    const timespec wait{.tv_sec = left / kSecond_ns, .tv_nsec = left % kSecond_ns};
    pollfd ready{.fd = socket_.get(), .events = POLLIN | POLLRDHUP, .revents = 0};
    const int found = ::ppoll(&ready, 1, &wait, nullptr);
    if (found < 0 && errno == EINTR) continue;
    if (found <= 0) return false;
    const ssize_t size = ::recv(socket_.get(), packet.bytes.data(), packet.bytes.size(), MSG_DONTWAIT | MSG_TRUNC);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) {
      if (now >= until) return false;
      continue;
    }
    if (size < 0 || (size == 0 && (ready.revents & (POLLHUP | POLLRDHUP | POLLERR)) != 0)) {
      lose("the program that serves it has closed the connection");
      return false;
    }
    if (!may_send(now)) {
      static_assert(kMostReportsPerSecond == 4000);
      lose("it sends more than 4000 reports a second, and was cut off");
      return false;
    }
    // What is no report is handed on as something shorter: no reader takes its beginning for one, and each counts it.
    packet.size = size == JND_REPORT_SIZE
                      ? std::uint8_t{JND_REPORT_SIZE}
                      : static_cast<std::uint8_t>(std::clamp<ssize_t>(size, 1, JND_REPORT_SIZE - 1));
    return true;
  }
}

bool SharedSocket::write(std::span<const std::uint8_t> report) noexcept {
  if (report.size() != JND_REPORT_SIZE || gone_.load()) return false;
  const Time until = steady_ns() + Time{kLongestWrite_ms} * 1'000'000;
  for (;;) {
    if (::send(socket_.get(), report.data(), report.size(), MSG_DONTWAIT | MSG_NOSIGNAL) == JND_REPORT_SIZE)
      return true;
    const Time left = until - steady_ns();
    if ((errno != EAGAIN && errno != EINTR) || left <= 0) return false;
    pollfd ready{.fd = socket_.get(), .events = POLLOUT, .revents = 0};
    (void)::poll(&ready, 1, static_cast<int>(left / 1'000'000) + 1);
  }
}

}  // namespace jnd
