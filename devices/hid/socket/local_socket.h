// Unix sockets that carry whole reports (SOCK_SEQPACKET), between programs of one user on one machine.
#pragma once

#include <filesystem>
#include <utility>

namespace jnd {

// An open file, closed with its owner.
class OwnedFile {
 public:
  OwnedFile() = default;
  explicit OwnedFile(int number) noexcept : number_(number) {}
  ~OwnedFile() { close(); }
  OwnedFile(OwnedFile&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  OwnedFile& operator=(OwnedFile&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }

  int get() const noexcept { return number_; }  // below 0: none
  void close() noexcept;

 private:
  int number_ = -1;
};

// How many reports wait in a socket before the writer has to: as hidraw keeps them.
inline constexpr int kReportsQueued = 64;

// Connected, and never waiting. Throws DeviceError, with what to do: nothing is served there, this login may not, or
// what serves it is another user's.
OwnedFile connect_local(const std::filesystem::path& path);

// Listening, for this user only (mode 0600). A socket that nothing serves any more is replaced; another file never.
// Throws DeviceError.
OwnedFile listen_local(const std::filesystem::path& path);

// The next program that connects; none: nobody does just now, or it was another user's and has been sent away.
OwnedFile accept_local(const OwnedFile& listening) noexcept;

// Both ends of a connection; they wait where they are not told otherwise. Throws DeviceError.
std::pair<OwnedFile, OwnedFile> local_pair();

// At most kReportsQueued reports wait in it. For the end that writes.
void limit_queue(const OwnedFile& socket) noexcept;

}  // namespace jnd
