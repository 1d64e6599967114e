#include "protocols/reading/protocol_difference.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocols/input/json_document.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/utf8.h"

namespace jnd {
namespace {

constexpr std::size_t kValueLength = 60;

void write(const JsonNode& node, std::string& text) {
  if (text.size() > kValueLength) return;
  switch (node.kind) {
    case JsonNode::Kind::null:
      text += "null";
      return;
    case JsonNode::Kind::boolean:
      text += node.boolean ? "true" : "false";
      return;
    case JsonNode::Kind::number:
      text += node.text;
      return;
    case JsonNode::Kind::string:
      text += in_quotes(node.text);
      return;
    case JsonNode::Kind::array:
    case JsonNode::Kind::object:
      break;
  }
  const bool is_object = node.kind == JsonNode::Kind::object;
  text += is_object ? "{" : "[";
  for (std::size_t i = 0; i < node.items.size() && text.size() <= kValueLength; ++i) {
    if (i > 0) text += ", ";
    if (is_object) text += in_quotes(node.keys[i]) + ": ";
    write(node.items[i], text);
  }
  text += is_object ? "}" : "]";
}

std::string shortened(const JsonNode& node) {
  std::string text;
  write(node, text);
  // in_quotes has shortened long texts already, and their quotes belong to them.
  const bool whole = node.kind == JsonNode::Kind::string || text.size() <= kValueLength;
  if (whole) return text;
  return text.substr(0, character_boundary(text, kValueLength)) + "...";
}

// The whole value as JSON, in which numbers are as they were written.
void write_json(const JsonNode& node, std::string& text) {
  const auto quoted = [](const std::string& plain) {
    return nlohmann::json(plain).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  };
  if (node.kind == JsonNode::Kind::string) {
    text += quoted(node.text);
    return;
  }
  const bool is_object = node.kind == JsonNode::Kind::object;
  if (!is_object && node.kind != JsonNode::Kind::array) {
    std::string scalar;  // write() looks at how long its text is already
    write(node, scalar);
    text += scalar;
    return;
  }
  text += is_object ? "{" : "[";
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    if (i > 0) text += ", ";
    if (is_object) text += quoted(node.keys[i]) + ": ";
    write_json(node.items[i], text);
  }
  text += is_object ? "}" : "]";
}

std::string whole(const JsonNode& node) {
  std::string text;
  write_json(node, text);
  return text;
}

class Comparison {
 public:
  explicit Comparison(std::size_t limit) noexcept : limit_(std::max<std::size_t>(limit, 1)) {}

  void compare(const JsonNode& before, const JsonNode& after) {
    if (before.kind != after.kind) return changed(before, after);
    switch (before.kind) {
      case JsonNode::Kind::null:
        return;
      case JsonNode::Kind::boolean:
        if (before.boolean != after.boolean) changed(before, after);
        return;
      case JsonNode::Kind::number:
        if (before.number != after.number) changed(before, after);
        return;
      case JsonNode::Kind::string:
        if (before.text != after.text) changed_text(before, after);
        return;
      case JsonNode::Kind::array:
        return compare_lists(before, after);
      case JsonNode::Kind::object:
        return compare_objects(before, after);
    }
  }

  ProtocolDifference difference() && {
    if (changes_.size() > lines_.size()) lines_.push_back(fmt::format("and {} more", changes_.size() - lines_.size()));
    return {changes_.empty(), std::move(lines_), std::move(changes_)};
  }

 private:
  void add(const std::string& what, ProtocolChange change) {
    if (lines_.size() < limit_) lines_.push_back(change.path + ": " + what);
    changes_.push_back(std::move(change));
  }

  void changed(const JsonNode& before, const JsonNode& after) {
    add(shortened(before) + " -> " + shortened(after), {before.path, whole(before), whole(after)});
  }

  void removed(const JsonNode& node) { add("removed " + shortened(node), {node.path, whole(node), ""}); }
  void added(const JsonNode& node) { add("added " + shortened(node), {node.path, "", whole(node)}); }

  // Long texts that begin alike are shown from where they part.
  void changed_text(const JsonNode& before, const JsonNode& after) {
    constexpr std::size_t kLead = 20;
    std::size_t alike = 0;
    while (alike < before.text.size() && alike < after.text.size() && before.text[alike] == after.text[alike]) ++alike;
    const std::size_t from = character_boundary(before.text, alike > 2 * kLead ? alike - kLead : 0);
    const std::string lead = from > 0 ? "..." : "";
    add(fmt::format("{}{} -> {}{}", lead, in_quotes(std::string_view(before.text).substr(from)), lead,
                    in_quotes(std::string_view(after.text).substr(from))),
        {before.path, whole(before), whole(after)});
  }

  void compare_lists(const JsonNode& before, const JsonNode& after) {
    const std::size_t common = std::min(before.items.size(), after.items.size());
    for (std::size_t i = 0; i < common; ++i) compare(before.items[i], after.items[i]);
    for (std::size_t i = common; i < before.items.size(); ++i) removed(before.items[i]);
    for (std::size_t i = common; i < after.items.size(); ++i) added(after.items[i]);
  }

  void compare_objects(const JsonNode& before, const JsonNode& after) {
    const bool top = before.path == "$";
    for (std::size_t i = 0; i < before.keys.size(); ++i) {
      if (top && before.keys[i] == "$schema") continue;
      if (const JsonNode* const other = after.find(before.keys[i]))
        compare(before.items[i], *other);
      else
        removed(before.items[i]);
    }
    for (std::size_t i = 0; i < after.keys.size(); ++i)
      if (before.find(after.keys[i]) == nullptr && !(top && after.keys[i] == "$schema")) added(after.items[i]);
  }

  std::size_t limit_;
  std::vector<std::string> lines_;
  std::vector<ProtocolChange> changes_;
};

}  // namespace

ProtocolDifference difference_of(std::string_view old_bytes, std::string_view new_bytes, std::size_t limit) {
  const JsonNode before = parse_json(old_bytes, "the old protocol");
  const JsonNode after = parse_json(new_bytes, "the new protocol");
  Comparison comparison(limit);
  comparison.compare(before, after);
  return std::move(comparison).difference();
}

}  // namespace jnd
