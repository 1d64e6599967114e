#include "runner/terminal/other_programs.h"

#include <csignal>
#include <cstdlib>
#include <sstream>

#include <fcntl.h>
#include <unistd.h>

namespace jnd {

bool is_on_path(const std::string& name) {
  const char* const places = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  std::istringstream rest(places != nullptr ? places : "/bin:/usr/bin");
  for (std::string place; std::getline(rest, place, ':');)
    if (access(((place.empty() ? "." : place) + "/" + name).c_str(), X_OK) == 0) return true;
  return false;
}

QuietSpawn::QuietSpawn() {
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDWR, 0);
  posix_spawn_file_actions_adddup2(&files, STDIN_FILENO, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, STDIN_FILENO, STDERR_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
}

QuietSpawn::~QuietSpawn() {
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
}

}  // namespace jnd
