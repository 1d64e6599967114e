#include "runner/commands/plan_explorations.h"

#include <fmt/format.h>

#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

const Condition& condition_of(const Protocol& protocol, const ExplorationSlot& slot) {
  return protocol.conditions[static_cast<std::size_t>(slot.condition)];
}

const std::string& object_of(const Protocol& protocol, const ExplorationSlot& slot) {
  return protocol.explore->objects[static_cast<std::size_t>(slot.object)];
}

}  // namespace

void print_explorations(const Protocol& protocol, const Plan& plan) {
  using Align = TextTable::Align;
  TextTable table({"part", "block", "condition", "object", "s", ""},
                  {Align::right, Align::right, Align::left, Align::left, Align::right, Align::left});
  int block = 1;
  for (const ExplorationSlot& slot : plan.explorations) {
    if (slot.block != block) table.rule();
    block = slot.block;
    table.add({std::to_string(slot.index), std::to_string(slot.block), condition_of(protocol, slot).name,
               object_of(protocol, slot), fmt::format("{:g}", slot.duration_s),
               condition_of(protocol, slot).devices ? "with devices" : "without devices"});
  }
  fmt::print("{}", table.text());
}

nlohmann::ordered_json explorations_json(const Protocol& protocol, const Plan& plan) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const ExplorationSlot& slot : plan.explorations)
    rows.push_back({{"index", slot.index},
                    {"block", slot.block},
                    {"condition", condition_of(protocol, slot).name},
                    {"devices", condition_of(protocol, slot).devices},
                    {"object", object_of(protocol, slot)},
                    {"duration_s", slot.duration_s}});
  return rows;
}

}  // namespace jnd
