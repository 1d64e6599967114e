// The probability of an answer at a level, as it depends on one person's spread and criterion in one condition.
#pragma once

#include <span>

#include "analysis/hierarchical/shared_parameters.h"
#include "analysis/numerics/words.h"

namespace jnd {

// Of the level x, the spread s = e^ln_s (the JND) and the criterion k, the probability of a positive answer.
//
// independent: the observer of independent observations knows of a block how far apart its stimuli are when they differ,
// and judges each interval by itself. Equal stimuli are said to differ the less, the further apart the others of the
// block are: x is the difference, and of equal stimuli minus that of the others of their block. g(d') = 2 z(p(c)),
// p(c) = Phi(d'/2)^2 + Phi(-d'/2)^2: the z difference of the unbiased observer, as in detection/independent_observation.h
// (unit slope). The likelihood-ratio observer itself has the same rates at k = 0; its rates have no second derivative
// there by any criterion, which a lattice needs. Beside k = 0 its ROC is not of unit slope, and s comes out too
// small (analysis/README.md).
enum class ResponseModel {
  yes_no,        // Phi(x/s - k): "different" of same-different, judged by the difference x (0: equal stimuli); "yes"
  differencing,  // Phi((x/s - t)/sqrt 2) + Phi((-x/s - t)/sqrt 2), t = e^k: "different" by the size of the difference
  independent,   // Phi(sign(x) g(|x|/s)/2 - k): "different" by both intervals, each judged by itself
  choice         // Phi((x - k)/s): "the comparison"; x and k less the standard, s, x and k in one unit
};
inline constexpr auto kResponseModelWords = words<ResponseModel>({{"yes_no", ResponseModel::yes_no},
                                                                  {"differencing", ResponseModel::differencing},
                                                                  {"independent", ResponseModel::independent},
                                                                  {"choice", ResponseModel::choice}});

struct LogRates {
  double positive, negative;  // of the answer and of the other one; finite
};
// lapse, 0 <= lapse < 1: on that share of trials the answer is a guess.
LogRates log_rates(ResponseModel model, double level, double ln_s, double criterion, double lapse);
// The same for slope = e^-ln_s, which many answers share.
LogRates log_rates_of_slope(ResponseModel model, double level, double slope, double criterion, double lapse);
// What an answer is judged by, before its criterion: a level, in units of its noise, or of intervals judged by themselves
// half the distance of their decisions. Not of differencing.
double judged_by(ResponseModel model, double level, double slope);
// The same for many slopes, without lapses: judged[i] is judged_by() slopes[i].
void log_rates_of_slopes(ResponseModel model, double level, std::span<const double> slopes,
                         std::span<const double> judged, double criterion, double* positive, double* negative);

// ln of the probability of what lies between two criteria, of which the first has more positive answers, from those of
// both answers at either.
void log_rates_between(std::span<const double> more_positive, std::span<const double> more_negative,
                       std::span<const double> fewer_positive, std::span<const double> fewer_negative, double* found);

// Answers to one question.
struct AnswerTally {
  double positive = 0, negative = 0;
  double sure_positive = 0, sure_negative = 0;  // of these; where no criterion tells sure ones they count as unsure

  double trials() const noexcept { return positive + negative; }
  AnswerTally& operator+=(const AnswerTally& other) noexcept;
};
struct GradedCounts {
  struct {
    double positive, negative;
  } unsure, sure;
};
GradedCounts graded_counts(const AnswerTally& counts, const SharedParameters& shared) noexcept;

// ln of the likelihood of the answers, without binomial coefficients.
double log_likelihood_of(const AnswerTally& counts, ResponseModel model, double level, double ln_s, double criterion,
                         const SharedParameters& shared);

// The probability of an answer, with lapses, and its derivatives by ln s and k; of one that is never given 0. Answers are
// sure or unsure. A positive one is sure beyond a criterion that lies sure_above over k, a negative one beyond one
// sure_below under it:
//   P(sure positive) = F(k + sure_above),  P(unsure positive) = F(k) - F(k + sure_above),  F falling with k,
// and so on the other side. An infinite distance: no such answer is sure. A guess is any of the answers there are, half
// of them positive.
struct AnswerChance {
  double chance = 0, by_s = 0, by_k = 0;
};
struct AnswerChances {
  AnswerChance unsure_positive, unsure_negative, sure_positive, sure_negative;
};
AnswerChances answer_chances(ResponseModel model, double level, double ln_s, double criterion,
                             const SharedParameters& shared);
// The derivatives of log_likelihood_of().
struct AnswerSlopes {
  double s = 0, k = 0;
};
AnswerSlopes slopes_of(const AnswerTally& counts, ResponseModel model, double level, double ln_s, double criterion,
                       const SharedParameters& shared);

struct LevelTrials {
  double level = 0, trials = 0;
};
// The expected (Fisher) information of such trials on (ln s, k).
struct CellInformation {
  double s = 0, k = 0, both = 0;
};
CellInformation expected_information(ResponseModel model, std::span<const LevelTrials> design, double ln_s,
                                     double criterion, const SharedParameters& shared);

}  // namespace jnd
