// Builds JsonNode trees from the events of nlohmann's SAX parser, and says in plain words what is wrong with a text.
//
// The parser checks the grammar; places come from a cursor of ours that follows the events: each event is one token,
// and between two tokens there are only blanks, commas and colons.
#include "protocols/input/json_document.h"

#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/numerics/decimal_order.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/json_syntax.h"
#include "protocols/input/json_text.h"
#include "protocols/input/utf8.h"

namespace jnd {
namespace {

constexpr std::size_t kMaxBytes = 1U << 20U;
// Every value knows its path, so that memory grows with depth x length of keys x values: each has a bound.
constexpr std::size_t kMaxKeyBytes = 256;
constexpr std::size_t kMaxValues = 20000;
constexpr std::size_t kMaxMembers = 2000;

class TreeBuilder {
 public:
  using number_integer_t = nlohmann::json::number_integer_t;
  using number_unsigned_t = nlohmann::json::number_unsigned_t;
  using number_float_t = nlohmann::json::number_float_t;
  using string_t = nlohmann::json::string_t;
  using binary_t = nlohmann::json::binary_t;

  TreeBuilder(std::string_view bytes, const std::string& file) : cursor_(bytes), bytes_(bytes), file_(file) {}

  bool null() {
    add(JsonNode::Kind::null);
    return true;
  }
  bool boolean(bool value) {
    add(JsonNode::Kind::boolean).boolean = value;
    return true;
  }
  bool number_integer(number_integer_t value) { return add_number(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) { return add_number(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t&) { return add_number(value); }
  bool string(string_t& value) {
    add(JsonNode::Kind::string).text = std::move(value);
    return true;
  }
  bool binary(binary_t&) { return false; }  // has no form in JSON text
  bool start_object(std::size_t) { return open(JsonNode::Kind::object); }
  bool start_array(std::size_t) { return open(JsonNode::Kind::array); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(string_t& value) {
    const Token token = cursor_.next();
    const auto place = cursor_.place(token.begin);
    if (value.size() > kMaxKeyBytes)
      fail(token.begin, fmt::format("a key of {} bytes", value.size()),
           fmt::format("at most {} are allowed", kMaxKeyBytes));
    if (open_.back()->keys.size() == kMaxMembers)
      fail(token.begin, fmt::format("an object of more than {} members", kMaxMembers), "is it the right file?");
    open_.back()->keys.push_back(std::move(value));
    open_.back()->key_places.push_back(place);
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error) {
    std::vector<std::size_t> open_brackets;
    for (const auto& [node, begin] : brackets_) open_brackets.push_back(begin);
    SyntaxError found = explain_syntax_error(bytes_, cursor_.end_of_last(), position, error.what(), open_brackets);
    fail(found.offset, std::move(found.message), std::move(found.suggestion));
    return false;
  }

  [[noreturn]] void fail(std::size_t offset, std::string message, std::string suggestion) {
    const auto [line, column] = cursor_.place(offset);
    throw InputError(std::vector<Diagnostic>{{file_, line, column, "", std::move(message), std::move(suggestion)}});
  }

  JsonNode take() { return std::move(root_); }

 private:
  JsonNode& add(JsonNode::Kind kind) {
    const Token token = cursor_.next();
    if (++values_ > kMaxValues)
      fail(token.begin, fmt::format("more than {} values", kMaxValues), "is it the right file?");
    JsonNode* node = &root_;
    if (open_.empty()) {
      root_.path.assign(1, '$');
    } else {
      JsonNode& parent = *open_.back();
      parent.items.emplace_back();
      node = &parent.items.back();
      node->path = parent.kind == JsonNode::Kind::object ? member_path(parent.path, parent.keys.back())
                                                         : fmt::format("{}[{}]", parent.path, parent.items.size() - 1);
    }
    node->kind = kind;
    std::tie(node->line, node->column) = cursor_.place(token.begin);
    if (kind == JsonNode::Kind::number) node->text = std::string(bytes_.substr(token.begin, token.end - token.begin));
    last_begin_ = token.begin;
    return *node;
  }

  bool add_number(double value) {
    JsonNode& node = add(JsonNode::Kind::number);
    node.number = value;
    node.integer = value == std::trunc(value);
    return true;
  }

  bool open(JsonNode::Kind kind) {
    JsonNode& node = add(kind);
    if (open_.size() == kMostJsonDepth) {
      fail(last_begin_, fmt::format("nested deeper than {} levels", kMostJsonDepth), "this is not a file of ours");
    }
    open_.push_back(&node);
    brackets_.emplace_back(&node, last_begin_);
    return true;
  }

  bool close() {
    (void)cursor_.next();
    open_.pop_back();
    brackets_.pop_back();
    return true;
  }

  TokenCursor cursor_;
  std::string_view bytes_;
  const std::string& file_;
  JsonNode root_;
  // The objects and arrays that are open, outermost first. The pointers stay good: a parent does not grow while a child
  // is open.
  std::vector<JsonNode*> open_;
  std::vector<std::pair<JsonNode*, std::size_t>> brackets_;
  std::size_t last_begin_ = 0;
  std::size_t values_ = 0;
};

}  // namespace

const JsonNode* JsonNode::find(std::string_view key) const noexcept {
  for (std::size_t i = 0; i < keys.size() && i < items.size(); ++i)
    if (keys[i] == key) return &items[i];
  return nullptr;
}

JsonNode parse_json(std::string_view bytes, const std::string& file) {
  TreeBuilder builder(bytes, file);
  if (bytes.size() > kMaxBytes) {
    builder.fail(0, fmt::format("the file has {} bytes; at most 1 MiB is read", bytes.size()), "is it the right file?");
  }
  if (bytes.substr(0, 3) == "\xEF\xBB\xBF") {
    builder.fail(0, "the file begins with a byte order mark", "save it as UTF-8 without BOM");
  }
  if (const std::size_t bad = first_invalid_utf8(bytes); bad != std::string_view::npos) {
    builder.fail(bad, fmt::format("byte 0x{:02X} is not UTF-8 text", static_cast<unsigned char>(bytes[bad])),
                 "save the file as UTF-8");
  }
  if (const std::size_t zero = bytes.find('\0'); zero != std::string_view::npos) {
    builder.fail(zero, "a NUL byte in the text", "save the file as plain UTF-8 text");
  }
  nlohmann::json::sax_parse(bytes.begin(), bytes.end(), &builder);
  return builder.take();
}

void round_numbers(JsonNode& node) {
  node.number = plain_decimal(node.number);
  for (JsonNode& item : node.items) round_numbers(item);
}

}  // namespace jnd
