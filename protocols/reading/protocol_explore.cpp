// Reads free interaction with objects: the member "explore", and what it excludes elsewhere.
#include <algorithm>

#include <fmt/format.h>

#include "protocols/reading/protocol_reading.h"

namespace jnd {
namespace {

constexpr std::size_t kMostObjects = 8;
constexpr std::size_t kLongestObjectName = 32;

}  // namespace

bool is_object_name(std::string_view name) noexcept {
  return !name.empty() && name.size() <= kLongestObjectName && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  });
}

void read_explore(const JsonNode& node, ProtocolReading& reading) {
  Exploration explore;
  JsonReader reader(node, reading.errors, reading.file);
  explore.duration_s = reader.number("duration_s", {.min = 10, .max = 3600, .unit = "s"});
  if (const JsonNode* objects = reader.array("objects", 1, kMostObjects)) {
    for (const JsonNode& item : objects->items) {
      const auto name = text_of(item, {.max_length = 200}, reading.errors, reading.file);
      if (!name) continue;
      if (!is_object_name(*name))
        reading.error(item, in_quotes(*name) + " cannot be the name of an object",
                      "1 to 32 lower-case letters, digits or -");
      else if (std::find(explore.objects.begin(), explore.objects.end(), *name) != explore.objects.end())
        reading.error(item, fmt::format("the object {} is named twice", in_quotes(*name)), "objects must differ");
      explore.objects.push_back(*name);
    }
  }
  reader.finish();
  reading.protocol.explore = std::move(explore);
}

void refuse_trials(JsonReader& outer) {
  outer.refuse({"task", "standards", "levels", "classes", "trial", "series", "practice", "feedback"},
               "has no meaning with the paradigm \"explore\"", "remove it: there are no trials");
}

void lint_explore(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  if (protocol.resume.redo_block)
    reading.error_at("$.resume.interrupted_block", "there are no answers to redo with the paradigm \"explore\"",
                     "remove it: an object that was interrupted is explored anew, those before it stand");
  for (std::size_t i = 0; i < protocol.breaks.size(); ++i) {
    const std::string path = fmt::format("$.breaks[{}].after", i);
    if (protocol.breaks[i].after != Break::After::block && reading.sound(path))
      reading.error_at(path, "there are neither series nor trials with the paradigm \"explore\"",
                       "write \"block\": after a condition's turn");
  }
  for (std::size_t i = 0; i < protocol.questions.size(); ++i) {
    const std::string path = fmt::format("$.questions[{}].when", i);
    if (protocol.questions[i].when == Question::When::after_series && reading.sound(path))
      reading.error_at(path, "there are no series with the paradigm \"explore\"",
                       "ask \"after-condition\" or \"after-session\"");
  }
}

}  // namespace jnd
