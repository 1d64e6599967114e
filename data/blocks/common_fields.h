// Fields that many blocks have, with one name and one meaning in all of them.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/group/group.h"
#include "data/fields/block.h"
#include "protocols/planning/allotment.h"
#include "protocols/protocol.h"
#include "protocols/tasks/task.h"

namespace jnd {

inline constexpr std::string_view kSessionKinds = "real pilot simulated";

// A field with a name that is used in several blocks: its meaning is looked up. Throws std::logic_error for another name.
std::string_view common_meaning(std::string_view key);

template <typename Row, typename Get>
Field<Row> common(std::string_view key, Get get, const FieldTraits& traits = {}) {
  return {key, common_meaning(key), get, traits};
}
template <typename Row>
Field<Row> kind_field(SessionKind kind) {
  return common<Row>("kind", [kind](const Row&) { return kind; }, {.levels = kSessionKinds});
}
template <typename Row>
Field<Row> protocol_field(const Protocol& protocol) {
  return common<Row>("protocol_sha256", [sha = protocol.sha256](const Row&) { return sha; });
}
// place: of a row, -1 for all conditions together.
template <typename Row, typename Get>
Field<Row> condition_field(const Protocol& protocol, Get place, std::string_view key = "condition") {
  return common<Row>(key, [&protocol, place](const Row& row) { return condition_of(protocol, place(row)); });
}

// The names of the groups, for the dictionary: separated by blanks.
std::string group_levels(const Protocol& protocol);
// Adds the participant's group behind the participant, where the protocol has groups. group: of a row.
template <typename Row, typename Get>
void add_group_field(Fields<Row>& fields, const Protocol& protocol, Get group) {
  if (protocol.groups.empty()) return;
  const auto place =
      std::find_if(fields.begin(), fields.end(), [](const Field<Row>& field) { return field.key == "participant"; });
  fields.insert(
      place == fields.end() ? place : place + 1,
      common<Row>("group", [&protocol, group](const Row& r) { return std::string(group_name(protocol, group(r))); },
                  {.levels = group_levels(protocol)}));
}

// What the standard of a row is called and, where the task has one, its value; nothing where there is one for everything.
template <typename Row, typename Get>
void add_standard_fields(Fields<Row>& fields, const Protocol& protocol, Get place) {
  const auto standards = judged_standards(protocol);
  fields.push_back(common<Row>(
      "standard", [standards, place](const Row& r) { return standards[static_cast<std::size_t>(place(r))].name; }));
  const bool valued = has_valued_standards(protocol);
  fields.push_back(common<Row>("standard_value",
                               [standards, place, valued](const Row& r) {
                                 return valued ? std::optional(standards[static_cast<std::size_t>(place(r))].value)
                                               : std::nullopt;
                               },
                               {.unit = to_string(protocol.stimulus.unit), .shown = Shown::given}));
}

// n, mean, sd, ci_low, ci_high: of a row a MeanEstimate.
template <typename Row, typename Get>
void add_mean_fields(Fields<Row>& fields, Get mean, std::string_view key = "mean") {
  const auto part = [mean](auto member) { return [mean, member](const Row& r) { return mean(r).*member; }; };
  fields.push_back(common<Row>("n", part(&MeanEstimate::n)));
  fields.push_back(common<Row>(key, part(&MeanEstimate::mean)));
  fields.push_back(common<Row>("sd", part(&MeanEstimate::sd)));
  fields.push_back(common<Row>("ci_low", part(&MeanEstimate::ci_low)));
  fields.push_back(common<Row>("ci_high", part(&MeanEstimate::ci_high)));
}

// What was published of a condition, or of any where it is empty, at this standard, or else of all of them; null where
// nothing was. question: of a rating.
const PublishedValue* published_value(const Protocol& protocol, std::string_view condition, int standard,
                                      std::string_view quantity, std::string_view question = {});

// Slopes are read per 100 N/m, or per 10 N/rad, so that they have digits to read.
int slope_step(const Protocol& protocol) noexcept;
// "a, b", or the one that is not empty.
std::string joined(const std::string& a, const std::string& b);

}  // namespace jnd
