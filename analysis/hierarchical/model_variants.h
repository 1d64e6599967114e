// What if the answers are not quite as the hierarchical model assumes? The model once more, each time with one thing
// estimated besides, the same for everybody, and what that does to the group's JNDs.
//
// Sources: of shared_parameters.h. Tests: answers drawn with and without what a variant looks for.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/words.h"

namespace jnd {

enum class VariantKind {
  overdispersion,  // the answers of one person, condition and level are more alike than independent ones
  drift,           // JND and criterion change from the first half of the trials to the second
  lapse,           // some answers are guesses, or more of them than the model holds
  sureness         // which answers were sure counts too
};
inline constexpr auto kVariantKindWords = words<VariantKind>({{"overdispersion", VariantKind::overdispersion},
                                                              {"drift", VariantKind::drift},
                                                              {"lapse", VariantKind::lapse},
                                                              {"sureness", VariantKind::sureness}});

struct ModelVariant {
  VariantKind kind = VariantKind::overdispersion;
  std::vector<SharedEstimate> shared;  // of sureness its criteria, below and above, without a test
  // Empty where nothing shared has an estimate. With their intervals where every condition has a JND and what is shared an
  // upper bound, but not beside lapses, where the search for an end may be long (jnd calc hierarchical has them).
  std::vector<ConditionMean> conditions;
};

// What it is called in tables. choice: the criterion is the PSE.
std::string_view title_of(SharedParameter parameter, bool choice) noexcept;

// The answers as the model itself takes them: neither their half nor their sureness counts.
std::vector<HierarchicalCell> without_halves_and_sureness(std::span<const HierarchicalCell> cells);

// What variants may cost, in work of HierarchicalAnalysis; one that begins with less than of_each left is out_of_work.
struct VariantWork {
  double left = kInf, of_each = 0;
};

// cells: as of HierarchicalAnalysis, with halves, and sureness where it was asked. model: without anything that is
// estimated for everybody. Over-dispersion is left out where counts are not whole numbers, drift of the criterion where
// criteria do not differ between people (a PSE that is taken as known), and sureness where no answer was a sure one.
std::vector<ModelVariant> model_variants(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                                         VariantWork work = {});

// Whether there are more lapses than the model holds: the rate with its test, from near the model's maximum and roughly
// (SearchEffort::drawn), without an interval. Not identified also where the model estimates it.
SharedEstimate lapses_beside(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                             const HierarchicalPlace& near);

}  // namespace jnd
