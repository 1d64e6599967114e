// Where one person lies, by their answers and the spreads of the group: the most likely deviations u and w (with v at 0),
// and how far about there the others reach. Nodes of an integral are put there.
#pragma once

#include <span>
#include <vector>

#include "analysis/hierarchical/response_model.h"

namespace jnd {

// The answers of the person in one condition, and what the group has there.
struct PersonCell {
  struct Counted {
    double level = 0;
    AnswerTally counts;
  };
  std::vector<Counted> answers;
  double mu = 0, kappa = 0, tv = 0;
};

struct GroupSpread {
  double tu = 0, tw = 0, rho = 0;
};

struct PersonMode {
  double u = 0, w = 0;
  // What the answers alone tell of u and of w, the other unknown, and v between them and ln s.
  double information_u = 0, information_w = 0;
  double correlation = 0;  // of u and w in the posterior
};
// Without answers the mode of the prior: 0. Of a spread of 0 the deviation is 0.
PersonMode person_mode(std::span<const PersonCell> cells, ResponseModel model, const SharedParameters& shared,
                       const GroupSpread& spread);

}  // namespace jnd
