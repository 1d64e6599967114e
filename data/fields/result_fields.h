// The blocks of a study's results, each with its fields: thresholds and tests of studies with trials. A list refers to
// the protocol, which must outlive it.
#pragma once

#include <string>

#include "data/fields/field.h"
#include "data/results/adaptive_results.h"
#include "data/results/study_analysis.h"
#include "data/results/study_comparisons.h"
#include "data/results/study_contrasts.h"
#include "data/results/study_models.h"
#include "data/results/study_sensitivity.h"
#include "protocols/protocol.h"

namespace jnd {

// Digits that a stiffness deserves in the study's unit: those of a contact are hundreds of N/m, those of a joint tens
// of N/rad.
int stiffness_decimals(const Protocol& protocol) noexcept;
// Of slopes, so that they have digits to read: d' per 100 N/m, d' per 10 N/rad.
int slope_step(const Protocol& protocol) noexcept;
// "jnd_n_per_m": of fields that carry the study's unit in their name.
std::string in_unit(const std::string& name, const Protocol& protocol);

// How many tracks a threshold rests on. get: of a row a TrackCount.
template <typename Row, typename Get>
void add_track_fields(Fields<Row>& fields, Get get) {
  fields.push_back({"tracks_used", "tracks that the threshold of the condition rests on",
                    [get](const Row& row) { return get(row).used; }});
  fields.push_back({"tracks_unfinished",
                    "tracks with fewer reversals than are averaged; methods.md says what becomes of them",
                    [get](const Row& row) { return get(row).unfinished; }});
}

Fields<CellResult> cell_fields(const Protocol& protocol);
Fields<ThresholdResult> threshold_fields(const Protocol& protocol);
Fields<GroupResult> group_fields(const Protocol& protocol, SessionKind kind);
Fields<ContrastRow> contrast_fields(const Protocol& protocol, SessionKind kind);

// All conditions together; and condition x series, which has no file.
struct TestRow {
  const OutcomeComparison* outcome;
};
Fields<TestRow> test_fields();
struct EffectRow {
  const char* name;
  const TwoWayEffect* effect;
  const SeriesComparison* of;
};
Fields<EffectRow> effect_fields();

struct PairRow {
  const OutcomeComparison* outcome;
  const PairComparison* pair;
};
Fields<PairRow> pair_fields(const Protocol& protocol);

// One row a method and condition.
struct MethodRow {
  const SensitivityRow* row;
  std::size_t condition;
};
Fields<MethodRow> sensitivity_fields(const Protocol& protocol);

Fields<ThresholdModel> model_fields(const Protocol& protocol);

// Where the answers set the levels.
Fields<AdaptiveRow> track_fields(const Protocol& protocol);
Fields<AdaptiveGroup> adaptive_group_fields(const Protocol& protocol);

}  // namespace jnd
