// How often a study without a difference between conditions shows one as large: the likelihood-ratio test of one JND
// for all conditions against studies drawn from the fit that has one.
//
// Each replicate draws every person anew (u, v, w, then the answers, with the numbers of trials of the study) from the
// model with one mu, and is fitted with one mu and with one of each condition. p = (1 + as large)/(1 + replicates).
//
// Source: Davison and Hinkley 1997, Bootstrap Methods and their Application, section 4.4.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"

namespace jnd {

// Answers to the same questions as these, drawn from the model; with the answers' own counts of trials, which are whole.
// The same seed and replicate give the same answers on every machine.
std::vector<HierarchicalCell> drawn_answers(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                                            const HierarchicalPlace& truth, std::uint64_t seed,
                                            std::uint64_t replicate);

struct EqualityBootstrap {
  int replicates = 0, as_large = 0;
  double p = kNaN;
};
// Of a fit that has a test (fit.df > 0). threads >= 1; the result does not depend on them. progress: called from
// time to time, by one thread at a time, with the number of replicates done. Throws Stopped (numerics/stop_request.h).
EqualityBootstrap equality_bootstrap(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                                     const HierarchicalFit& fit, int replicates, std::uint64_t seed, int threads,
                                     const std::function<void(int)>& progress = {});

}  // namespace jnd
