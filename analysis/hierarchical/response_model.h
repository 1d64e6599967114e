// The probability of an answer at a level, as it depends on one person's spread and criterion in one condition.
#pragma once

#include <span>

#include "analysis/numerics/words.h"

namespace jnd {

// Of the level x, the spread s = e^ln_s (the JND) and the criterion k, the probability of a positive answer.
enum class ResponseModel {
  yes_no,        // Phi(x/s - k): "different" of same-different, judged by the difference x (0: equal stimuli); "yes"
  differencing,  // Phi((x/s - t)/sqrt 2) + Phi((-x/s - t)/sqrt 2), t = e^k: "different" by the size of the difference
  choice         // Phi((x - k)/s): "the comparison"; x and k less the standard, s, x and k in one unit
};
inline constexpr auto kResponseModelWords = words<ResponseModel>({{"yes_no", ResponseModel::yes_no},
                                                                  {"differencing", ResponseModel::differencing},
                                                                  {"choice", ResponseModel::choice}});

struct LogRates {
  double positive, negative;  // of the answer and of the other one; finite
};
// lapse, 0 <= lapse < 1: on that share of trials the answer is a guess.
LogRates log_rates(ResponseModel model, double level, double ln_s, double criterion, double lapse);
// The same for slope = e^-ln_s, which many answers share.
LogRates log_rates_of_slope(ResponseModel model, double level, double slope, double criterion, double lapse);

struct LevelTrials {
  double level = 0, trials = 0;
};
// The expected (Fisher) information of such trials on (ln s, k).
struct CellInformation {
  double s = 0, k = 0, both = 0;
};
CellInformation expected_information(ResponseModel model, std::span<const LevelTrials> design, double ln_s,
                                     double criterion, double lapse);

}  // namespace jnd
