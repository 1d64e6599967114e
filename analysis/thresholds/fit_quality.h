// Does the model of a maximum-likelihood JND fit its counts? Deviance and Pearson's chi-square over the cells.
//
// A cell is one class of one series: hits of n_diff, false alarms of n_same, two cells a series. The saturated model
// gives each cell its own rate. Sources: McCullagh and Nelder 1989, Generalized Linear Models, section 4.4; Wichmann
// and Hill 2001 (Percept Psychophys 63:1293), who show why p comes from a bootstrap where cells hold few trials.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "analysis/thresholds/jnd.h"

namespace jnd {

enum class FitStatus {
  ok,
  no_degrees_of_freedom,  // as many parameters as cells: every fit is perfect, no p value
  few_trials,             // too few per cell for the p of chi-square (CountsPerLevel); that of the bootstrap holds
  no_information          // no usable series, or nothing to fit a slope to (every answer alike)
};
std::string_view to_string(FitStatus status) noexcept;

struct FitQuality {
  FitStatus status = FitStatus::no_information;
  int cells = 0;               // 2 for each usable series
  int parameters = 0;          // the slope and one criterion, or one for each series
  int degrees_of_freedom = 0;  // cells - parameters, counted as if no estimate lay on a boundary
  // 2 (log-likelihood of the saturated model - that of the fit), and sum (k - n p)^2 / (n p (1 - p)). NaN under
  // no_information.
  double deviance = 0, pearson = 0;
  // Upper tail of chi-square. NaN unless ok.
  double deviance_p = 0, pearson_p = 0;
  // Share of replicates drawn from the fit and fitted again that are at least as bad, (1 + worse) / (1 + replicates).
  // NaN unless ok or few_trials, and for replicates = 0.
  double deviance_p_bootstrap = 0, pearson_p_bootstrap = 0;
  int replicates = 0;  // that were drawn; those of one answer throughout count as perfect fits
};

// method: a maximum-likelihood one; throws std::invalid_argument otherwise. replicates >= 0; the same seed gives the
// same replicates on every machine. Missing series are left out, as in the fit.
FitQuality fit_quality(std::span<const SeriesCounts> series, JndMethod method, int replicates, std::uint64_t seed);

}  // namespace jnd
