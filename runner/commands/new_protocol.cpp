#include "runner/commands/new_protocol.h"

#include <cmath>
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

namespace {

using nlohmann::ordered_json;

constexpr std::size_t kLineWidth = 118;

std::string quoted(const std::string& text) {
  return ordered_json(text).dump();
}

// Whole numbers without ".0".
std::string scalar(const ordered_json& value) {
  if (value.is_number_float() && value.get<double>() == std::floor(value.get<double>()))
    return fmt::format("{:.0f}", value.get<double>());
  return value.dump();
}

std::string on_one_line(const ordered_json& value) {
  if (!value.is_structured()) return scalar(value);
  std::string text;
  for (const auto& [key, item] : value.items()) {
    if (!text.empty()) text += ", ";
    if (value.is_object()) text.append(quoted(key)).append(": ");
    text += on_one_line(item);
  }
  return value.is_object() ? "{" + text + '}' : "[" + text + ']';
}

// before: what stands on the line before the value, and after: its comma.
std::string spread(const ordered_json& value, std::size_t indent, std::size_t before) {
  std::string line = on_one_line(value);
  if (indent > 0 && before + line.size() + 1 <= kLineWidth) return line;
  if (!value.is_structured() || value.empty()) return line;
  const std::string margin(indent + 2, ' ');
  std::string text(1, value.is_object() ? '{' : '[');
  bool first = true;
  for (const auto& [key, item] : value.items()) {
    text += first ? "\n" : ",\n";
    first = false;
    const std::string name = value.is_object() ? quoted(key) + ": " : "";
    text.append(margin).append(name).append(spread(item, indent + 2, margin.size() + name.size()));
  }
  text.append("\n").append(indent, ' ');
  return text + (value.is_object() ? '}' : ']');
}

}  // namespace

std::string readable_json(const ordered_json& document) {
  return spread(document, 0, 0) + '\n';
}

}  // namespace jnd
