#include "devices/external/rig_line.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/input/utf8.h"

namespace jnd {

namespace {

constexpr std::size_t kMostQuoted = 120;
constexpr std::size_t kMostReason = 300;
// Ids and numbers of "alive" stay exact in a double.
constexpr double kLargestId = 9007199254740991;
constexpr NumberLimits kNumber{.min = -kLargestRigNumber, .max = kLargestRigNumber};
constexpr NumberLimits kTime{.min = 0, .max = kLongestRigTime_s, .unit = "s"};
constexpr TextLimits kLabel{.max_length = 100};
constexpr NumberLimits kReadyTime{.min = 0, .max = 60, .unit = "s"};
constexpr TextLimits kToken{.max_length = 200};
constexpr TextLimits kUnit{.max_length = 20, .may_be_empty = true};
constexpr TextLimits kChoiceWord{.max_length = 60};

// JSON has one place, the line: only the path is said.
class RigLineReading {
 public:
  std::vector<Diagnostic>& diagnostics() noexcept { return diagnostics_; }
  bool good() const noexcept { return diagnostics_.empty(); }
  std::string reason() const {
    std::string text;
    for (Diagnostic diagnostic : diagnostics_) {
      diagnostic.line = diagnostic.column = 0;
      text += (text.empty() ? "" : "; ") + to_text(diagnostic);
    }
    return ascii_text(text, kMostReason);
  }
  static std::string ascii_text(std::string_view text, std::size_t most) {
    std::string result(text.substr(0, most));
    for (char& letter : result)
      if (letter < ' ' || letter > '~') letter = '?';
    return result;
  }

  std::optional<RigMessage> read(const JsonNode& root, std::string& type) {
    JsonReader reader(root, diagnostics_, {});
    const std::vector<std::string_view> known = {"hello",     "ready",  "contact", "done",
                                                 "telemetry", "answer", "fault",   "alive"};
    const auto word = reader.word("type", known, {}, true);
    if (!word) return std::nullopt;
    type = known[*word];
    RigMessage message = read_type(reader, type);
    reader.finish();
    if (!good()) return std::nullopt;
    return message;
  }

 private:
  RigMessage read_type(JsonReader& reader, std::string_view type) {
    if (type == "hello") return read_hello(reader);
    if (type == "ready") return RigReady{id(reader)};
    if (type == "contact") return RigContact{id(reader), reader.number("time_s", kTime)};
    if (type == "done") return read_done(reader);
    if (type == "telemetry") return RigTelemetry{optional_id(reader), reader.number("time_s", kTime), values(reader)};
    if (type == "answer")
      return RigAnswer{id(reader), reader.text("answer", kChoiceWord), reader.optional_number("after_s", kTime)};
    if (type == "fault") return RigFault{optional_id(reader), reader.text("cause", {.max_length = 200})};
    return RigAlive{whole(reader, "n", 0)};
  }

  RigHello read_hello(JsonReader& reader) {
    RigHello hello;
    reader.integer("protocol", {.min = kExternalProtocol, .max = kExternalProtocol});
    hello.name = reader.text("name", kLabel);
    hello.version = reader.text("version", kLabel);
    hello.serial = reader.text("serial", kLabel);
    hello.model = reader.boolean("model");
    hello.answers = reader.boolean("answers");
    hello.places = reader.integer_or("places", 1, {.min = 1, .max = 2});
    hello.ready_s = reader.number_or("ready_s", 0, kReadyTime);
    hello.holds = reader.boolean_or("holds", true);
    hello.token = reader.text_or("token", "", kToken);
    if (const JsonNode* list = reader.array("quantities", 1, kMostRigItems))
      for (const JsonNode& node : list->items) hello.quantities.push_back(read_range(node, "quantities"));
    if (const JsonNode* list = reader.array("parameters", 0, kMostRigItems))
      for (const JsonNode& node : list->items) hello.parameters.push_back(read_parameter(node));
    if (const JsonNode* list = reader.array("measures", 0, kMostRigItems))
      for (const JsonNode& node : list->items) {
        JsonReader part(node, diagnostics_, {});
        hello.measures.push_back({name(part, "measures"), part.text("unit", kUnit)});
        part.finish();
      }
    return hello;
  }

  RigRange read_range(const JsonNode& node, std::string_view list) {
    JsonReader reader(node, diagnostics_, {});
    RigRange range{name(reader, list), reader.text("unit", kUnit), reader.number("min", kNumber),
                   reader.number("max", kNumber)};
    if (range.min > range.max) reader.error("max", "is below min");
    reader.finish();
    return range;
  }

  RigParameter read_parameter(const JsonNode& node) {
    if (node.find("words") == nullptr) return read_range(node, "parameters");
    JsonReader reader(node, diagnostics_, {});
    RigChoice choice{name(reader, "parameters"), {}};
    if (const JsonNode* list = reader.array("words", 1, kMostRigItems))
      for (const JsonNode& word : list->items) {
        auto text = text_of(word, kChoiceWord, diagnostics_, {});
        if (!text) continue;
        if (std::find(choice.words.begin(), choice.words.end(), *text) != choice.words.end())
          reader.error(word, in_quotes(*text) + " is there twice");
        choice.words.push_back(std::move(*text));
      }
    reader.finish();
    return choice;
  }

  RigDone read_done(JsonReader& reader) {
    RigDone done;
    done.id = id(reader);
    done.outcome = reader.one_of<RigOutcome>("outcome", kRigOutcomeWords);
    done.delivered = reader.optional_number("delivered", kNumber);
    done.delivered_beside = reader.optional_number("delivered_beside", kNumber);
    done.first_contact_s = reader.optional_number("first_contact_s", kTime);
    done.duration_s = reader.number("duration_s", kTime);
    done.contacts = reader.integer("contacts", {.min = 0, .max = 1'000'000});
    done.peaks = numbers(reader.object_or_null("peaks"));
    done.channels = numbers(reader.object_or_null("channels"));
    if (done.first_contact_s && *done.first_contact_s > done.duration_s)
      reader.error("first_contact_s", "is after the presentation's end, duration_s");
    if (done.first_contact_s.has_value() != (done.contacts > 0))
      reader.error("contacts", "and first_contact_s contradict each other");
    if (done.outcome == RigOutcome::no_contact && done.contacts > 0)
      reader.error("outcome", "is no_contact, and there were contacts");
    return done;
  }

  NamedNumbers values(JsonReader& reader) { return numbers(reader.object("values")); }

  NamedNumbers numbers(const JsonNode* object) {
    NamedNumbers result;
    if (object == nullptr) return result;
    JsonReader reader(*object, diagnostics_, {});
    if (object->keys.size() > kMostRigItems) {
      reader.error(*object, fmt::format("has {} numbers, more than {}", object->keys.size(), kMostRigItems));
      return result;
    }
    for (const std::string& key : object->keys) {
      if (!is_name(key)) reader.error(*object, in_quotes(key) + " is no name");
      result.emplace_back(key, reader.number(key, kNumber));
    }
    reader.finish();  // tells keys that are there twice
    return result;
  }

  // blanks: whether there may be some within, as in quantities.
  static bool is_name(std::string_view text, bool blanks = false) noexcept {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    const auto other = [blanks](char c) {
      return (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.' || (blanks && c == ' ');
    };
    return !text.empty() && text.size() <= kLongestRigName && letter(text.front()) && text.back() != ' ' &&
           std::all_of(text.begin(), text.end(), [&](char c) { return letter(c) || other(c); });
  }

  // Of a member of one of hello's lists, in which every name occurs once.
  std::string name(JsonReader& reader, std::string_view list) {
    std::string name = reader.text("name", {.max_length = kLongestRigName});
    if (name.empty()) return name;  // told already
    const bool blanks = list == "quantities";
    if (!is_name(name, blanks))
      reader.error("name", in_quotes(name) + " is no name",
                   blanks ? "a letter, then letters, digits, \"_\", \"-\", \".\" and blanks"
                          : "a letter, then letters, digits, \"_\", \"-\" and \".\"");
    const std::pair<std::string, std::string> entry{list, name};
    if (std::find(names_.begin(), names_.end(), entry) != names_.end())
      reader.error("name", in_quotes(name) + " is there twice");
    names_.push_back(entry);
    return name;
  }

  std::uint64_t id(JsonReader& reader) { return whole(reader, "id", 1); }
  std::optional<std::uint64_t> optional_id(JsonReader& reader) {
    if (reader.member("id") == nullptr) return std::nullopt;
    return id(reader);
  }
  std::uint64_t whole(JsonReader& reader, std::string_view key, double least) const {
    const double value = reader.number(key, {.min = least, .max = kLargestId});
    const JsonNode* node = reader.member(key);
    if (good() && node != nullptr && !node->integer) reader.error(key, "is no whole number");
    return good() ? static_cast<std::uint64_t>(value) : 0;
  }

  std::vector<Diagnostic> diagnostics_;
  std::vector<std::pair<std::string, std::string>> names_;
};

}  // namespace

std::string ascii_quote(std::string_view text) {
  return RigLineReading::ascii_text(text, kMostQuoted);
}

ReadRigLine read_rig_line(std::string_view line) {
  ReadRigLine result;
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line.size() > kLongestRigLine) {
    result.refused = fmt::format("longer than {} bytes", kLongestRigLine);
    return result;
  }
  if (const std::size_t bad = first_invalid_utf8(line); bad != std::string_view::npos) {
    result.refused = fmt::format("byte {} is not UTF-8", bad + 1);
    return result;
  }
  RigLineReading reading;
  try {
    const JsonNode root = parse_json(line, {});
    result.message = reading.read(root, result.type);
  } catch (const InputError& error) {
    reading.diagnostics() = error.diagnostics();
  }
  result.refused = reading.reason();
  return result;
}

}  // namespace jnd
