// The top of the protocol loader: the document's members in turn, then lint.
#include "protocols/reading/protocol_json.h"

#include <algorithm>
#include <utility>

#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"
#include "protocols/reading/protocol_reading.h"
#include "protocols/reading/translation.h"

namespace jnd {
namespace {

std::string name_of_file(const std::string& file) {
  std::string name = std::filesystem::path(file).filename().string();
  if (name.size() > 5 && name.substr(name.size() - 5) == ".json") name.resize(name.size() - 5);
  return name;
}

void read_notes(const JsonNode& list, ProtocolReading& reading) {
  for (const JsonNode& item : list.items) {
    if (auto note = text_of(item, {.max_length = 1000}, reading.errors, reading.file))
      reading.protocol.notes.push_back(std::move(*note));
  }
}

// The tasks that this program has.
JsonReader::Words<TaskKind> task_words() {
  JsonReader::Words<TaskKind> words;
  for (const Task* task : all_tasks()) words.emplace_back(to_string(task->kind()), task->kind());
  return words;
}

// Pairs of stiffnesses, standards and levels, or objects.
void read_what_is_presented(JsonReader& reader, ProtocolReading& reading) {
  if (reading.explores()) {
    if (const JsonNode* node = reader.object("explore")) read_explore(*node, reading);
    return;
  }
  reader.refuse({"explore"}, "belongs to the paradigm \"explore\"", "remove it, or change the paradigm");
  if (!reading.has_pairs()) return read_comparisons(reader, reading);
  reader.refuse({"standards", "levels", "classes"}, "has no meaning with the task \"same-different\"",
                "write \"series\": the pairs");
  if (!reading.adaptive()) {
    if (const JsonNode* list = reader.array("series", 1, 50)) read_series(*list, reading);
  } else if (reader.member("series") != nullptr) {
    reader.error("series", "has no meaning beside $.design.procedure: the answers set the levels",
                 "remove it; the procedure's \"starts\" and \"clamp\" say where they begin and end");
  }
}

// What surrounds the trials, and whom it is for.
void read_session(JsonReader& reader, ProtocolReading& reading) {
  if (!reading.explores())
    if (const JsonNode* node = reader.object_or_null("practice")) read_practice(*node, reading);
  if (const JsonNode* list = reader.array_or_null("breaks", 0, 20)) read_breaks(*list, reading);
  if (const JsonNode* list = reader.array_or_null("checklist", 0, 50)) read_checklist(*list, reading);
  if (const JsonNode* list = reader.array_or_null("instructions", 0, 30)) read_instructions(*list, reading);
  reading.protocol.consent = reader.text_or("consent", "", kPageLimits);
  read_language(reader, reading);
  if (const JsonNode* node = reader.object_or_null("resume")) read_resume(*node, reading);
  reading.protocol.blinded = reader.one_of_or<bool>("blinding", {{"coded", true}, {"open", false}}, true);
}

void read_protocol(ProtocolReading& reading) {
  Protocol& protocol = reading.protocol;
  JsonReader reader(reading.root, reading.errors, reading.file);
  reader.ignore("$schema");
  reader.integer("format", {.min = 1, .max = 1});
  protocol.title = reader.text("title", kTitleLimits);
  if (const JsonNode* node = reader.object("source")) read_source(*node, reading);
  if (const JsonNode* list = reader.array_or_null("notes", 0, 50)) read_notes(*list, reading);
  const JsonNode* published = reader.array_or_null("published", 0, 200);
  const JsonNode* assumed = reader.array_or_null("assumed", 0, 200);
  // First of all the paradigm: it says which of the other members there are.
  protocol.task.kind = reader.one_of<TaskKind>("paradigm", task_words());
  if (const JsonNode* node = reader.object("rig")) read_rig(*node, reading);
  if (reading.explores()) refuse_trials(reader);
  if (!reading.explores()) read_task(reader, reading);
  if (const JsonNode* node = reader.object("stimulus")) read_stimulus(*node, reading);
  if (const JsonNode* list = reader.array("conditions", 1, 20)) read_conditions(*list, reading);
  if (const JsonNode* list = reader.array_or_null("groups", 2, 20)) read_groups(*list, reading);
  read_what_is_presented(reader, reading);
  if (!reading.explores())
    if (const JsonNode* node = reader.object("trial")) read_trial(*node, reading);
  if (const JsonNode* node = reader.object("design")) read_design(*node, reading);
  if (!reading.has_pairs() && !reading.explores()) set_extremes(protocol);
  if (const JsonNode* list = reader.array_or_null("questions", 0, 100)) read_questions(*list, reading);
  // These name conditions, series and questions, so they come after them.
  if (published != nullptr) read_published(*published, reading);
  if (assumed != nullptr) read_assumed(*assumed, reading);
  read_session(reader, reading);
  if (reading.explores()) {
    if (const JsonNode* node = reader.object_or_null("analysis")) read_analysis(*node, reading);
  } else {
    protocol.feedback =
        reader.one_of<Feedback>("feedback", {{"none", Feedback::none}, {"correctness", Feedback::correctness}});
    if (const JsonNode* node = reader.object("analysis")) read_analysis(*node, reading);
  }
  // Its paths name texts of all the others.
  if (const JsonNode* node = reader.object_or_null("translations")) read_translations(*node, reading);
  reader.finish();
}

void sort_by_place(std::vector<Diagnostic>& diagnostics) {
  std::stable_sort(diagnostics.begin(), diagnostics.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
}

}  // namespace

const JsonNode* node_at(const JsonNode& root, std::string_view path) {
  if (root.path == path) return &root;
  for (const JsonNode& item : root.items) {
    const bool leads_there = path.substr(0, item.path.size()) == item.path;
    if (!leads_there) continue;
    if (const JsonNode* node = node_at(item, path)) return node;
  }
  return nullptr;
}

Diagnostic diagnostic_at_path(const JsonNode& root, const std::string& file, std::string_view path, std::string message,
                              std::string suggestion) {
  std::string_view outer = path;
  const JsonNode* node = node_at(root, outer);
  while (node == nullptr && outer.size() > 1) {
    outer = outer.substr(0, outer.find_last_of(".["));
    node = node_at(root, outer);
  }
  return {file,
          node == nullptr ? 0 : node->line,
          node == nullptr ? 0 : node->column,
          std::string(path),
          std::move(message),
          std::move(suggestion)};
}

void ProtocolReading::error_at(std::string_view path, std::string message, std::string suggestion) {
  errors.push_back(diagnostic_at_path(root, file, path, std::move(message), std::move(suggestion)));
}

void ProtocolReading::warn_at(std::string_view path, std::string message, std::string suggestion) {
  warnings.push_back(diagnostic_at_path(root, file, path, std::move(message), std::move(suggestion)));
}

ProtocolCheck check_protocol(std::string bytes, const std::string& file) {
  ProtocolCheck check;
  Protocol protocol;
  try {
    JsonNode root = parse_json(bytes, file);
    round_numbers(root);
    ProtocolReading reading{root, file, protocol, check.errors, check.warnings};
    read_protocol(reading);
    lint_protocol(reading);
    if (check.errors.empty()) warn_about_protocol(reading);
  } catch (const InputError& error) {
    check.errors = error.diagnostics();
  }
  sort_by_place(check.errors);
  sort_by_place(check.warnings);
  if (check.errors.empty()) {
    protocol.sha256 = sha256_hex(bytes);
    protocol.bytes = std::move(bytes);
    protocol.name = name_of_file(file);
    check.protocol = std::move(protocol);
  }
  return check;
}

Protocol parse_protocol(std::string bytes, const std::string& file) {
  ProtocolCheck check = check_protocol(std::move(bytes), file);
  if (!check.protocol) throw InputError(std::move(check.errors));
  return std::move(*check.protocol);
}

Protocol load_protocol(const std::filesystem::path& path) {
  return parse_protocol(read_input_file(path), path.string());
}

}  // namespace jnd
