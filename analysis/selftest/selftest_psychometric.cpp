// Reference fits of psychometric functions, recomputed.
#include <array>
#include <span>

#include "analysis/psychometric/psychometric.h"
#include "analysis/selftest/selftest.h"

namespace jnd {
namespace {

// R 4.2.2: maximum likelihood and posterior modes with errors from the observed information, cross-checked by a second
// implementation; 15 digits.
constexpr std::array<PsychometricLevel, 9> kComparison = {{{600, 20, 1},
                                                           {700, 20, 2},
                                                           {800, 20, 6},
                                                           {850, 20, 7},
                                                           {900, 20, 11},
                                                           {950, 20, 14},
                                                           {1000, 20, 15},
                                                           {1100, 20, 18},
                                                           {1200, 20, 20}}};
constexpr std::array<PsychometricLevel, 8> kForcedChoice = {{{15, 50, 27},
                                                             {30, 32, 15},
                                                             {60, 64, 40},
                                                             {90, 40, 28},
                                                             {120, 64, 52},
                                                             {180, 24, 21},
                                                             {260, 50, 47},
                                                             {400, 50, 47}}};

struct ReferenceFit {
  bool forced_choice;  // guess 0.5 and a free lapse; else both 0
  bool prior;          // Beta(2, 50) on the lapse
  PsychometricFunction function;
  double location, second, lapse;
  double se_location, se_second, se_lapse;
  double log_likelihood, deviance, pse, jnd;
};
constexpr std::array<ReferenceFit, 6> kFits = {{
    {false, false, PsychometricFunction::logistic, 886.557037435191, 0.0113433939859208, 0, 17.2412274684067,
     0.00170309961922725, 0, -80.258162138203, 1.78310861218262, 886.557037435191, 96.8504038589933},
    {false, false, PsychometricFunction::gaussian, 885.659870846223, 152.922531298339, 0, 17.3487526693139,
     20.3996186848241, 0, -80.1815263004447, 1.62983693666607, 885.659870846223, 103.144679934769},
    {true, false, PsychometricFunction::weibull, 112.482097666683, 1.87620550295309, 0.0601994519422996,
     16.6289780419847, 0.684099900041273, 0.0270375378456534, -186.545511906583, 1.06267068742136, 92.5219686751012,
     41.3504283576489},
    {true, false, PsychometricFunction::logistic, 94.3669269509605, 0.0323455967916223, 0.0635809931753537,
     12.2456068451889, 0.0124041524976828, 0.0257052711876333, -186.672116815951, 1.31588050615704, 94.3669269509605,
     33.9648173983501},
    {true, true, PsychometricFunction::weibull, 120.176251220772, 1.65960126089117, 0.041899993144922, 18.589233526475,
     0.586522685503144, 0.0213260647715132, -186.78912270392, 1.54989228209405, 96.362340030449, 49.9544883093653},
    {true, true, PsychometricFunction::logistic, 98.3313445963908, 0.0287623701081092, 0.046945077943709,
     12.6411250874944, 0.0109154176849112, 0.0193375868950114, -186.907580625963, 1.78680812618114, 98.3313445963908,
     38.1961668853698},
}};

}  // namespace

std::vector<SelftestQuantity> selftest_psychometric() {
  SelftestQuantity parameters, errors, deviance, thresholds;
  parameters.name = "psychometric parameters (relative)";
  parameters.tolerance = 1e-5;
  errors.name = "psychometric standard errors (relative)";
  errors.tolerance = 1e-5;
  deviance.name = "psychometric log-likelihood and deviance";
  deviance.tolerance = 1e-7;
  thresholds.name = "psychometric PSE and JND (relative)";
  thresholds.tolerance = 1e-5;
  for (const ReferenceFit& reference : kFits) {
    PsychometricModel model;
    model.function = reference.function;
    if (reference.forced_choice) {
      model.guess = 0.5;
      model.lapse.reset();
    }
    if (reference.prior) {
      model.estimator = PsychometricEstimator::map;
      model.prior = {2, 50};
    }
    const std::span<const PsychometricLevel> levels =
        reference.forced_choice ? std::span<const PsychometricLevel>(kForcedChoice) : kComparison;
    const PsychometricFit fit = fit_psychometric(levels, model);
    parameters.relative(fit.location.value, reference.location);
    parameters.relative(fit.second.value, reference.second);
    errors.relative(fit.location.se, reference.se_location);
    errors.relative(fit.second.se, reference.se_second);
    if (reference.forced_choice) {
      parameters.relative(fit.lapse.value, reference.lapse);
      errors.relative(fit.lapse.se, reference.se_lapse);
    }
    deviance.absolute(fit.log_likelihood, reference.log_likelihood);
    deviance.absolute(fit.deviance, reference.deviance);
    thresholds.relative(fit.pse.value, reference.pse);
    thresholds.relative(fit.jnd.value, reference.jnd);
  }
  return {parameters, errors, deviance, thresholds};
}

}  // namespace jnd
