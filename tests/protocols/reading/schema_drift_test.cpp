// The schema and the loader know the same keys and the same words. Both are asked from outside: the loader names what
// it knows when it meets something that it does not.
#include <algorithm>
#include <functional>
#include <set>

#include <nlohmann/json.hpp>

#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;
using nlohmann::json;

namespace {

constexpr const char* kUnlikely = "zzzzzzzzzzzzzzzz";

// The words in quotes of a message.
std::set<std::string> quoted_words(const std::string& text) {
  std::set<std::string> words;
  std::size_t at = 0;
  while ((at = text.find('"', at)) != std::string::npos) {
    const std::size_t end = text.find('"', at + 1);
    words.insert(text.substr(at + 1, end - at - 1));
    at = end + 1;
  }
  return words;
}

// All keys that any "required" within names.
void collect_required(const json& part, std::set<std::string>& keys) {
  if (!part.is_structured()) return;
  if (part.is_object() && part.contains("required"))
    for (const auto& key : part.at("required")) keys.insert(key.get<std::string>());
  for (const auto& item : part) collect_required(item, keys);
}

// Together these use every member: those of fingertip devices and of joints exclude each other.
std::vector<json> examples() {
  std::vector<json> documents;
  for (const char* const name : {"complete",       "object",         "joint",
                                 "two-devices",    "staircase",      "staircase-accelerated",
                                 "quest",          "posterior",      "staircase-joint",
                                 "explore",        "prescription",   "task-three-alternatives",
                                 "task-which",     "task-adaptive",  "task-posterior",
                                 "task-yes-no",    "task-magnitude", "task-identify",
                                 "task-specimens", "task-adjust",    "groups"})
    documents.push_back(json::parse(read_text(corpus_folder() / "good" / (std::string(name) + ".json"))));
  return documents;
}

struct Walk {
  const json& schema;
  const json& document;
  int objects = 0, enumerations = 0;

  const json& resolved(const json& part) const {
    if (!part.contains("$ref")) return part;
    return schema.at(json::json_pointer(part.at("$ref").get<std::string>().substr(1)));
  }

  // The suggestion of the only error that the loader finds in a changed document.
  std::string suggestion(const json::json_pointer& place, const json& value, const std::string& mark) const {
    json changed = document;
    changed[place] = value;
    for (const Diagnostic& error : check_protocol(changed.dump(1), "walk").errors)
      if (error.message.find(mark) != std::string::npos) return error.suggestion;
    return "no error about " + mark;
  }

  void visit(const json& part_or_reference, const json::json_pointer& place) {
    const json& part = resolved(part_or_reference);
    const json& value = document.at(place);
    CAPTURE(place.to_string());
    if (part.contains("enum")) {
      ++enumerations;
      const auto words = part.at("enum").get<std::set<std::string>>();
      CHECK(quoted_words(suggestion(place, kUnlikely, kUnlikely)) == words);
    }
    if (value.is_object()) {
      ++objects;
      if (!part.contains("properties")) {  // keys of the author's: languages, and paths of texts
        for (const auto& [key, member] : value.items()) visit(part.at("additionalProperties"), place / key);
        return;
      }
      std::set<std::string> keys;
      for (const auto& [key, ignored] : part.at("properties").items()) keys.insert(key);
      CHECK(quoted_words(suggestion(place / kUnlikely, 1, kUnlikely)) == keys);
      for (const auto& [key, member] : value.items()) {
        REQUIRE(keys.count(key) == 1);
        visit(part.at("properties").at(key), place / key);
      }
      // A required member is one whose absence the loader reports.
      const auto required = part.at("required").get<std::set<std::string>>();
      std::set<std::string> conditionals;
      if (part.contains("allOf")) collect_required(part.at("allOf"), conditionals);
      collect_required(schema.at("allOf"), conditionals);  // on the paradigm, at any depth
      for (const auto& [key, member] : value.items()) {
        CAPTURE(key);
        json changed = document;
        changed.at(place).erase(key);
        const auto errors = check_protocol(changed.dump(1), "walk").errors;
        const bool missed = std::any_of(errors.begin(), errors.end(), [&](const Diagnostic& error) {
          return error.message == "\"" + key + "\" is missing";
        });
        const bool conditional = conditionals.count(key) == 1;  // on another member, such as a question's kind
        if (!conditional || required.count(key) == 1) CHECK(missed == (required.count(key) == 1));
      }
    } else if (value.is_array()) {
      for (std::size_t i = 0; i < value.size(); ++i) visit(part.at("items"), place / i);
    }
  }
};

}  // namespace

TEST_CASE("schema and loader know the same keys, required members and words") {
  const json schema = json::parse(read_text(protocols_folder() / "protocol.schema.json"));
  for (const json& document : examples()) {
    CAPTURE(document.at("title").get<std::string>());
    Walk walk{schema, document};
    walk.visit(schema, json::json_pointer());
    CHECK(walk.objects >= 14);
    CHECK(walk.enumerations >= (document.contains("series") || document.contains("practice") ? 12 : 7));
    const bool complete = document.contains("questions") && document.contains("trial");
    if (complete) CHECK(walk.objects >= 25);
    if (complete) CHECK(walk.enumerations >= 23);
  }
}

TEST_CASE("the examples use every key that the schema knows") {
  const json schema = json::parse(read_text(protocols_folder() / "protocol.schema.json"));
  std::string text;
  for (const json& document : examples()) text += document.dump();
  const std::function<void(const json&)> visit = [&](const json& part) {
    if (part.is_object() && part.contains("additionalProperties") && part.contains("properties")) {
      for (const auto& [key, ignored] : part.at("properties").items()) {
        CAPTURE(key);
        CHECK(text.find("\"" + key + "\":") != std::string::npos);
      }
    }
    if (part.is_structured())
      for (const auto& item : part) visit(item);
  };
  visit(schema);
}
