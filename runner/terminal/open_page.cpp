#include "runner/terminal/open_page.h"

#include <array>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

namespace jnd {

bool open_page(const std::filesystem::path& page) {
  const char* const browser = std::getenv("BROWSER");
  std::string program = browser == nullptr || *browser == '\0' ? "xdg-open" : browser;
  std::string file = std::filesystem::absolute(page).string();
  const std::array<char*, 3> arguments = {program.data(), file.data(), nullptr};
  // What the browser has to say is not for this terminal.
  posix_spawn_file_actions_t quiet{};
  posix_spawn_file_actions_init(&quiet);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const bool started = posix_spawnp(&child, program.c_str(), &quiet, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&quiet);
  return started;
}

}  // namespace jnd
