// The blocks of what a task measures, each with its fields. A list refers to the protocol, which must outlive it.
#pragma once

#include "data/fields/field.h"
#include "data/task_results/task_results.h"
#include "protocols/protocol.h"

namespace jnd {

Fields<TaskCountRow> task_count_fields(const Protocol& protocol);
Fields<TaskEstimateRow> task_estimate_fields(const Protocol& protocol);
Fields<TaskGroupRow> task_group_fields(const Protocol& protocol, SessionKind kind);
Fields<ProportionRow> proportion_fields(const Protocol& protocol);

}  // namespace jnd
