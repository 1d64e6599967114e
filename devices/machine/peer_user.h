// Who is at the other end of a Unix socket.
#pragma once

#include <sys/socket.h>
#include <unistd.h>

namespace jnd {

// Whether the other end belongs to the user that this program runs as.
inline bool is_same_user(int socket) noexcept {
  ucred peer{};
  socklen_t size = sizeof peer;
  return getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.uid == geteuid();
}

}  // namespace jnd
