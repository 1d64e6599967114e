// The blocks of the hierarchical model, each with its fields. A list refers to the protocol, which must outlive it.
#pragma once

#include <vector>

#include "data/fields/field.h"
#include "data/results/study_hierarchical.h"
#include "protocols/protocol.h"

namespace jnd {

// A condition; what is of the whole model stands in every row.
struct HierarchicalConditionRow {
  const StudyHierarchical* of;
  const HierarchicalCondition* one;
};
std::vector<HierarchicalConditionRow> hierarchical_rows(const StudyHierarchical& model);
Fields<HierarchicalConditionRow> hierarchical_fields(const Protocol& protocol, SessionKind kind);

// A pair of conditions.
Fields<HierarchicalRatio> hierarchical_ratio_fields(const Protocol& protocol, SessionKind kind);

// A condition and level of the posterior predictive check; what is of the whole check stands in every row.
struct HierarchicalCheckRow {
  const PredictiveCheck* of;
  const PredictiveRow* one;
};
std::vector<HierarchicalCheckRow> hierarchical_check_rows(const StudyHierarchical& model);
Fields<HierarchicalCheckRow> hierarchical_check_fields(const Protocol& protocol, SessionKind kind);

// A variant's parameter and a condition; what is of the parameter, and of the condition, stands in every row of it.
struct HierarchicalVariantRow {
  const HierarchicalVariant* of;
  const SharedEstimate* shared;
  const HierarchicalCondition *with, *without;  // that parameter in the model

  // How many times as wide the interval of ln JND is. NaN: one of the two has an open end, or there is none.
  double width_ratio() const;
};
std::vector<HierarchicalVariantRow> hierarchical_variant_rows(const StudyHierarchical& model);
Fields<HierarchicalVariantRow> hierarchical_variant_fields(const Protocol& protocol, SessionKind kind);

// A participant and condition.
Fields<HierarchicalPerson> hierarchical_person_fields(const Protocol& protocol, SessionKind kind);

}  // namespace jnd
