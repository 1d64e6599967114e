// Reads the factors of the design: the members "conditions", "series" and "design".
#include <algorithm>

#include <fmt/format.h>

#include "protocols/reading/protocol_reading.h"

namespace jnd {
namespace {

Order read_order(JsonReader& reader, std::string_view key) {
  return reader.one_of<Order>(key, {{"fixed", Order::fixed},
                                    {"random", Order::random},
                                    {"permuted", Order::permuted},
                                    {"williams", Order::williams}});
}

// A cue that no device of the rig renders.
void look_at_cue(const JsonNode& item, bool of_joint, ProtocolReading& reading) {
  const RigRequest& rig = reading.protocol.rig;
  if (!reading.knows_rig() || (of_joint ? acts_on_joint(rig) : acts_on_pulp(rig))) return;
  reading.error(item, fmt::format("{} cannot be rendered by {}", in_quotes(item.text), in_quotes(rig.device)),
                of_joint ? "it needs a McKibben finger: the rig \"mckibben\" or \"rrs3+mckibben\""
                         : "it needs a 3RRS device: the rig \"rrs3\" or \"rrs3+mckibben\"");
}

Cues read_cues(const JsonNode& list, ProtocolReading& reading) {
  static const std::vector<std::string_view> kCues = {"force", "vibration", "kinaesthetic"};
  Cues cues;
  if (list.items.empty())
    reading.error(list, "a condition without a cue renders nothing", "name one or more of " + listed(kCues));
  for (const JsonNode& item : list.items) {
    const auto place = word_of(item, kCues, {}, reading.errors, reading.file);
    if (!place) continue;
    bool& cue = *place == 0 ? cues.force : *place == 1 ? cues.vibration : cues.kinaesthetic;
    if (cue)
      reading.error(item, in_quotes(item.text) + " is named twice", "remove one");
    else
      look_at_cue(item, *place == 2, reading);
    cue = true;
  }
  return cues;
}

// What a rig that is none of ours is told of the condition.
void read_parameters(const JsonNode& node, std::map<std::string, ParameterValue>& parameters,
                     ProtocolReading& reading) {
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const JsonNode& item = node.items[i];
    const std::string& key = node.keys[i];
    const bool good = !key.empty() && key.size() <= 32 && std::all_of(key.begin(), key.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    });
    if (!good)
      reading.error(item, in_quotes(key) + " cannot be the name of a parameter", "1 to 32 letters, digits or _");
    else if (parameters.contains(key))
      reading.error(item, in_quotes(key) + " is given twice", "remove one");
    else if (item.kind == JsonNode::Kind::number)
      parameters[key] = item.number;
    else if (item.kind == JsonNode::Kind::boolean)
      parameters[key] = item.boolean;
    else if (const auto text = text_of(item, {.max_length = 200, .may_be_empty = true}, reading.errors, reading.file))
      parameters[key] = *text;
  }
}

// What of them is otherwise where the standard is felt.
void read_standard_parameters(const JsonNode& node, Condition& condition, ProtocolReading& reading) {
  read_parameters(node, condition.standard_parameters, reading);
  const TaskSpec& task = reading.protocol.task;
  if (task.kind != TaskKind::which && task.kind != TaskKind::adjust) {
    reading.error(node, "needs a standard that is felt in an interval or a place of its own",
                  "remove it, or take the task \"which\" or \"adjust\"");
    return;
  }
  if (reading.protocol.rig.device == kSpecimenRig) {
    reading.error(node, "is for a rig that is told its parameters", "remove it: the operator's hands are told nothing");
    return;
  }
  for (const auto& [name, value] : condition.standard_parameters)
    if (!condition.parameters.contains(name))
      reading.error(node, fmt::format("{} is no parameter of the condition", in_quotes(name)),
                    "give it in \"parameters\" too: that is what holds for the comparison");
}

// Of a rig that is none of ours: parameters instead of cues.
void read_rig_settings(JsonReader& reader, Condition& condition, ProtocolReading& reading) {
  if (const JsonNode* parameters = reader.object_or_null("parameters"))
    read_parameters(*parameters, condition.parameters, reading);
  if (const JsonNode* parameters = reader.object_or_null("standard_parameters"))
    read_standard_parameters(*parameters, condition, reading);
  reader.refuse({"cues", "devices"},
                fmt::format("belongs to our own devices, not to {}", in_quotes(reading.protocol.rig.device)),
                "remove it: \"parameters\" say what the rig is to do");
}

// Whether the condition has devices, and what these render.
void read_devices(JsonReader& reader, Condition& condition, ProtocolReading& reading) {
  if (reading.explores()) {
    condition.devices = reader.boolean_or("devices", true);
  } else if (reader.member("devices") != nullptr) {
    reader.error("devices", "belongs to the paradigm \"explore\"", "remove it: every trial is rendered by devices");
  }
  if (condition.devices) {
    if (const JsonNode* cues = reader.array("cues", 0, 3)) condition.cues = read_cues(*cues, reading);
  } else if (reader.member("cues") != nullptr) {
    reader.error("cues", "nothing renders them without devices", "remove it, or \"devices\": false");
  }
}

template <typename Named>
std::optional<int> place_of(const JsonNode& name, const std::vector<Named>& all, std::string_view what,
                            ProtocolReading& reading) {
  const auto text = text_of(name, {.max_length = 100}, reading.errors, reading.file);
  if (!text) return std::nullopt;
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name == *text) return static_cast<int>(i);
    if (!all[i].name.empty()) names.push_back(all[i].name);
  }
  reading.error(name, fmt::format("there is no {} {}", what, in_quotes(*text)),
                names.empty() ? "" : "known: " + listed(names));
  return std::nullopt;
}

}  // namespace

std::optional<std::string> read_name(JsonReader& reader, std::string_view key, ProtocolReading& reading) {
  const std::string text = reader.text(key, {.max_length = 200});
  const JsonNode* node = reader.node().find(key);
  if (text.empty() || node == nullptr) return std::nullopt;
  const bool good = text.size() <= 16 && std::all_of(text.begin(), text.end(), [](char c) {
                      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                             c == '+' || c == '-';
                    });
  if (good) return text;
  reading.error(*node, in_quotes(text) + " cannot be a name",
                "1 to 16 letters, digits, _, + or -; a label may say the rest");
  return std::nullopt;
}

std::optional<int> condition_place(const JsonNode& name, ProtocolReading& reading) {
  return place_of(name, reading.protocol.conditions, "condition", reading);
}

std::optional<int> series_place(const JsonNode& name, ProtocolReading& reading) {
  return place_of(name, reading.protocol.series, "series", reading);
}

void read_conditions(const JsonNode& list, ProtocolReading& reading) {
  for (const JsonNode& item : list.items) {
    Condition condition;
    JsonReader reader(item, reading.errors, reading.file);
    condition.name = read_name(reader, "name", reading).value_or("");
    condition.label = reader.text("label", {.max_length = 100});
    if (reading.protocol.rig.built_in()) {
      read_devices(reader, condition, reading);
      reader.refuse({"parameters", "standard_parameters"}, "belong to the rigs \"external\" and \"specimens\"",
                    "remove them: our devices have cues");
    } else {
      read_rig_settings(reader, condition, reading);
    }
    if (reading.explores())
      reader.refuse({"prescription"}, "has no meaning with the paradigm \"explore\"", "remove it: there are no trials");
    else if (const JsonNode* prescription = reader.object_or_null("prescription"))
      condition.prescription = read_prescription(*prescription, reading);
    reader.finish();
    reading.protocol.conditions.push_back(std::move(condition));
  }
}

void read_series(const JsonNode& list, ProtocolReading& reading) {
  const Unit unit = reading.protocol.stimulus.unit;
  for (const JsonNode& item : list.items) {
    Series series;
    series.standard = reading.protocol.stimulus.reference;
    JsonReader reader(item, reading.errors, reading.file);
    series.name = read_name(reader, "name", reading).value_or("");
    if (const JsonNode* pair = reader.array("pair", 2, 2)) {
      for (std::size_t i = 0; i < 2; ++i) {
        series.pair[i] =
            number_of(pair->items[i], value_limits(reading.protocol), reading.errors, reading.file).value_or(0);
      }
      if (reading.sound(pair->path) && series.pair[0] == series.pair[1]) {
        reading.error(*pair,
                      fmt::format("both {} are {} {}", reading.protocol.rig.built_in() ? "stiffnesses" : "values",
                                  plain(series.pair[0]), to_string(unit)),
                      reading.protocol.rig.built_in() ? "a series compares two different stiffnesses"
                                                      : "a series compares two different values");
      }
    }
    reader.finish();
    reading.protocol.series.push_back(std::move(series));
  }
}

void read_design(const JsonNode& node, ProtocolReading& reading) {
  Design& design = reading.protocol.design;
  JsonReader reader(node, reading.errors, reading.file);
  design.participants = reader.integer("participants", {.min = 1, .max = 1000});
  design.sessions = reader.integer_or("sessions", 1, {.min = 1, .max = 20});
  read_allotment(reader, reading);
  if (reading.explores()) {
    reader.refuse({"trials_per_cell", "sampling", "run_limit", "procedure", "conditions", "per_series"},
                  "has no meaning with the paradigm \"explore\"", "remove it: there are no trials");
    if (const JsonNode* order = reader.object("order")) {
      JsonReader part(*order, reading.errors, reading.file);
      design.condition_order = read_order(part, "conditions");
      part.refuse({"series"}, "there are no series to order", "remove it; objects are always dealt");
      part.finish();
    }
    return reader.finish();
  }
  const JsonNode* procedure = reader.object_or_null("procedure");
  if (reading.adaptive()) {
    reader.refuse({"trials_per_cell", "sampling", "run_limit"}, "has no meaning beside \"procedure\"",
                  "remove it: the procedure's \"stop\" and \"catch_share\" say how many trials there are");
    if (procedure != nullptr) read_procedure(*procedure, reading);
  } else {
    design.trials_per_cell = reader.integer("trials_per_cell", {.min = reading.has_pairs() ? 2 : 1, .max = 2000});
    design.sampling =
        reader.one_of<Sampling>("sampling", {{"random", Sampling::random}, {"balanced", Sampling::balanced}});
    design.run_limit = reader.optional_integer("run_limit", {.min = 1, .max = 1000});
    if (design.run_limit && reading.protocol.task.classes.size() != 2)
      reader.error("run_limit", "limits runs of one of two kinds of trials, which this task has not", "remove it");
  }
  design.arrangement =
      reader.one_of<Arrangement>("conditions", {{"blocked", Arrangement::blocked}, {"mixed", Arrangement::mixed}});
  if (const JsonNode* order = reader.object("order")) {
    JsonReader part(*order, reading.errors, reading.file);
    design.series_order = read_order(part, "series");
    design.condition_order = read_order(part, "conditions");
    part.finish();
  }
  design.per_series = reader.boolean_or("per_series", false);
  reader.finish();
}

}  // namespace jnd
