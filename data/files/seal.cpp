#include "data/files/seal.h"

#include <limits>
#include <system_error>

#include <fmt/format.h>

#include "data/log/storage_error.h"
#include "protocols/input/input_error.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

std::string seal_beginning(std::string_view command) {
  return fmt::format("<!-- Written by jnd {}, which replaces this file only while it is unchanged: sha256 ", command);
}

std::string seal_of(std::string_view text, std::string_view command) {
  return fmt::format("{}{} -->\n", seal_beginning(command), sha256_hex(text));
}

}  // namespace

std::string sealed(std::string text, std::string_view command) {
  if (!text.ends_with('\n')) text += '\n';
  return text + seal_of(text, command);
}

void require_sealed(const std::filesystem::path& path, std::string_view command) {
  const auto refused = [&](std::string_view why) {
    return StorageError(
        fmt::format("{}: {}; it was left as it is. Remove it yourself or choose another name", path.string(), why));
  };
  std::error_code ignored;  // the status says it too
  const std::filesystem::file_status status = std::filesystem::symlink_status(path, ignored);
  if (status.type() == std::filesystem::file_type::none) throw refused("cannot be read");
  if (!std::filesystem::is_regular_file(status)) throw refused("is not a file");
  std::string bytes;
  try {
    bytes = read_input_file(path, std::numeric_limits<std::size_t>::max());
  } catch (const InputError&) {
    throw refused("cannot be read");
  }
  const std::size_t at = bytes.rfind(seal_beginning(command));
  if (at == std::string::npos) throw refused(fmt::format("was not written by jnd {}", command));
  if (bytes.substr(at) != seal_of(std::string_view(bytes).substr(0, at), command))
    throw refused(fmt::format("was changed after jnd {} had written it", command));
}

}  // namespace jnd
