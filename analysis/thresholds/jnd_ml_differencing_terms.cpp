// The differencing model of one cell and its derivatives.
#include <cmath>

#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>

#include "analysis/thresholds/jnd_ml_differencing.h"
#include "analysis/numerics/log_normal_cdf.h"
#include "analysis/numerics/normal.h"

namespace jnd {

namespace {

constexpr double kRootHalf = boost::math::constants::half_root_two<double>();

// log P("same") for a small tau, where the difference of two distribution functions would lose its digits: its integral
// instead, exp(-d^2/4) / sqrt pi times that of exp(-t^2/4) cosh(t d/2) over 0..tau, which is flat there.
double log_narrow_same(double d, double tau) noexcept {
  const auto density = [d](double t) { return std::exp(-0.25 * t * t) * std::cosh(0.5 * t * d); };
  const double integral = boost::math::quadrature::gauss<double, 7>::integrate(density, 0.0, tau);
  return std::log(integral * boost::math::constants::one_div_root_pi<double>()) - 0.25 * d * d;
}
bool is_narrow(double d, double tau) noexcept {
  return tau * std::fmax(1.0, d) < 0.2;
}

// What a cell is made of: the two probabilities and, relative to each, the density of the absolute percept at tau,
// (phi(a) + phi(b)) / sqrt 2, and the change of P("different") with d, divided by d.
struct Parts {
  double log_different, log_same;
  double density_by_different, density_by_same;
  double change_by_different, change_by_same;
};

// far = exp(-d tau) = phi(b) / phi(a); relative = (1 - far) / d, which tends to tau.
Parts plain_parts(double d, double tau, double a, double b, double far, double relative) noexcept {
  const double beyond = normal_cdf(-a), across = normal_cdf(-b);
  const double different = beyond + across;
  const double same = is_narrow(d, tau) ? std::exp(log_narrow_same(d, tau))
                      : a > 0           ? 1 - different
                                        : normal_cdf(a) - across;
  const double phi = normal_density(a) * kRootHalf;
  return {different > 0.5 ? std::log1p(-same) : std::log(different),
          same > 0.5 ? std::log1p(-different) : std::log(same),
          phi * (1 + far) / different,
          phi * (1 + far) / same,
          phi * relative / different,
          phi * relative / same};
}

// The same by logarithms, where the probabilities underflow.
Parts far_parts(double d, double tau, double a, double b, double far, double relative) noexcept {
  const double log_across = log_normal_cdf(-b).log_cdf, log_beyond = log_normal_cdf(-a).log_cdf;
  const double log_different = log_beyond + std::log1p(std::exp(log_across - log_beyond));
  double log_same = 0;
  if (is_narrow(d, tau)) {
    log_same = log_narrow_same(d, tau);
  } else if (a > 0) {
    log_same = std::log1p(-std::exp(log_different));
  } else {
    const double log_within = log_normal_cdf(a).log_cdf;
    log_same = log_within + std::log1p(-std::exp(log_across - log_within));
  }
  const double log_phi = log_normal_density(a) + std::log(kRootHalf);
  const double log_density = log_phi + std::log1p(far), log_change = log_phi + std::log(relative);
  return {log_different,
          log_same,
          std::exp(log_density - log_different),
          std::exp(log_density - log_same),
          std::exp(log_change - log_different),
          std::exp(log_change - log_same)};
}

}  // namespace

DifferencingTerms differencing_terms(double d, double tau) noexcept {
  constexpr double kPlain = 25;  // Phi(-25) is about 1e-138
  const double a = (tau - d) * kRootHalf, b = (tau + d) * kRootHalf;
  const double far = std::exp(-d * tau);
  const double relative = d * tau > 1e-300 ? -std::expm1(-d * tau) / d : tau;
  const Parts parts = std::abs(a) < kPlain && b < kPlain ? plain_parts(d, tau, a, b, far, relative)
                                                         : far_parts(d, tau, a, b, far, relative);
  const double log_density_slope = -(a + b * far) / (1 + far) * kRootHalf;
  DifferencingTerms terms;
  terms.log_different = parts.log_different;
  terms.log_same = parts.log_same;
  terms.d_tau_different = -parts.density_by_different;
  terms.d_tau_same = parts.density_by_same;
  terms.d_tau2_different = -parts.density_by_different * (log_density_slope + parts.density_by_different);
  terms.d_tau2_same = parts.density_by_same * (log_density_slope - parts.density_by_same);
  terms.d_d_different = parts.change_by_different;
  terms.d_d_same = -parts.change_by_same;
  return terms;
}

}  // namespace jnd
