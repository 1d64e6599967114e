#include "analysis/hierarchical/person_mode.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/numerics/box_newton.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr double kFurthestDeviation = 8;  // standard deviations of the group
constexpr double kCertain = 1e12;         // the precision of what does not deviate

// With the variance of v between ln s and what the cell tells of it.
CellInformation less_by(const CellInformation& told, double tv) {
  const double determinant = told.s * told.k - told.both * told.both;
  if (tv == 0 || !(determinant > 0)) return told;
  const double s = told.k / determinant + tv * tv, k = told.s / determinant, both = -told.both / determinant;
  const double spread = s * k - both * both;
  return {k / spread, s / spread, -both / spread};
}

// ln posterior of (u/tu, w/tw).
class PersonPosteriorDensity {
 public:
  PersonPosteriorDensity(std::span<const PersonCell> cells, ResponseModel model, const SharedParameters& shared,
                         const GroupSpread& spread)
      : cells_(cells), model_(model), shared_(shared), spread_(spread) {
    for (const PersonCell& cell : cells) {
      std::vector<LevelTrials>& design = designs_.emplace_back();
      for (const PersonCell::Counted& one : cell.answers) design.push_back({one.level, one.counts.trials()});
    }
  }

  double value(const std::vector<double>& x) const {
    double value = -prior(x[0], x[1]);
    for (const PersonCell& cell : cells_)
      for (const PersonCell::Counted& one : cell.answers)
        value += log_likelihood_of(one.counts, model_, one.level, cell.mu + spread_.tu * x[0],
                                   cell.kappa + spread_.tw * x[1], shared_);
    return value;
  }

  void derivatives(const std::vector<double>& x, NewtonDerivatives& at) const {
    const double spare = 1 - spread_.rho * spread_.rho;
    at.value = value(x);
    at.gradient = {-(x[0] - spread_.rho * x[1]) / spare, -(x[1] - spread_.rho * x[0]) / spare};
    for (const PersonCell& cell : cells_)
      for (const PersonCell::Counted& one : cell.answers) {
        const AnswerSlopes slopes = slopes_of(one.counts, model_, one.level, cell.mu + spread_.tu * x[0],
                                              cell.kappa + spread_.tw * x[1], shared_);
        at.gradient[0] += spread_.tu * slopes.s;
        at.gradient[1] += spread_.tw * slopes.k;
      }
    const CellInformation told = information(x, false);
    const double uu = told.s * spread_.tu * spread_.tu + 1 / spare, ww = told.k * spread_.tw * spread_.tw + 1 / spare,
                 uw = told.both * spread_.tu * spread_.tw - spread_.rho / spare;
    at.curvature = at.expected = {uu, uw, uw, ww};
  }

  CellInformation information(const std::vector<double>& x, bool through_v) const {
    CellInformation sum;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      CellInformation told = expected_information(model_, designs_[c], cells_[c].mu + spread_.tu * x[0],
                                                  cells_[c].kappa + spread_.tw * x[1], shared_);
      if (through_v) told = less_by(told, cells_[c].tv);
      sum.s += told.s;
      sum.k += told.k;
      sum.both += told.both;
    }
    return sum;
  }

 private:
  double prior(double a, double b) const {
    return (a * a - 2 * spread_.rho * a * b + b * b) / (2 * (1 - spread_.rho * spread_.rho));
  }

  std::span<const PersonCell> cells_;
  ResponseModel model_;
  const SharedParameters& shared_;
  const GroupSpread& spread_;
  std::vector<std::vector<LevelTrials>> designs_;
};

}  // namespace

PersonMode person_mode(std::span<const PersonCell> cells, ResponseModel model, const SharedParameters& shared,
                       const GroupSpread& spread) {
  constexpr double kNearEnough = 1e-2;  // of ln posterior
  const PersonPosteriorDensity density(cells, model, shared, spread);
  const double u = spread.tu > 0 ? kFurthestDeviation : 0, w = spread.tw > 0 ? kFurthestDeviation : 0;
  const std::vector<double> place = maximise_in_box(density, {0, 0}, {{-u, -w}, {u, w}}, -kInf, kNearEnough).place;
  const CellInformation told = density.information(place, true);
  const double prior_s = spread.tu > 0 ? 1 / (spread.tu * spread.tu) : kCertain,
               prior_k = spread.tw > 0 ? 1 / (spread.tw * spread.tw) : kCertain;
  const double in_s = told.s + prior_s, in_k = told.k + prior_k;
  const double determinant = std::max(in_s * in_k - told.both * told.both, 1e-9 * in_s * in_k);
  PersonMode mode;
  mode.u = spread.tu * place[0];
  mode.w = spread.tw * place[1];
  mode.information_u = std::max(0.0, determinant / in_k - prior_s);
  mode.information_w = std::max(0.0, determinant / in_s - prior_k);
  mode.correlation = -told.both / std::sqrt(in_s * in_k);
  return mode;
}

}  // namespace jnd
