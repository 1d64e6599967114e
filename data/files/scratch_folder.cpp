#include "data/files/scratch_folder.h"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "data/log/storage_error.h"
#include "protocols/input/file_trouble.h"

namespace jnd {

ScratchFolder::ScratchFolder(std::string_view purpose) {
  std::error_code error;
  std::string name = (std::filesystem::temp_directory_path(error) / fmt::format("jnd-{}-XXXXXX", purpose)).string();
  if (mkdtemp(name.data()) == nullptr)
    throw StorageError(fmt::format("no temporary folder {}: {}; or set TMPDIR to a folder that you may write to", name,
                                   file_trouble(name, errno, FileUse::write).text()));
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace jnd
