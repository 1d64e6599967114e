// The plan of free interaction, for people and for machines.
#pragma once

#include <nlohmann/json.hpp>

#include "protocols/planning/plan.h"
#include "protocols/protocol.h"

namespace jnd {

// A table of conditions and objects in order.
void print_explorations(const Protocol& protocol, const Plan& plan);

// Rows of index, block, condition, devices, object and duration_s.
nlohmann::ordered_json explorations_json(const Protocol& protocol, const Plan& plan);

}  // namespace jnd
