// Self-test of thresholds: the estimates that a study's numbers rest on, against independent ones.
#include <array>

#include "analysis/numerics/special_values.h"
#include "analysis/selftest/selftest.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

namespace {

constexpr double kReference_n_per_m = 900;

// Slope and its 95 % profile bounds.
struct Likelihood {
  JndMethod method;
  double slope, low, high;
};

struct Case {
  std::array<SeriesCounts, 3> series;
  // JNDs in N/m of log-linear d'; NaN: undefined.
  double least_squares, weighted, inverse_mean_slope, mean_of_ratios;
  std::array<Likelihood, 4> likelihood;
};

// Counts -> JNDs, slopes and bounds: an independent numpy model with two optimisers, checked with glm of R 4.2.2, 15
// digits.
const std::vector<Case> kReference = {
    {{{{400, {6, 6, 6, 1}}, {300, {6, 5, 6, 1}}, {200, {6, 4, 6, 2}}}},
     190.266907183593,
     194.741608535778,
     205.749529493637,
     213.287165567313,
     {{
         {JndMethod::ml_yes_no_common, 0.00648446486716621, 0.00320487725903896, 0.0103826339309366},
         {JndMethod::ml_yes_no_series, 0.00661934956538834, 0.00329422617626832, 0.010670608563648},
         {JndMethod::ml_differencing_common, 0.0113570437622036, 0.00688247794972733, 0.0166890829959418},
         {JndMethod::ml_differencing_series, 0.0114947732042757, 0.00703091900931498, 0.0169673995616223},
     }}},
    {{{{400, {6, 4, 6, 2}}, {300, {6, 3, 6, 3}}, {200, {6, 2, 6, 4}}}},
     1980.29885723872,
     2011.08306145266,
     kNaN,
     kNaN,
     {{
         {JndMethod::ml_yes_no_common, 0.000540916181920633, -0.00200385602524271, 0.00311942052267915},
         {JndMethod::ml_yes_no_series, 0.000578255661245028, -0.002052706798289, 0.00324268512969917},
         {JndMethod::ml_differencing_common, 0.00295189442448258, 0, 0.00674562823211676},
         {JndMethod::ml_differencing_series, 0.00326789972668584, 0, 0.00706314845728434},
     }}},
    {{{{400, {6, 6, 6, 0}}, {300, {6, 6, 6, 0}}, {200, {6, 6, 6, 0}}}},
     109.955907320307,
     109.955907320307,
     94.4979150445078,
     102.372741298217,
     {{
         {JndMethod::ml_yes_no_common, kInf, 0.0134806474225816, kInf},
         {JndMethod::ml_yes_no_series, kInf, 0.0121847073689997, kInf},
         {JndMethod::ml_differencing_common, kInf, 0.021171936128277, kInf},
         {JndMethod::ml_differencing_series, kInf, 0.0193202111443502, kInf},
     }}},
    {{{{400, {7, 6, 5, 1}}, {300, {7, 5, 5, 2}}, {200, {7, 5, 5, 2}}}},
     297.662754199065,
     302.415735795326,
     308.299500098716,
     323.746548521697,
     {{
         {JndMethod::ml_yes_no_common, 0.00368744381714729, 0.000934961162346171, 0.00662961152528994},
         {JndMethod::ml_yes_no_series, 0.00395993771598093, 0.00111347300023148, 0.006972673796854},
         {JndMethod::ml_differencing_common, 0.0074154946435602, 0.0031910682325363, 0.0113204468482475},
         {JndMethod::ml_differencing_series, 0.00781877539392878, 0.00374498266408432, 0.0117573907865857},
     }}},
    {{{{400, {7, 7, 5, 0}}, {300, {4, 3, 8, 1}}, {200, {5, 3, 7, 1}}}},
     158.132295498879,
     165.894341441969,
     168.981699924278,
     173.479354484021,
     {{
         {JndMethod::ml_yes_no_common, 0.00782096491915433, 0.00433779256759158, 0.0121463668618201},
         {JndMethod::ml_yes_no_series, 0.00795913713885927, 0.00435386994003342, 0.0122435012725121},
         {JndMethod::ml_differencing_common, 0.0127486299326968, 0.00801631342803811, 0.0186983687052054},
         {JndMethod::ml_differencing_series, 0.0129706903883022, 0.00817243854932804, 0.018770757677815},
     }}},
    {{{{400, {8, 4, 4, 1}}, {300, {3, 1, 9, 5}}, {200, {4, 4, 8, 2}}}},
     643.484273652162,
     779.901964763995,
     326.618217762155,
     kNaN,
     {{
         {JndMethod::ml_yes_no_common, 0.000933045687514289, -0.00147756684708243, 0.00336231387814072},
         {JndMethod::ml_yes_no_series, 0.00184115445020381, -0.00108216269667735, 0.0048877281313597},
         {JndMethod::ml_differencing_common, 0.00238547091132577, 0, 0.00637836543788167},
         {JndMethod::ml_differencing_series, 0.00413326111667052, 0, 0.00856354924923616},
     }}},
};

}  // namespace

std::vector<SelftestQuantity> selftest_jnd() {
  SelftestQuantity closed{"JND, closed forms (relative)", 0, 0, 1e-10};
  SelftestQuantity slope{"JND, maximum-likelihood slope (relative)", 0, 0, 1e-6};
  SelftestQuantity bounds{"JND, profile bounds of the slope (relative)", 0, 0, 1e-5};
  for (const Case& one : kReference) {
    const auto jnd_by = [&](JndMethod method) {
      return estimate_jnd(one.series, kReference_n_per_m, method, Correction::loglinear);
    };
    closed.relative(jnd_by(JndMethod::least_squares).jnd, one.least_squares);
    closed.relative(jnd_by(JndMethod::weighted).jnd, one.weighted);
    closed.relative(jnd_by(JndMethod::inverse_mean_slope).jnd, one.inverse_mean_slope);
    closed.relative(jnd_by(JndMethod::mean_of_ratios).jnd, one.mean_of_ratios);
    for (const Likelihood& likelihood : one.likelihood) {
      const JndEstimate estimate = jnd_by(likelihood.method);
      slope.relative(estimate.slope, likelihood.slope);
      bounds.relative(estimate.slope_ci_low, likelihood.low);
      bounds.relative(estimate.slope_ci_high, likelihood.high);
    }
  }
  return {closed, slope, bounds};
}

}  // namespace jnd
