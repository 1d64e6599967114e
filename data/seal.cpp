#include "data/seal.h"

#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "data/storage_error.h"
#include "protocols/sha256.h"

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
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(path))) throw refused("is not a file");
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw refused("cannot be read");
  const std::size_t at = bytes.rfind(seal_beginning(command));
  if (at == std::string::npos) throw refused(fmt::format("was not written by jnd {}", command));
  if (bytes.substr(at) != seal_of(std::string_view(bytes).substr(0, at), command))
    throw refused(fmt::format("was changed after jnd {} had written it", command));
}

}  // namespace jnd
