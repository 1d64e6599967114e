// The search for the largest likelihood of a psychometric function: on the edges of its family, and within it from the
// peaks of a survey.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <vector>

#include "analysis/psychometric/psychometric_likelihood.h"

namespace jnd {

// The two edges of a psychometric family, where no function of it lies but its likelihood may be largest: slope 0 (one
// rate at every level) and slope infinite (a step). Both suprema have closed forms.
struct PsychometricEdge {
  double value = 0;           // the supremum, with the prior of map
  double log_likelihood = 0;  // the same without the prior
  double lapse = 0, guess = 0;
  double level = 0;  // of a step: the x of the one level that lies on it; NaN where it lies between two levels
  // A function of the family so near to the edge that nothing is left to gain, for searches that start there.
  double c0 = 0, c1 = 0;
  double t = 0;  // of a step: its place on the t axis
};

PsychometricEdge flat_edge(const PsychometricLikelihood& likelihood) noexcept;

// At least two levels. Value -inf, and nothing else of use, where known rates make every step impossible.
PsychometricEdge step_edge(const PsychometricLikelihood& likelihood) noexcept;

// A survey of all functions of a family over the data, so that a search for the largest likelihood begins beside every
// maximum worth the name.
//
// For given values of F the probability of an answer is linear in guess and lapse, and the logarithm of the likelihood
// (and of the prior) therefore concave in them: Newton steps find the best rates of one function from anywhere in their
// box, its edges included. What may have several maxima is a function of location and steepness alone. That plane is
// laid out in rows of one steepness, each half as steep again as the one before, from nearly flat to a step between
// neighbouring levels; along a row the location moves by a quarter of the distance between the quartiles of F.
// Stretches of a row are left out where even the observed rates of all levels on the rise, and the best step beside
// them, would be worse than what is known already: no steeper function there can be better, so that later rows leave
// them out too.
//
// Levels beyond the rise of F (nearer than 1e-6 to 0 or 1) count together. More than kExactLevels levels are merged
// where they lie within a tenth of that rise of each other; then the survey is approximate, and a search goes on from
// it on the levels themselves. The steepest rows then rise over about a ten-thousandth of the levels where these are
// densest: steeper functions differ little from steps, and noise gives them very many peaks.
inline constexpr std::size_t kExactLevels = 400;

class PsychometricSurvey {
 public:
  // box: that of the likelihood, or narrower in lapse and guess. At least two levels, which must outlive the survey.
  PsychometricSurvey(const PsychometricLikelihood& likelihood, const NewtonBox& box);

  // One function with its best rates (to about 1e-3 of their range).
  struct Point {
    double c0 = 0, c1 = 0, lapse = 0, guess = 0, value = 0;
    std::vector<double> place() const { return {c0, c1, lapse, guess}; }
  };
  Point at(double c0, double c1);

  // Local maxima, the best first, at most `most`: of the whole plane, of one row, and along a curve c0 = h(c1). known:
  // a likelihood that is reached anyway; what cannot be better is left out.
  std::vector<Point> peaks(std::size_t most, double known);
  std::vector<Point> peaks_at(double c1, std::size_t most, double known);
  std::vector<Point> peaks_along(const std::function<double(double)>& h, std::size_t most);

  double middle() const noexcept { return middle_; }  // u at F = 0.5

  // From now on this rate is known.
  void hold(PsychometricLikelihood::Place rate, double value);
  // The likelihood of levels merged as for this c1; of the levels themselves where these are few.
  const PsychometricLikelihood& merged(double c1) { return cells_for(c1).likelihood; }

 private:
  struct Cells {
    PsychometricLikelihood likelihood;                    // of the cells as levels
    std::vector<double> n_before, k_before, best_before;  // of the cells before; the last entry: of all
    const std::vector<double>& t() const noexcept { return likelihood.data().t; }
  };
  struct Stretch {
    double from, to;
  };
  struct Weighed {
    double n, k, g, upper;
  };
  const Cells& cells_for(double c1);
  Cells cells_of_width(double width) const;
  double bound(const Cells& cells, double t, double c1, double slack) const;
  std::vector<Point> row(double c1, std::vector<Stretch>& stretches, double& best);
  Stretch whole_row(double c1) const noexcept;
  double best_rates(double& lapse, double& guess) const;

  const PsychometricLikelihood& likelihood_;
  const PsychometricData& data_;
  NewtonBox box_;
  double low_ = 0, middle_ = 0, high_ = 0, rise_ = 0;  // u at F = 1e-6, 0.5, 1 - 1e-6; and between the quartiles
  double nearest_ = 0;  // least distance of two levels on the t axis; of many levels, of some in a row
  std::vector<double> n_before_, k_before_, t_before_, best_before_;  // of the levels; t weighted by n
  std::map<int, Cells> cells_;                                        // by power of two of their width
  std::vector<Weighed> weighed_;                                      // of the function looked at
  double lapse_ = 0, guess_ = 0;                                      // where its search for rates ended
};

// The largest value within the family. known: one that its edges reach; where nothing can be better the place is empty
// and the value -inf.
NewtonResult psychometric_maximum(const PsychometricLikelihood& likelihood, double known);

}  // namespace jnd
