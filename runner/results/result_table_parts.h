// The makers of the tables that result_tables() puts in order; each returns a table that may have no rows.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "runner/results/result_tables.h"

namespace jnd {

// result_tables.cpp
ResultTable cells_table(const StudyAnalysis& analysis, const Protocol& protocol);
ResultTable participants_table(const StudyAnalysis& analysis, const Protocol& protocol);
ResultTable group_table(const StudyAnalysis& analysis, const Protocol& protocol);
enum class ContrastScales { all, registered };
ResultTable contrasts_table(const StudyResults& results, const Protocol& protocol,
                            ContrastScales scales = ContrastScales::all);
// result_tables_tests.cpp
ResultTable omnibus_table(const StudyResults& results, const Protocol& protocol);
ResultTable pairs_table(const StudyResults& results, const Protocol& protocol);
ResultTable series_table(const ConstantResults& results, const Protocol& protocol);
ResultTable sensitivity_table(const ConstantResults& results, const Protocol& protocol);
// result_tables_adaptive.cpp: in the place of participants and group where the answers set the levels. tracks: with a
// line for each track.
ResultTable adaptive_group_table(const AdaptiveResults& results, const Protocol& protocol);
ResultTable adaptive_rows_table(const AdaptiveResults& results, const Protocol& protocol, bool tracks);
// result_tables_answers.cpp
ResultTable behaviour_table(const ConstantResults& results, const Protocol& protocol);
ResultTable sureness_table(const ConstantResults& results, const Protocol& protocol);
ResultTable cues_table(const ConstantResults& results, const Protocol& protocol);
ResultTable ratings_table(const StudyResults& results, const Protocol& protocol);
ResultTable items_table(const StudyResults& results, const Protocol& protocol);

// task_tables.cpp: what a task measures.
ResultTable task_estimates_table(const TaskResults& results, const Protocol& protocol);
ResultTable task_group_table(const StudyResults& results, const TaskResults& measured, const Protocol& protocol);
ResultTable proportion_table(const TaskResults& results, const Protocol& protocol);
ResultTable task_counts_table(const TaskResults& results, const Protocol& protocol);

// hierarchical_tables.cpp: the hierarchical model, where it was added to the results.
ResultTable hierarchical_table(const StudyResults& results, const Protocol& protocol);
ResultTable hierarchical_ratios_table(const StudyResults& results, const Protocol& protocol);
ResultTable hierarchical_check_table(const StudyResults& results, const Protocol& protocol);
ResultTable hierarchical_variants_table(const StudyResults& results, const Protocol& protocol);
ResultTable hierarchical_variant_jnds_table(const StudyResults& results, const Protocol& protocol);
ResultTable hierarchical_people_table(const StudyResults& results, const Protocol& protocol);
nlohmann::ordered_json hierarchical_json(const StudyHierarchical& model, const Protocol& protocol, SessionKind kind);

// between_tables.cpp: groups of participants. The JSON is of results that have groups.
ResultTable groups_table(const StudyResults& results, const Protocol& protocol);
ResultTable between_table(const StudyResults& results, const Protocol& protocol);
nlohmann::ordered_json groups_json(const StudyResults& results, const Protocol& protocol);

}  // namespace jnd
