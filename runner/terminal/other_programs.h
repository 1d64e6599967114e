// Other programs that this one starts without waiting for them.
#pragma once

#include <string>

#include <spawn.h>

namespace jnd {

// Whether a program of this name can be started: $PATH as the shell reads it.
bool is_on_path(const std::string& name);

// What posix_spawn is told: nothing of this program's terminal, files and signals.
struct QuietSpawn {
  QuietSpawn();
  ~QuietSpawn();
  QuietSpawn(const QuietSpawn&) = delete;
  QuietSpawn& operator=(const QuietSpawn&) = delete;

  posix_spawn_file_actions_t files{};
  posix_spawnattr_t attributes{};
};

}  // namespace jnd
