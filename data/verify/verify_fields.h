// What the bodies of small events hold, so that whatever reads them later can. Internal to verify.
#pragma once

#include <string_view>

#include <nlohmann/json.hpp>

namespace jnd {

// Of a kind of event whose fields stand for themselves (notes, pauses, ends, answers to questions): throws StorageError
// where one that is there is of another type than its kind writes, or where one is missing without which the event says
// nothing. Nothing of other kinds.
void check_fields(std::string_view kind, const nlohmann::ordered_json& body);

}  // namespace jnd
