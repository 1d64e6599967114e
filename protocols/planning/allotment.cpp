#include "protocols/planning/allotment.h"

#include <algorithm>
#include <numeric>

#include "protocols/random_stream.h"

namespace jnd {

int group_count(const Protocol& protocol) noexcept {
  return std::max(1, static_cast<int>(protocol.groups.size()));
}

// The name of the stream is part of every plan: it never changes.
std::optional<int> group_of(const Protocol& protocol, int participant, std::uint64_t seed) {
  if (protocol.groups.empty()) return std::nullopt;
  const int groups = group_count(protocol);
  const int block = (participant - 1) / groups, place = (participant - 1) % groups;
  if (protocol.allotment == Allotment::given) return place;
  std::vector<int> turns(protocol.groups.size());
  std::iota(turns.begin(), turns.end(), 0);
  RandomStream(seed, 0, "groups", static_cast<std::uint64_t>(block)).shuffle(turns);
  return turns[static_cast<std::size_t>(place)];
}

int number_of_member(const Protocol& protocol, int group, int member) noexcept {
  return (member - 1) * group_count(protocol) + group + 1;
}

int first_of(const Protocol& protocol, std::optional<int> group, std::uint64_t seed) {
  int number = 1;
  while (group && group_of(protocol, number, seed) != group) ++number;
  return number;
}

std::optional<int> group_named(const Protocol& protocol, std::string_view name) noexcept {
  for (std::size_t i = 0; i < protocol.groups.size(); ++i)
    if (protocol.groups[i].name == name) return static_cast<int>(i);
  return std::nullopt;
}

std::string_view group_name(const Protocol& protocol, std::optional<int> group) noexcept {
  if (!group || *group < 0 || static_cast<std::size_t>(*group) >= protocol.groups.size()) return {};
  return protocol.groups[static_cast<std::size_t>(*group)].name;
}

std::vector<std::string> group_names(const Protocol& protocol) {
  std::vector<std::string> names;
  for (const Group& group : protocol.groups) names.push_back(group.name);
  return names;
}

std::vector<int> conditions_of(const Protocol& protocol, std::optional<int> group) {
  if (group) return protocol.groups[static_cast<std::size_t>(*group)].conditions;
  std::vector<int> all(protocol.conditions.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

bool operator_says_group(const Protocol& protocol) noexcept {
  return !protocol.groups.empty() && protocol.allotment == Allotment::given;
}

bool has_condition(const Protocol& protocol, std::optional<int> group, int condition) noexcept {
  if (!group) return true;
  const std::vector<int>& own = protocol.groups[static_cast<std::size_t>(*group)].conditions;
  return std::find(own.begin(), own.end(), condition) != own.end();
}

bool anyone_has_both(const Protocol& protocol, int a, int b) noexcept {
  if (protocol.groups.empty()) return true;
  for (int group = 0; group < group_count(protocol); ++group)
    if (has_condition(protocol, group, a) && has_condition(protocol, group, b)) return true;
  return false;
}

bool everyone_has_all(const Protocol& protocol) noexcept {
  return std::all_of(protocol.groups.begin(), protocol.groups.end(),
                     [&](const Group& group) { return group.conditions.size() == protocol.conditions.size(); });
}

std::optional<int> largest_plan(const Protocol& protocol) noexcept {
  std::optional<int> largest;
  for (std::size_t i = 0; i < protocol.groups.size(); ++i)
    if (!largest ||
        protocol.groups[i].conditions.size() > protocol.groups[static_cast<std::size_t>(*largest)].conditions.size())
      largest = static_cast<int>(i);
  return largest;
}

}  // namespace jnd
