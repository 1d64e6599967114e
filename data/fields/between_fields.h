// The blocks of groups of participants, each with its fields. A list refers to the protocol, which must outlive it.
#pragma once

#include <string>
#include <vector>

#include "data/fields/field.h"
#include "data/results/study_comparisons.h"
#include "protocols/planning/allotment.h"
#include "protocols/protocol.h"

namespace jnd {

// The names of the groups, for the dictionary: separated by blanks.
std::string group_levels(const Protocol& protocol);

// Adds the participant's group behind the participant, where the protocol has groups.
template <typename Row>
void add_group_field(Fields<Row>& fields, const Protocol& protocol) {
  if (protocol.groups.empty()) return;
  const auto place =
      std::find_if(fields.begin(), fields.end(), [](const Field<Row>& field) { return field.key == "participant"; });
  fields.insert(place == fields.end() ? place : place + 1,
                Field<Row>("group", "group of the participant",
                           [&protocol](const Row& r) { return std::string(group_name(protocol, r.group)); },
                           {.levels = group_levels(protocol)}));
}

// Groups under their conditions, on the scale of the registered outcome.
struct GroupMeanRow {
  const GroupsCompared* of;
  const GroupMean* mean;
};
std::vector<GroupMeanRow> group_mean_rows(const GroupsCompared& groups);
Fields<GroupMeanRow> group_mean_fields(const Protocol& protocol, SessionKind kind);

// What the registered test says: of mixed_anova an effect a row, else a pair of groups.
struct BetweenRow {
  const GroupsCompared* of;
  std::string effect;         // "group", "condition", "group x condition"
  const MixedEffect* tested;  // null of a pair
  const GroupPair* pair;      // null of an effect
};
std::vector<BetweenRow> between_rows(const GroupsCompared& groups);
Fields<BetweenRow> between_fields(const Protocol& protocol, SessionKind kind);

}  // namespace jnd
