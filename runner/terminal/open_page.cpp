#include "runner/terminal/open_page.h"

#include <array>
#include <cstdlib>
#include <string>

#include <unistd.h>

#include "runner/terminal/other_programs.h"

namespace jnd {

bool open_page(const std::filesystem::path& page) {
  const char* const browser = std::getenv("BROWSER");
  std::string program = browser == nullptr || *browser == '\0' ? "xdg-open" : browser;
  std::string file = std::filesystem::absolute(page).string();
  const std::array<char*, 3> arguments = {program.data(), file.data(), nullptr};
  const QuietSpawn quiet;
  pid_t child = 0;
  return posix_spawnp(&child, program.c_str(), &quiet.files, &quiet.attributes, arguments.data(), environ) == 0;
}

}  // namespace jnd
