#include "devices/hid/virtual/socket_port.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "devices/hid/firmware/jnd_report.h"

namespace jnd {

namespace {
constexpr std::size_t kMostHosts = 8;  // a session, and some that look on
}  // namespace

SocketPort::SocketPort(std::filesystem::path path) : path_(std::move(path)), events_(::epoll_create1(EPOLL_CLOEXEC)) {
  if (events_.get() < 0) throw DeviceError(fmt::format("no epoll can be made: {}", std::strerror(errno)));
}

SocketPort::SocketPort(OwnedFile connected) : SocketPort(std::filesystem::path()) {
  int kind = 0;
  socklen_t size = sizeof kind;
  if (getsockopt(connected.get(), SOL_SOCKET, SO_TYPE, &kind, &size) != 0 || kind != SOCK_SEQPACKET)
    throw DeviceError(
        fmt::format("file descriptor {} is no socket of SOCK_SEQPACKET: a program that starts this one gives it one "
                    "end of a pair there (a rig file's \"command\" does)",
                    connected.get()));
  limit_queue(connected);
  watch(connected);
  hosts_.push_back(std::move(connected));
}

SocketPort::~SocketPort() {
  unplug();
}

void SocketPort::watch(const OwnedFile& file) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = file.get();
  if (epoll_ctl(events_.get(), EPOLL_CTL_ADD, file.get(), &event) != 0)
    throw DeviceError(fmt::format("a socket cannot be watched: {}", std::strerror(errno)));
}

void SocketPort::plug(const HidDescription& /*description*/) {
  if (!path_.empty()) {
    listening_ = listen_local(path_);
    watch(listening_);
  }
  plugged_ = true;
}

void SocketPort::unplug() {
  if (listening_.get() >= 0) (void)::unlink(path_.c_str());
  listening_.close();
  hosts_.clear();
  plugged_ = false;
}

bool SocketPort::is_over() const noexcept {
  return path_.empty() && hosts_.empty();
}

void SocketPort::take_on() {
  OwnedFile host = accept_local(listening_);
  if (host.get() < 0 || hosts_.size() >= kMostHosts) return;
  watch(host);
  hosts_.push_back(std::move(host));
}

void SocketPort::hear(std::vector<OwnedFile>::iterator host,
                      const std::function<void(std::span<const std::uint8_t>)>& output) {
  std::array<std::uint8_t, JND_REPORT_SIZE> report{};
  const ssize_t size = ::recv(host->get(), report.data(), report.size(), MSG_DONTWAIT | MSG_TRUNC);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) {  // its end, or an empty packet, which no host sends
    hosts_.erase(host);
    return;
  }
  // What is longer is no report, and its beginning is not taken for one.
  if (size <= JND_REPORT_SIZE) output(std::span(report).first(static_cast<std::size_t>(size)));
}

bool SocketPort::serve(const std::function<void(std::span<const std::uint8_t>)>& output) {
  epoll_event event{};
  if (::epoll_wait(events_.get(), &event, 1, 0) <= 0) return false;
  if (event.data.fd == listening_.get()) {
    take_on();
    return true;
  }
  const auto host =
      std::find_if(hosts_.begin(), hosts_.end(), [&event](const OwnedFile& one) { return one.get() == event.data.fd; });
  if (host != hosts_.end()) hear(host, output);
  return true;
}

bool SocketPort::send(std::span<const std::uint8_t> report) noexcept {
  for (const OwnedFile& host : hosts_)
    (void)::send(host.get(), report.data(), report.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  return !hosts_.empty();
}

}  // namespace jnd
