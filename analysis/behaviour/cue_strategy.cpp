#include "analysis/behaviour/cue_strategy.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <boost/math/special_functions/gamma.hpp>

#include "analysis/numerics/box_newton.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

namespace {

struct Predictor {
  std::vector<double> z;
  double sd = 0;
  bool varies = false;
};

Predictor standardised(const std::vector<double>& x) {
  Predictor result;
  const auto n = static_cast<double>(x.size());
  double mean = 0, square = 0;
  for (const double value : x) mean += value / n;
  for (const double value : x) square += (value - mean) * (value - mean) / n;
  result.sd = std::sqrt(square);
  result.varies = result.sd > 1e-12 * std::abs(mean);
  for (const double value : x) result.z.push_back(result.varies ? (value - mean) / result.sd : 0);
  return result;
}

// P(y = 1) = Phi(x beta): the log-likelihood of probit regression, concave in beta. The first column is 1.
class Probit {
 public:
  Probit(const std::vector<char>& said, std::vector<const std::vector<double>*> columns)
      : said_(said), columns_(std::move(columns)) {}

  std::size_t variables() const noexcept { return 1 + columns_.size(); }
  double value(const std::vector<double>& beta) const {
    double sum = 0;
    for (std::size_t i = 0; i < said_.size(); ++i) sum += std::log(normal_cdf(signed_u(beta, i)));
    return sum;
  }
  void derivatives(const std::vector<double>& beta, NewtonDerivatives& out) const {
    const std::size_t n = variables();
    out.value = 0;
    out.gradient.assign(n, 0);
    out.curvature.assign(n * n, 0);
    for (std::size_t i = 0; i < said_.size(); ++i) {
      const double u = signed_u(beta, i), p = normal_cdf(u), ratio = normal_density(u) / p;
      out.value += std::log(p);
      for (std::size_t a = 0; a < n; ++a) {
        out.gradient[a] += (said_[i] != 0 ? ratio : -ratio) * x(a, i);
        for (std::size_t b = 0; b < n; ++b) out.curvature[a * n + b] += ratio * (ratio + u) * x(a, i) * x(b, i);
      }
    }
    out.expected = out.curvature;  // positive definite already
  }

 private:
  double x(std::size_t column, std::size_t i) const { return column == 0 ? 1 : (*columns_[column - 1])[i]; }
  double signed_u(const std::vector<double>& beta, std::size_t i) const {
    double u = 0;
    for (std::size_t a = 0; a < variables(); ++a) u += beta[a] * x(a, i);
    return said_[i] != 0 ? u : -u;
  }
  const std::vector<char>& said_;
  std::vector<const std::vector<double>*> columns_;
};

struct ProbitFit {
  CueStatus status = CueStatus::ok;
  std::vector<double> beta;
  double slope_se = 0;  // of the last column
  double log_likelihood = 0;
};

ProbitFit fit_probit(const std::vector<char>& said, const std::vector<const std::vector<double>*>& columns) {
  // Standard error, in standardised units, that only an infinite estimate has: the tail of the likelihood is flat
  // there.
  constexpr double kHopeless = 1e3;
  const Probit likelihood(said, columns);
  const std::size_t n = likelihood.variables();
  const NewtonBox box{std::vector<double>(n, -kInf), std::vector<double>(n, kInf)};
  const NewtonResult found = maximise_in_box(likelihood, std::vector<double>(n, 0), box);
  ProbitFit fit;
  fit.beta = found.place;
  fit.log_likelihood = found.value;
  NewtonDerivatives at;
  likelihood.derivatives(found.place, at);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> information = at.curvature, unit(n, 0);
    unit[i] = 1;
    const bool regular = solve_positive_definite(information, unit);
    fit.slope_se = regular ? std::sqrt(unit[i]) : kInf;
    if (!(fit.slope_se < kHopeless)) fit.status = CueStatus::separated;
  }
  return fit;
}

// The answers and the cues' differences of the trials that have all of these cues.
struct Selection {
  std::vector<char> said;
  std::vector<std::vector<double>> x;
};

Selection select(std::span<const CueTrial> trials, const std::vector<Cue>& cues) {
  Selection selection;
  selection.x.resize(cues.size());
  for (const CueTrial& trial : trials) {
    const bool complete = std::all_of(cues.begin(), cues.end(), [&trial](Cue cue) {
      return trial.difference[static_cast<std::size_t>(cue)].has_value();
    });
    if (!complete) continue;
    selection.said.push_back(trial.said_different ? 1 : 0);
    for (std::size_t i = 0; i < cues.size(); ++i)
      selection.x[i].push_back(trial.difference[static_cast<std::size_t>(cues[i])].value_or(0));
  }
  return selection;
}

CueStatus answers_status(const std::vector<char>& said) {
  if (said.size() < static_cast<std::size_t>(kFewestCueTrials)) return CueStatus::too_few_trials;
  const auto different = std::count(said.begin(), said.end(), 1);
  if (different == 0 || different == static_cast<std::ptrdiff_t>(said.size())) return CueStatus::no_information;
  return CueStatus::ok;
}

double constant_log_likelihood(const std::vector<char>& said) {
  const auto n = static_cast<double>(said.size());
  const auto k = static_cast<double>(std::count(said.begin(), said.end(), 1));
  return k * std::log(k / n) + (n - k) * std::log((n - k) / n);
}

CueFit fit_cue(std::span<const CueTrial> trials, Cue cue) {
  CueFit fit;
  fit.cue = cue;
  const Selection selection = select(trials, {cue});
  fit.n = static_cast<int>(selection.said.size());
  fit.missing = static_cast<int>(trials.size()) - fit.n;
  fit.status = answers_status(selection.said);
  if (fit.status != CueStatus::ok) return fit;
  const Predictor predictor = standardised(selection.x.front());
  fit.sd = predictor.sd;
  if (!predictor.varies) {
    fit.status = CueStatus::no_variation;
    return fit;
  }
  const ProbitFit found = fit_probit(selection.said, {&predictor.z});
  fit.status = found.status;
  fit.log_likelihood = found.log_likelihood;
  fit.deviance_explained = 1 - found.log_likelihood / constant_log_likelihood(selection.said);
  fit.aic = 4 - 2 * found.log_likelihood;
  if (found.status == CueStatus::separated) {
    fit.slope = found.beta[1] > 0 ? kInf : -kInf;
    return fit;
  }
  fit.intercept = found.beta[0];
  fit.slope = found.beta[1];
  fit.slope_se = found.slope_se;
  return fit;
}

CuePartialTest beside_stiffness(std::span<const CueTrial> trials, Cue cue) {
  CuePartialTest test;
  if (cue == Cue::stiffness) {
    test.status = CueStatus::no_variation;
    return test;
  }
  const Selection selection = select(trials, {Cue::stiffness, cue});
  test.n = static_cast<int>(selection.said.size());
  test.status = answers_status(selection.said);
  if (test.status != CueStatus::ok) return test;
  const Predictor stiffness = standardised(selection.x[0]), other = standardised(selection.x[1]);
  double correlation = 0;
  for (std::size_t i = 0; i < selection.said.size(); ++i) correlation += stiffness.z[i] * other.z[i] / test.n;
  if (!stiffness.varies || !other.varies || 1 - correlation * correlation < 1e-9) {
    test.status = CueStatus::no_variation;
    return test;
  }
  const ProbitFit alone = fit_probit(selection.said, {&stiffness.z});
  const ProbitFit both = fit_probit(selection.said, {&stiffness.z, &other.z});
  test.status = alone.status != CueStatus::ok ? alone.status : both.status;
  if (test.status != CueStatus::ok) return test;
  test.chi_square = std::fmax(0, 2 * (both.log_likelihood - alone.log_likelihood));
  test.p = boost::math::gamma_q(0.5, 0.5 * test.chi_square);
  return test;
}

bool has_fit(const CueFit& fit) {
  return fit.status == CueStatus::ok || fit.status == CueStatus::separated;
}

constexpr auto kCueWords = words<Cue>(
    {{"stiffness", Cue::stiffness}, {"peak_force", Cue::peak_force}, {"work", Cue::work}, {"dwell", Cue::dwell}});
constexpr auto kCueStatusWords = words<CueStatus>({{"ok", CueStatus::ok},
                                                   {"too_few_trials", CueStatus::too_few_trials},
                                                   {"no_information", CueStatus::no_information},
                                                   {"no_variation", CueStatus::no_variation},
                                                   {"separated", CueStatus::separated}});

}  // namespace

std::string_view to_string(Cue cue) noexcept {
  return word_of(kCueWords, cue);
}

std::string_view to_string(CueStatus status) noexcept {
  return word_of(kCueStatusWords, status);
}

CueStrategy cue_strategy(std::span<const CueTrial> trials) {
  CueStrategy strategy;
  std::vector<Cue> fitted;
  for (std::size_t i = 0; i < kCues.size(); ++i) {
    strategy.cues[i] = fit_cue(trials, kCues[i]);
    strategy.cues[i].beside_stiffness = beside_stiffness(trials, kCues[i]);
    if (has_fit(strategy.cues[i])) fitted.push_back(kCues[i]);
  }
  if (fitted.empty()) {
    strategy.status = strategy.cues.front().status;
    return strategy;
  }
  const Selection common = select(trials, fitted);
  strategy.common_trials = static_cast<int>(common.said.size());
  strategy.status = answers_status(common.said);
  if (strategy.status != CueStatus::ok) return strategy;
  double most = -kInf;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    const Predictor predictor = standardised(common.x[i]);
    if (!predictor.varies) continue;
    const ProbitFit fit = fit_probit(common.said, {&predictor.z});
    if (!(fit.beta[1] > 0) || !(fit.log_likelihood > most)) continue;
    most = fit.log_likelihood;
    strategy.best = fitted[i];
  }
  return strategy;
}

}  // namespace jnd
