#include "devices/hid/socket/local_socket.h"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "devices/machine/peer_user.h"

namespace jnd {

namespace {

constexpr int kKind = SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK;
// Programs that wait to be taken on.
constexpr int kBacklog = 8;
// What the kernel counts a waiting report of 64 bytes as (its bookkeeping included).
constexpr int kCountedPerReport = 768;

sockaddr_un address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string& text = path.native();
  if (text.empty() || text.size() >= sizeof address.sun_path)
    throw DeviceError(fmt::format("the socket's path \"{}\" has {} bytes: give one of 1 to {}", text, text.size(),
                                  sizeof address.sun_path - 1));
  std::memcpy(address.sun_path, text.data(), text.size());
  return address;
}

OwnedFile new_socket() {
  OwnedFile socket(::socket(AF_UNIX, kKind, 0));
  if (socket.get() < 0) throw DeviceError(fmt::format("no socket can be made: {}", std::strerror(errno)));
  return socket;
}

int connect_to(const OwnedFile& socket, const sockaddr_un& address) noexcept {
  return ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
}

std::string why_no_connection(const std::filesystem::path& path, int error) {
  const std::string where = path.string();
  switch (error) {
    case ENOENT:
    case ECONNREFUSED:
      return fmt::format("no device is served at {}: start the program that serves it", where);
    case EAGAIN:
      return fmt::format("the program that serves {} takes nobody on just now: end what else uses it", where);
    case EACCES:
    case EPERM:
      return fmt::format("this login may not use {}: start the program that serves it as the same user", where);
    case EPROTOTYPE:
      return fmt::format("{} is a socket of another kind: a device is served on one of SOCK_SEQPACKET", where);
    default:
      return fmt::format("cannot connect to {}: {}", where, std::strerror(error));
  }
}

// A socket file whose program has ended without removing it.
bool is_left_over(const std::filesystem::path& path, const sockaddr_un& address) {
  struct stat what {};
  if (lstat(path.c_str(), &what) != 0 || !S_ISSOCK(what.st_mode)) return false;
  return connect_to(new_socket(), address) == ECONNREFUSED;
}

// The file takes the socket's mode: from the first moment nobody else can connect.
int bind_for_this_user(const OwnedFile& socket, const sockaddr_un& address) noexcept {
  if (fchmod(socket.get(), S_IRUSR | S_IWUSR) != 0) return errno;
  return ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
}

}  // namespace

void OwnedFile::close() noexcept {
  if (number_ >= 0) ::close(std::exchange(number_, -1));
}

OwnedFile connect_local(const std::filesystem::path& path) {
  const sockaddr_un address = address_of(path);
  OwnedFile socket = new_socket();
  if (const int error = connect_to(socket, address); error != 0) throw DeviceError(why_no_connection(path, error));
  if (!is_same_user(socket.get()))
    throw DeviceError(
        fmt::format("{} is served by another user: start the program that serves it as the same user", path.string()));
  limit_queue(socket);
  return socket;
}

OwnedFile listen_local(const std::filesystem::path& path) {
  const sockaddr_un address = address_of(path);
  OwnedFile socket = new_socket();
  int error = bind_for_this_user(socket, address);
  if (error == EADDRINUSE && is_left_over(path, address)) {
    (void)::unlink(path.c_str());
    error = bind_for_this_user(socket, address);
  }
  if (error == EADDRINUSE)
    throw DeviceError(fmt::format(
        "{} is there already, and in use or no socket: end the other program, or choose another path", path.string()));
  if (error == 0 && ::listen(socket.get(), kBacklog) != 0) error = errno;
  if (error != 0)
    throw DeviceError(fmt::format("cannot serve {}: {}; choose a path in a folder that you may write to", path.string(),
                                  std::strerror(error)));
  return socket;
}

OwnedFile accept_local(const OwnedFile& listening) noexcept {
  OwnedFile socket(::accept4(listening.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (socket.get() < 0 || !is_same_user(socket.get())) return {};
  limit_queue(socket);
  return socket;
}

std::pair<OwnedFile, OwnedFile> local_pair() {
  int ends[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw DeviceError(fmt::format("no pair of sockets can be made: {}", std::strerror(errno)));
  std::pair<OwnedFile, OwnedFile> made{OwnedFile(ends[0]), OwnedFile(ends[1])};
  limit_queue(made.first);
  limit_queue(made.second);
  return made;
}

void limit_queue(const OwnedFile& socket) noexcept {
  const int bytes = kReportsQueued * kCountedPerReport / 2;  // the kernel doubles it
  (void)setsockopt(socket.get(), SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
}

}  // namespace jnd
