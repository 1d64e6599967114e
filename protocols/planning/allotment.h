// Which group a participant belongs to, and which conditions that brings.
//
// The numbers of participants come in blocks of G, one for each of the G groups. `balanced`: each block is a random
// permutation of the groups, drawn for the study, so that after every block the groups are of one size and the next
// newcomer's group cannot be told. `given`: a block has the groups in the order of the file, so that whoever says the
// group chooses among the numbers that are free in it. Either way participant n is member floor((n - 1) / G) + 1 of its
// group, and orders are assigned by that, so that they are balanced within each group.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

// 1 where everyone gets every condition.
int group_count(const Protocol& protocol) noexcept;

// Place in Protocol::groups; none where there are none. participant: from 1.
std::optional<int> group_of(const Protocol& protocol, int participant, std::uint64_t seed);
// The number of a member where groups are given.
int number_of_member(const Protocol& protocol, int group, int member) noexcept;

// The smallest number that belongs to a group; 1 where there is none.
int first_of(const Protocol& protocol, std::optional<int> group, std::uint64_t seed);

std::optional<int> group_named(const Protocol& protocol, std::string_view name) noexcept;
// Its name; empty where there is none.
std::string_view group_name(const Protocol& protocol, std::optional<int> group) noexcept;
std::vector<std::string> group_names(const Protocol& protocol);
// Places in Protocol::conditions, ascending; all of them where there is no group.
std::vector<int> conditions_of(const Protocol& protocol, std::optional<int> group);

// Whether the operator says who belongs to which group: then the next number depends on what is said.
bool operator_says_group(const Protocol& protocol) noexcept;
bool has_condition(const Protocol& protocol, std::optional<int> group, int condition) noexcept;
// Does anyone get both conditions?
bool anyone_has_both(const Protocol& protocol, int a, int b) noexcept;
// Does every participant get every condition?
bool everyone_has_all(const Protocol& protocol) noexcept;
// The group with the most conditions, the first of several; none where there are no groups.
std::optional<int> largest_plan(const Protocol& protocol) noexcept;

}  // namespace jnd
