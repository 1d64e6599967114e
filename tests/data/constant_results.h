// What was measured in a study over given levels.
#pragma once

#include "data/results/study_results.h"

namespace jnd {

inline ConstantResults& constant(StudyResults& results) {
  return std::get<ConstantResults>(results.measured);
}
inline const ConstantResults& constant(const StudyResults& results) {
  return std::get<ConstantResults>(results.measured);
}

}  // namespace jnd
