// The grid and the prior that the Bayesian procedure has where a study gives none.
#pragma once

#include "analysis/procedures/posterior.h"

namespace jnd {

// For a standard of 900 N/m they are, with differences in N/m,
//   same-different  ln s: 31 values, 60 to 1200; k: 17 values, -0.5 to 2.5; lapse 0, 0.025, 0.05. Prior: ln s about ln 275,
//                   SD 0.7; k about 0.75, SD 0.75; lapses as 5 : 3 : 2
//   which           ln s: 30 values, 40 to 800; a: 13 values, -120 to 120; lapse 0, 0.02, 0.06. Prior: ln s about ln 180,
//                   SD 0.8; a about 0, SD 60; lapses as 10 : 7 : 3
// and what has a unit grows in proportion to the standard (Weber's law). standard: above 0. Without levels and utility; of
// which with the standard.
PosteriorConfiguration default_posterior(PosteriorTask task, double standard);

}  // namespace jnd
