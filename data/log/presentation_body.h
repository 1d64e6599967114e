// What was delivered in an interval, as JSON in an event's body and back. Internal to this room: event_body.h is what
// others use. The keys are part of the file format: data/README.md describes them.
#pragma once

#include <optional>

#include <nlohmann/json.hpp>

#include "protocols/vocabulary.h"

namespace jnd {

// JSON has no NaN: a number that could not be computed is stored as null.
double number_at(const nlohmann::ordered_json& body, const char* key);
nlohmann::ordered_json number_or_null(const std::optional<double>& value);
// A stored key that carries the study's unit: "stiffness_" + "n_per_m".
std::string key_with(const char* name, std::string_view suffix);

nlohmann::ordered_json presentation_body(const Presentation& presentation, Unit unit);
// Reads what any version of the program has written: fingers without their place, channel and interventions too.
// Throws nlohmann::json::exception and StorageError.
Presentation presentation_from(const nlohmann::ordered_json& body, Unit unit);

}  // namespace jnd
