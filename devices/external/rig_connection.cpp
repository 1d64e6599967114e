#include "devices/external/rig_connection.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "devices/external/rig_line.h"
#include "devices/machine/peer_user.h"

namespace jnd {

namespace {

constexpr int kConnect_ms = 1000;
constexpr std::chrono::milliseconds kLeaveLook{5};

// Closed with this unless taken.
class OpenSocket {
 public:
  explicit OpenSocket(int family) : file_(::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    if (file_ < 0) throw DeviceError(fmt::format("no socket can be made: {}", std::strerror(errno)));
  }
  ~OpenSocket() {
    if (file_ >= 0) close(file_);
  }
  OpenSocket(const OpenSocket&) = delete;
  OpenSocket& operator=(const OpenSocket&) = delete;

  void connect_to(const sockaddr* address, socklen_t size) const {
    if (connect(file_, address, size) == 0) return;
    int error = errno;
    if (error == EINPROGRESS) {
      pollfd file{file_, POLLOUT, 0};
      socklen_t length = sizeof error;
      int ready = 0;
      while ((ready = poll(&file, 1, kConnect_ms)) < 0 && errno == EINTR) continue;
      if (ready != 1)
        error = ETIMEDOUT;
      else
        (void)getsockopt(file_, SOL_SOCKET, SO_ERROR, &error, &length);
    }
    if (error != 0) throw DeviceError(fmt::format("cannot be reached: {}", std::strerror(error)));
  }
  int file() const noexcept { return file_; }
  int take() noexcept { return std::exchange(file_, -1); }

 private:
  int file_;
};

// The socket interfaces take every address by this type.
template <typename Address>
const sockaddr* as_address(const Address& address) noexcept {
  return reinterpret_cast<const sockaddr*>(&address);  // NOLINT(cppcoreguidelines-pro-type-reinterpret-cast)
}

int connect_unix(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string& name = path.native();
  if (name.size() >= sizeof address.sun_path)
    throw DeviceError(fmt::format("a socket's path has at most {} bytes", sizeof address.sun_path - 1));
  std::copy(name.begin(), name.end(), address.sun_path);
  OpenSocket socket(AF_UNIX);
  socket.connect_to(as_address(address), sizeof address);
  if (!is_same_user(socket.file()))
    throw DeviceError("is served by another user, who could be anybody: start the rig as the same user");
  return socket.take();
}

int connect_tcp(const std::string& host, int port) {
  const bool six = host == "::1";
  sockaddr_in four_address{};
  four_address.sin_family = AF_INET;
  four_address.sin_port = htons(static_cast<std::uint16_t>(port));
  four_address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  sockaddr_in6 six_address{};
  six_address.sin6_family = AF_INET6;
  six_address.sin6_port = four_address.sin_port;
  six_address.sin6_addr = in6addr_loopback;
  OpenSocket socket(six ? AF_INET6 : AF_INET);
  const int at_once = 1;  // a line waits for no other
  (void)setsockopt(socket.file(), IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
  if (six)
    socket.connect_to(as_address(six_address), sizeof six_address);
  else
    socket.connect_to(as_address(four_address), sizeof four_address);
  return socket.take();
}

bool is_for_later(int error) noexcept {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

}  // namespace

RigConnection::RigConnection(const ExternalSettings& settings) {
  if (!settings.command.empty())
    child_ = std::make_unique<ChildProcess>(settings.command, settings.folder, ChildInput::pipe);
  else
    socket_ = settings.socket.empty() ? connect_tcp(settings.host, settings.port) : connect_unix(settings.socket);
}

RigConnection::~RigConnection() {
  if (socket_ >= 0) close(socket_);
}

void RigConnection::wait(int wake, int milliseconds) const {
  const short news = POLLIN;
  const auto writing = static_cast<short>(unwritten_.empty() ? 0 : POLLOUT);
  std::array<pollfd, 4> files{{{wake, POLLIN, 0},
                               {open_ ? reading() : -1, news, 0},
                               {child_ != nullptr ? child_->input() : socket_, writing, 0},
                               {child_ != nullptr && errors_open_ ? child_->errors() : -1, POLLIN, 0}}};
  if (!open_ || writing == 0) files[2].fd = -1;
  (void)poll(files.data(), files.size(), milliseconds);
}

std::string_view RigConnection::read_bytes() {
  if (!open_ || reading() < 0) return {};
  const ssize_t count = ::read(reading(), buffer_.data(), buffer_.size());
  if (count > 0) return {buffer_.data(), static_cast<std::size_t>(count)};
  if (count == 0 || !is_for_later(errno)) open_ = false;
  return {};
}

void RigConnection::read_errors() {
  if (child_ == nullptr || !errors_open_ || child_->errors() < 0) return;
  std::array<char, 4096> bytes;  // NOLINT(cppcoreguidelines-pro-type-member-init): read() fills it
  const ssize_t count = ::read(child_->errors(), bytes.data(), bytes.size());
  if (count == 0 || (count < 0 && !is_for_later(errno))) errors_open_ = false;
  if (count <= 0) return;
  const auto remember = [&](std::string_view line) {
    if (line.find_first_not_of(" \t\r") != std::string_view::npos) last_error_ = ascii_quote(line);
  };
  error_lines_.cut({bytes.data(), static_cast<std::size_t>(count)}, remember, [&] { remember(error_lines_.rest()); });
}

bool RigConnection::write(std::string_view bytes) {
  unwritten_ += bytes;
  while (!unwritten_.empty()) {
    const ssize_t count = child_ != nullptr ? ::write(child_->input(), unwritten_.data(), unwritten_.size())
                                            : ::send(socket_, unwritten_.data(), unwritten_.size(), MSG_NOSIGNAL);
    if (count < 0) return is_for_later(errno);
    unwritten_.erase(0, static_cast<std::size_t>(count));
  }
  return true;
}

void RigConnection::close_input() noexcept {
  if (child_ != nullptr)
    child_->close_input();
  else if (socket_ >= 0)
    (void)shutdown(socket_, SHUT_WR);
}

bool RigConnection::leave(std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  const auto nothing = [](std::string_view) {};
  while (!has_exited() && std::chrono::steady_clock::now() < until) {
    (void)read(nothing, nothing);
    if (!has_exited()) std::this_thread::sleep_for(kLeaveLook);
  }
  return has_exited();
}

std::string RigConnection::end(std::chrono::milliseconds grace) {
  open_ = false;
  if (child_ != nullptr) {
    read_errors();
    return child_->end(grace);
  }
  if (socket_ >= 0) close(std::exchange(socket_, -1));
  return "connection closed";
}

}  // namespace jnd
