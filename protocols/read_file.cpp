#include "protocols/read_file.h"

#include <fstream>
#include <iterator>
#include <system_error>

#include "protocols/input_error.h"

namespace jnd {
namespace {

constexpr std::size_t kMaxBytes = 1U << 20U;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& message, const std::string& suggestion) {
  throw InputError(std::vector<Diagnostic>{{path.string(), 0, 0, "", message, suggestion}});
}

}  // namespace

std::string read_input_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail(path, "there is no such file", "look at the path");
  if (std::filesystem::is_directory(status)) fail(path, "is a folder", "name a file in it");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(path, "cannot be opened", "may you read it?");
  std::string bytes;
  // Not by the file's size: pipes have none.
  std::istreambuf_iterator<char> at(stream);
  for (const std::istreambuf_iterator<char> end; at != end; ++at) {
    if (bytes.size() == kMaxBytes) fail(path, "is larger than 1 MiB", "is it the right file?");
    bytes += *at;
  }
  if (stream.bad()) fail(path, "cannot be read to its end", "look at the disk");
  return bytes;
}

}  // namespace jnd
