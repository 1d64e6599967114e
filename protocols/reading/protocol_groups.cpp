// Reads groups of participants: the member "groups", and what the rest of the file says about them.
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "protocols/planning/allotment.h"
#include "protocols/reading/protocol_reading.h"
#include "protocols/reading/translation.h"

namespace jnd {
namespace {

void read_conditions_of_group(const JsonNode& list, Group& group, ProtocolReading& reading) {
  for (const JsonNode& item : list.items) {
    const auto place = condition_place(item, reading);
    if (!place) continue;
    if (std::find(group.conditions.begin(), group.conditions.end(), *place) != group.conditions.end())
      reading.error(item, in_quotes(item.text) + " is named twice", "remove one");
    else
      group.conditions.push_back(*place);
  }
  std::sort(group.conditions.begin(), group.conditions.end());
}

// The groups get the same conditions, of which there are at least two: groups and conditions can be crossed.
bool groups_cross_conditions(const Protocol& protocol) {
  const std::vector<int>& first = protocol.groups.front().conditions;
  return first.size() >= 2 && std::all_of(protocol.groups.begin(), protocol.groups.end(),
                                          [&](const Group& group) { return group.conditions == first; });
}

void lint_conditions_of_groups(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i) {
    if (!anyone_has_both(protocol, static_cast<int>(i), static_cast<int>(i)))
      reading.error_at(fmt::format("$.conditions[{}]", i),
                       fmt::format("no group gets condition {}", in_quotes(protocol.conditions[i].name)),
                       "name it in a group's \"conditions\", or remove it");
  }
}

void lint_practice_of_groups(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  if (!protocol.practice || !reading.sound("$.practice")) return;
  const std::vector<int>& practised = protocol.practice->conditions;
  for (const Group& group : protocol.groups) {
    const bool shared = std::any_of(practised.begin(), practised.end(), [&](int one) {
      return std::find(group.conditions.begin(), group.conditions.end(), one) != group.conditions.end();
    });
    if (!shared)
      reading.error_at(
          "$.practice.conditions",
          fmt::format("the group {} gets none of the conditions that are practised", in_quotes(group.name)),
          "practise at least one condition of each group");
  }
}

void lint_analysis_of_groups(ProtocolReading& reading) {
  const AnalysisPlan& analysis = reading.protocol.analysis;
  if (reading.sound("$.analysis.contrasts"))
    for (std::size_t i = 0; i < analysis.contrasts.size(); ++i)
      if (!anyone_has_both(reading.protocol, analysis.contrasts[i].a, analysis.contrasts[i].b))
        reading.error_at(fmt::format("$.analysis.contrasts[{}]", i),
                         "no group gets both conditions, so nobody has this difference",
                         "remove it: \"tests\": {\"between\"} compares groups");
  if (analysis.tests.between == BetweenTest::mixed_anova && !groups_cross_conditions(reading.protocol))
    reading.error_at("$.analysis.tests.between", "the groups do not all get the same two or more conditions",
                     "write \"welch\" or \"mann-whitney\": they compare participants' means");
}

}  // namespace

void read_groups(const JsonNode& list, ProtocolReading& reading) {
  if (reading.explores())
    reading.error(list, "there are no groups with the paradigm \"explore\"",
                  "remove them, and write a protocol for each group");
  for (const JsonNode& item : list.items) {
    Group group;
    JsonReader reader(item, reading.errors, reading.file);
    group.name = read_name(reader, "name", reading).value_or("");
    group.label = reader.text("label", kLabelLimits);
    if (const JsonNode* conditions = reader.array_or_null("conditions", 1, 20))
      read_conditions_of_group(*conditions, group, reading);
    else
      group.conditions = conditions_of(reading.protocol, std::nullopt);
    reader.finish();
    reading.protocol.groups.push_back(std::move(group));
  }
  // What is registered where the analysis says nothing.
  reading.protocol.analysis.tests.between =
      groups_cross_conditions(reading.protocol) ? BetweenTest::mixed_anova : BetweenTest::welch;
}

void read_allotment(JsonReader& design, ProtocolReading& reading) {
  reading.protocol.allotment = design.one_of_or<Allotment>(
      "allotment", {{"balanced", Allotment::balanced}, {"given", Allotment::given}}, Allotment::balanced);
  if (reading.root.find("groups") == nullptr && design.member("allotment") != nullptr)
    design.error("allotment", "there are no groups", "remove it, or name $.groups");
}

void read_between_test(JsonReader& tests, ProtocolReading& reading) {
  BetweenTest& between = reading.protocol.analysis.tests.between;
  between = tests.one_of_or<BetweenTest>("between",
                                         {{"none", BetweenTest::none},
                                          {"welch", BetweenTest::welch},
                                          {"mann-whitney", BetweenTest::mann_whitney},
                                          {"mixed-anova", BetweenTest::mixed_anova}},
                                         between);
  if (reading.root.find("groups") == nullptr && between != BetweenTest::none)
    tests.error("between", "there are no groups to compare", "remove it, or name $.groups");
}

void lint_groups(ProtocolReading& reading) {
  if (reading.protocol.groups.empty() || reading.explores()) return;
  if (!reading.sound("$.groups") || !reading.sound("$.conditions")) return;
  lint_conditions_of_groups(reading);
  lint_practice_of_groups(reading);
  lint_analysis_of_groups(reading);
}

}  // namespace jnd
