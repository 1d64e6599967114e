// Studies of the published design for the tests of the hierarchical model.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "analysis/hierarchical/hierarchical_bootstrap.h"

namespace jnd::testing {

inline HierarchicalPlace published_truth() {
  HierarchicalPlace truth;
  truth.mu = {std::log(208.5), std::log(283.5), std::log(351.0)};
  truth.kappa = {0.75, 0.75, 0.75};
  truth.tu = 0.3;
  truth.tv = 0.15;
  truth.tw = 0.3;
  return truth;
}

// 36 trials a cell: 18 with equal stimuli, six with each of three differences; nobody has answered yet.
inline std::vector<HierarchicalCell> published_questions(int participants, int conditions = 3) {
  std::vector<HierarchicalCell> cells;
  for (int p = 0; p < participants; ++p)
    for (int c = 0; c < conditions; ++c)
      for (const double level : {0.0, 200.0, 300.0, 400.0}) cells.push_back({p, c, level, 0, level == 0 ? 18.0 : 6.0});
  return cells;
}

inline std::vector<HierarchicalCell> published_study(int participants, std::uint64_t study) {
  return drawn_answers(published_questions(participants), HierarchicalModel{}, published_truth(), 1, study);
}

// From a place, with the shared parameters of the likelihood.
inline HierarchicalMaximum maximise(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                                    const HierarchicalPlace& start, double criterion_unit = 1,
                                    double negligible = kNegligible) {
  HierarchicalMaximum from;
  from.place = start;
  from.shared = likelihood.shared();
  return jnd::maximise(likelihood, form, from, criterion_unit, negligible);
}

}  // namespace jnd::testing
