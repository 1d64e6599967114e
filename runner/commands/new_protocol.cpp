#include "runner/commands/new_protocol.h"

#include <optional>

#include <fmt/format.h>

#include "data/files/draft.h"
#include "protocols/input/read_file.h"
#include "protocols/input/resources.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

std::filesystem::path protocol_file(const std::string& name) {
  return name.ends_with(".json") ? name : name + ".json";
}

void write_new_protocol(const std::filesystem::path& file, const std::string& bytes, const std::string& what) {
  Draft protocol(file, Draft::What::file, Draft::Access::everyone);
  protocol.write(bytes);
  // The protocol names its schema by a relative path, so that editors help with it; some name another one. Both are on
  // the disk before either gets its name.
  const std::filesystem::path schema =
      find_resource(Resource::protocol, "tutorial").parent_path() / "protocol.schema.json";
  const std::filesystem::path copy = file.parent_path() / schema.filename();
  std::optional<Draft> help;
  if (bytes.find("\"./protocol.schema.json\"") != std::string::npos && std::filesystem::exists(schema) &&
      !std::filesystem::exists(std::filesystem::symlink_status(copy))) {
    help.emplace(copy, Draft::What::file, Draft::Access::everyone);
    help->write(read_input_file(schema));
  }
  if (!protocol.publish()) throw UsageError(fmt::format("{} exists already; choose another name", file.string()));
  fmt::print("{} written, {}.\n", printable(file.string()), what);
  if (help && help->publish())
    fmt::print("  protocol.schema.json is beside it: editors that know JSON Schema help while you type\n");
}

}  // namespace jnd
