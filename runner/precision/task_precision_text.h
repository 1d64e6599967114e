// How well a task will measure (protocols/planning/task_precision.h), for people and for machines.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "protocols/planning/task_precision.h"
#include "runner/precision/precision_text.h"

namespace jnd {

// Lines ended by a newline.
std::string task_precision_text(const std::vector<TaskPrecisionRow>& rows, const TaskPrecisionQuestion& question,
                                const Protocol& protocol, TableStyle style);
nlohmann::ordered_json task_precision_json(const std::vector<TaskPrecisionRow>& rows,
                                           const TaskPrecisionQuestion& question, const Protocol& protocol);

}  // namespace jnd
