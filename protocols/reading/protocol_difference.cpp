#include "protocols/reading/protocol_difference.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

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

std::string order_text(const std::vector<std::string_view>& names) {
  std::string text;
  for (const std::string_view name : names) {
    if (text.size() > kValueLength) return text + ", ...";
    text += (text.empty() ? "" : ", ") + in_quotes(name);
  }
  return text;
}

std::string whole(const JsonNode& node) {
  std::string text;
  write_json(node, text);
  return text;
}

// The same value, whatever the order of members.
bool same_value(const JsonNode& a, const JsonNode& b) {
  if (a.kind != b.kind || a.items.size() != b.items.size()) return false;
  switch (a.kind) {
    case JsonNode::Kind::null:
      return true;
    case JsonNode::Kind::boolean:
      return a.boolean == b.boolean;
    case JsonNode::Kind::number:
      return a.number == b.number;
    case JsonNode::Kind::string:
      return a.text == b.text;
    case JsonNode::Kind::array:
      return std::equal(a.items.begin(), a.items.end(), b.items.begin(), same_value);
    case JsonNode::Kind::object:
      break;
  }
  for (std::size_t i = 0; i < a.keys.size(); ++i) {
    const JsonNode* const other = b.find(a.keys[i]);
    if (other == nullptr || !same_value(a.items[i], *other)) return false;
  }
  return true;
}

using Names = std::vector<std::string_view>;

// What the items of a list are called by that key; none where one of them is not called so, or as another one is.
std::optional<Names> names_by(const char* key, const JsonNode& list) {
  Names names;
  for (const JsonNode& item : list.items) {
    const JsonNode* const name = item.kind == JsonNode::Kind::object ? item.find(key) : nullptr;
    if (name == nullptr || name->kind != JsonNode::Kind::string) return std::nullopt;
    if (std::find(names.begin(), names.end(), name->text) != names.end()) return std::nullopt;
    names.emplace_back(name->text);
  }
  return names;
}

// Of two lists of named things, such as conditions or questions.
std::optional<std::pair<Names, Names>> names_of_both(const JsonNode& before, const JsonNode& after) {
  for (const char* key : {"id", "name"}) {
    std::optional<Names> old_names = names_by(key, before), new_names = names_by(key, after);
    if (old_names && new_names) return std::pair{std::move(*old_names), std::move(*new_names)};
  }
  return std::nullopt;
}

Names common_to(const Names& names, const Names& others) {
  Names common;
  std::copy_if(names.begin(), names.end(), std::back_inserter(common), [&others](std::string_view name) {
    return std::find(others.begin(), others.end(), name) != others.end();
  });
  return common;
}

// Places in both lists, ascending.
using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

// A longest common subsequence of equal items. Beyond some thousands by thousands of items that differ, only what the
// two lists begin and end with: the table would take too much memory.
Pairs equal_items(const std::vector<JsonNode>& before, const std::vector<JsonNode>& after) {
  constexpr std::size_t kMostCells = 4'000'000;
  Pairs pairs;
  std::size_t begin = 0, old_end = before.size(), new_end = after.size();
  for (; begin < std::min(old_end, new_end) && same_value(before[begin], after[begin]); ++begin)
    pairs.emplace_back(begin, begin);
  while (old_end > begin && new_end > begin && same_value(before[old_end - 1], after[new_end - 1]))
    --old_end, --new_end;
  const std::size_t rows = old_end - begin, columns = new_end - begin;
  if (rows * columns <= kMostCells) {
    // longest[i][j]: of what follows place i in the old list and j in the new one.
    std::vector<std::vector<int>> longest(rows + 1, std::vector<int>(columns + 1, 0));
    for (std::size_t i = rows; i-- > 0;)
      for (std::size_t j = columns; j-- > 0;)
        longest[i][j] = same_value(before[begin + i], after[begin + j])
                            ? longest[i + 1][j + 1] + 1
                            : std::max(longest[i + 1][j], longest[i][j + 1]);
    for (std::size_t i = 0, j = 0; i < rows && j < columns;) {
      if (same_value(before[begin + i], after[begin + j]))
        pairs.emplace_back(begin + i++, begin + j++);
      else if (longest[i + 1][j] >= longest[i][j + 1])
        ++i;
      else
        ++j;
    }
  }
  for (; old_end < before.size(); ++old_end, ++new_end) pairs.emplace_back(old_end, new_end);
  return pairs;
}

class Comparison {
 public:
  explicit Comparison(std::size_t limit) noexcept : limit_(std::max<std::size_t>(limit, 1)) {}

  void compare(const JsonNode& before, const JsonNode& after) {
    if (before.kind != after.kind) return changed(before, after);
    if (before.kind == JsonNode::Kind::array) return compare_lists(before, after);
    if (before.kind == JsonNode::Kind::object) return compare_objects(before, after);
    if (same_value(before, after)) return;
    if (before.kind == JsonNode::Kind::string) return changed_text(before, after);
    changed(before, after);
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
    if (const auto names = names_of_both(before, after))
      compare_named(before, names->first, after, names->second);
    else
      compare_unnamed(before, after);
  }

  void compare_named(const JsonNode& before, const Names& old_names, const JsonNode& after, const Names& new_names) {
    for (std::size_t i = 0; i < old_names.size(); ++i) {
      const auto found = std::find(new_names.begin(), new_names.end(), old_names[i]);
      if (found == new_names.end())
        removed(before.items[i]);
      else
        compare(before.items[i], after.items[static_cast<std::size_t>(found - new_names.begin())]);
    }
    const Names old_order = common_to(old_names, new_names), new_order = common_to(new_names, old_names);
    if (old_order != new_order)
      add(fmt::format("the order {} -> {}", order_text(old_order), order_text(new_order)),
          {before.path, whole(before), whole(after)});
    for (std::size_t i = 0; i < new_names.size(); ++i)
      if (std::find(old_names.begin(), old_names.end(), new_names[i]) == old_names.end()) added(after.items[i]);
  }

  // What stands between equal items of both is compared by its place there.
  void compare_unnamed(const JsonNode& before, const JsonNode& after) {
    Pairs pairs = equal_items(before.items, after.items);
    pairs.emplace_back(before.items.size(), after.items.size());
    std::size_t i = 0, j = 0;
    for (const auto& [old_place, new_place] : pairs) {
      while (i < old_place && j < new_place) compare(before.items[i++], after.items[j++]);
      while (i < old_place) removed(before.items[i++]);
      while (j < new_place) added(after.items[j++]);
      i = old_place + 1;
      j = new_place + 1;
    }
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
