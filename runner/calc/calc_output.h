// What a command of `jnd calc` answers, as blocks (data/fields/block.h): tables for a person, JSON for machines.
#pragma once

#include <functional>
#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/fields/block.h"

namespace jnd {

// Tables of all blocks; as JSON a line for every row of the first. more: adds to the line what fields cannot say.
void print_rows(const std::vector<Block>& blocks, bool json,
                const std::function<void(nlohmann::ordered_json& line, std::size_t row)>& more = {});
// Tables of all blocks, below the heading where there is one; as JSON the object, with the rows of each block under its id.
void print_object(nlohmann::ordered_json object, const std::vector<Block>& blocks, bool json,
                  std::string_view heading = {});

// Adds "WORD: MEANING." below the table, for each word that the field has in some row.
void explain(Block& block, std::string_view key,
             std::initializer_list<std::pair<std::string_view, std::string_view>> meanings);

}  // namespace jnd
