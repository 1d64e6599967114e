#include "devices/external/external_settings.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>
#include <unistd.h>

#include "devices/external/rig_line.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/read_file.h"

namespace jnd {

namespace {

constexpr TextLimits kArgument{.max_length = 1000, .may_be_empty = true};
constexpr TextLimits kSocketPath{.max_length = 100};  // a Unix socket's name has at most 107 bytes
constexpr TextLimits kTokenPath{.max_length = 1000};
constexpr std::size_t kMostArguments = 100;
constexpr std::size_t kLeastToken = 16, kMostToken = 200;
constexpr NumberLimits kPatience{.min = 0.1, .max = 600, .unit = "s"};

// Other users of the machine can listen on a port, and not read this file: what its hello carries shows who the rig is.
// Throws InputError.
std::string read_token(const std::filesystem::path& path) {
  struct stat what {};
  if (stat(path.c_str(), &what) == 0 && S_ISREG(what.st_mode) &&
      ((what.st_mode & 077U) != 0 || what.st_uid != geteuid()))
    throw InputError(
        fmt::format("{} can be read or was made by others: chmod 600, in a file of your own", path.string()));
  std::string token = read_input_file(path, kMostToken);
  while (!token.empty() && std::isspace(static_cast<unsigned char>(token.back())) != 0) token.pop_back();
  const bool plain = std::all_of(token.begin(), token.end(), [](char one) { return one > ' ' && one <= '~'; });
  if (token.size() < kLeastToken || !plain)
    throw InputError(
        fmt::format("{} holds no token: {} to {} letters and digits that nobody can guess, such as of "
                    "openssl rand -hex 32",
                    path.string(), kLeastToken, kMostToken));
  return token;
}

}  // namespace

std::string in_words(const ExternalSettings& settings) {
  if (!settings.command.empty()) return ascii_quote(fmt::format("{}", fmt::join(settings.command, " ")));
  if (!settings.socket.empty()) return ascii_quote(settings.socket.string());
  return fmt::format("{}:{}", settings.host, settings.port);
}

ExternalSettings read_external_settings(const JsonNode& node, const std::filesystem::path& folder,
                                        std::vector<Diagnostic>& diagnostics, const std::string& file) {
  JsonReader reader(node, diagnostics, file);
  ExternalSettings settings;
  settings.folder = folder;
  int given = 0;
  if (const JsonNode* command = reader.array_or_null("command", 1, kMostArguments)) {
    ++given;
    for (const JsonNode& word : command->items)
      if (auto text = text_of(word, kArgument, diagnostics, file)) settings.command.push_back(std::move(*text));
    if (is_sound(diagnostics, command->path) && settings.command.front().empty())
      reader.error(*command, "begins with an empty word", "the program's name or path");
  }
  if (const auto socket = reader.optional_text("socket", kSocketPath)) {
    ++given;
    settings.socket = folder / *socket;
  }
  if (const auto port = reader.optional_integer("port", {.min = 1, .max = 65535})) {
    ++given;
    settings.port = *port;
  }
  if (const auto token = reader.optional_text("token", kTokenPath)) {
    try {
      settings.token = read_token(folder / *token);
    } catch (const InputError& error) {
      reader.error("token", error.what());
    }
  } else if (settings.port != 0 && given == 1) {
    reader.error("port", "needs \"token\": any user of this machine can listen on a port",
                 "name a file of mode 0600 whose text the rig's hello carries, or use \"socket\"");
  }
  const std::vector<std::string_view> hosts = {"127.0.0.1", "::1"};
  if (const auto host = reader.word("host", hosts, {}, false)) settings.host = hosts[*host];
  settings.time_outs.hello_s = reader.number_or("hello_s", settings.time_outs.hello_s, kPatience);
  settings.time_outs.prepare_s = reader.number_or("prepare_s", settings.time_outs.prepare_s, kPatience);
  if (given != 1 && is_sound(diagnostics, node.path))
    reader.error(node, given == 0 ? "says nowhere where the rig is" : "says more than one place of the rig",
                 "give one of \"command\", \"socket\" and \"port\"");
  reader.finish();
  return settings;
}

}  // namespace jnd
