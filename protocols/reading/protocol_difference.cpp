#include "protocols/reading/protocol_difference.h"

#include <algorithm>

#include <fmt/format.h>

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

class Comparison {
 public:
  explicit Comparison(std::size_t limit) noexcept : limit_(std::max<std::size_t>(limit, 1)) {}

  void compare(const JsonNode& before, const JsonNode& after) {
    if (before.kind != after.kind) return add(before.path, shortened(before) + " -> " + shortened(after));
    switch (before.kind) {
      case JsonNode::Kind::null:
        return;
      case JsonNode::Kind::boolean:
        if (before.boolean != after.boolean) add(before.path, shortened(before) + " -> " + shortened(after));
        return;
      case JsonNode::Kind::number:
        if (before.number != after.number) add(before.path, shortened(before) + " -> " + shortened(after));
        return;
      case JsonNode::Kind::string:
        if (before.text != after.text) add_texts(before, after);
        return;
      case JsonNode::Kind::array:
        return compare_lists(before, after);
      case JsonNode::Kind::object:
        return compare_objects(before, after);
    }
  }

  std::vector<std::string> lines() && {
    if (count_ > lines_.size()) lines_.push_back(fmt::format("and {} more", count_ - lines_.size()));
    return std::move(lines_);
  }

 private:
  void add(const std::string& path, const std::string& what) {
    ++count_;
    if (lines_.size() < limit_) lines_.push_back(path + ": " + what);
  }

  // Long texts that begin alike are shown from where they part.
  void add_texts(const JsonNode& before, const JsonNode& after) {
    constexpr std::size_t kLead = 20;
    std::size_t alike = 0;
    while (alike < before.text.size() && alike < after.text.size() && before.text[alike] == after.text[alike]) ++alike;
    const std::size_t from = character_boundary(before.text, alike > 2 * kLead ? alike - kLead : 0);
    const std::string lead = from > 0 ? "..." : "";
    add(before.path, fmt::format("{}{} -> {}{}", lead, in_quotes(std::string_view(before.text).substr(from)), lead,
                                 in_quotes(std::string_view(after.text).substr(from))));
  }

  void compare_lists(const JsonNode& before, const JsonNode& after) {
    const std::size_t common = std::min(before.items.size(), after.items.size());
    for (std::size_t i = 0; i < common; ++i) compare(before.items[i], after.items[i]);
    for (std::size_t i = common; i < before.items.size(); ++i)
      add(before.items[i].path, "removed " + shortened(before.items[i]));
    for (std::size_t i = common; i < after.items.size(); ++i)
      add(after.items[i].path, "added " + shortened(after.items[i]));
  }

  void compare_objects(const JsonNode& before, const JsonNode& after) {
    const bool top = before.path == "$";
    for (std::size_t i = 0; i < before.keys.size(); ++i) {
      if (top && before.keys[i] == "$schema") continue;
      if (const JsonNode* const other = after.find(before.keys[i]))
        compare(before.items[i], *other);
      else
        add(before.items[i].path, "removed " + shortened(before.items[i]));
    }
    for (std::size_t i = 0; i < after.keys.size(); ++i)
      if (before.find(after.keys[i]) == nullptr && !(top && after.keys[i] == "$schema"))
        add(after.items[i].path, "added " + shortened(after.items[i]));
  }

  std::size_t limit_;
  std::size_t count_ = 0;
  std::vector<std::string> lines_;
};

}  // namespace

ProtocolDifference difference_of(std::string_view old_bytes, std::string_view new_bytes, std::size_t limit) {
  const JsonNode before = parse_json(old_bytes, "the old protocol");
  const JsonNode after = parse_json(new_bytes, "the new protocol");
  Comparison comparison(limit);
  comparison.compare(before, after);
  ProtocolDifference difference;
  difference.lines = std::move(comparison).lines();
  difference.same_meaning = difference.lines.empty();
  return difference;
}

}  // namespace jnd
