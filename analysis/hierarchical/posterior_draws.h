// What each person may be, drawn given their answers and the estimates of the group.
//
// The integral over a row of equally spaced nodes does not depend on where the row begins (its error is that of the
// trapezoid rule, about 3e-9). So one of the nodes of a row that begins anywhere in a spacing, chosen by its share of the
// sum, is a draw from the density itself. First u and w of the person, by the nodes of HierarchicalLikelihood, then v
// of each condition, given these, by nodes along v.
//
// Draws share the beginnings of their rows of u and w in groups of kDrawsOfARow, which lie evenly over the spacing. Each
// draw is one of the posterior all the same.
//
// Source of the even places: Roberts 2018, "The unreasonable effectiveness of quasirandom sequences" (additive
// recurrence by the plastic number). Tests: moments and ranks against HierarchicalLikelihood::posteriors and the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"

namespace jnd {

inline constexpr std::size_t kDrawsOfARow = 25;

class PosteriorDraws {
 public:
  // cells: as of HierarchicalAnalysis; place: of the same model, whose answers are independent and do not drift; draws
  // >= 1. The same seed gives the same draws of a
  // participant on every machine. A spread of 0 has deviations of 0, and who has no answers is drawn from the group.
  PosteriorDraws(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                 const HierarchicalPlace& place, std::size_t draws, std::uint64_t seed);

  // Of a participant in a condition.
  double ln_s(std::size_t participant, std::size_t condition, std::size_t draw) const noexcept {
    return ln_s_[of(participant, condition, draw)];
  }
  double criterion(std::size_t participant, std::size_t condition, std::size_t draw) const noexcept {
    return criterion_[of(participant, condition, draw)];
  }

 private:
  std::size_t of(std::size_t participant, std::size_t condition, std::size_t draw) const noexcept {
    return (participant * conditions_ + condition) * draws_ + draw;
  }

  std::size_t draws_, conditions_;
  std::vector<double> ln_s_, criterion_;  // by participant, condition, draw
};

}  // namespace jnd
