#include "analysis/procedures/quest.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace jnd {
namespace {

constexpr int kLargestGrid = 200'001;

// Half the grid's steps. A quotient that is whole but for rounding is that whole number.
double half_steps(const QuestParameters& parameters) {
  const double half = parameters.range / parameters.grain / 2;
  return std::ceil(half - 1e-9 * half);
}

}  // namespace

std::string problem_of(const QuestParameters& parameters) {
  const auto inside = [](double share) { return share >= 0 && share < 1; };
  for (const double value : {parameters.t_guess, parameters.t_guess_sd, parameters.p_threshold, parameters.beta,
                             parameters.delta, parameters.gamma, parameters.grain, parameters.range})
    if (!std::isfinite(value)) return "every parameter must be a finite number";
  if (!(parameters.t_guess_sd > 0)) return "the standard deviation of the guess must be above 0";
  if (!(parameters.beta > 0)) return "the slope beta must be above 0";
  if (!inside(parameters.delta)) return "delta is a share from 0 to below 1";
  if (!inside(parameters.gamma)) return "gamma is a probability from 0 to below 1";
  if (!(parameters.grain > 0) || !(parameters.range > 0)) return "grain and range must be above 0";
  constexpr double kMostSds = 6;  // beyond, the guess has all of the prior
  if (parameters.range < 2 * parameters.grain || parameters.grain > kMostSds * parameters.t_guess_sd)
    return "the grid has one threshold only: take a smaller grain, or a larger range or standard deviation";
  if (2 * half_steps(parameters) + 1 > kLargestGrid) return "the grid has more than 200001 values: a larger grain";
  const double lowest = parameters.gamma;  // psi without a stimulus: delta gamma + (1 - delta) gamma
  const double highest = parameters.delta * parameters.gamma + 1 - parameters.delta;
  if (!(parameters.p_threshold > lowest && parameters.p_threshold < highest))
    return "p_threshold is never reached: it must lie between gamma and 1 - delta (1 - gamma)";
  return {};
}

double quest_threshold_shift(const QuestParameters& p) {
  const double unlapsed = (p.p_threshold - p.delta * p.gamma) / (1 - p.delta);
  return std::log10(-std::log((1 - unlapsed) / (1 - p.gamma))) / p.beta;
}

double quest_probability(const QuestParameters& p, double shift, double x, double t) {
  return p.delta * p.gamma + (1 - p.delta) * (1 - (1 - p.gamma) * std::exp(-std::pow(10, p.beta * (x - t + shift))));
}

int quest_grid_size(const QuestParameters& parameters) {
  return 2 * static_cast<int>(half_steps(parameters)) + 1;
}

Quest::Quest(const QuestParameters& parameters) : parameters_(parameters), shift_(quest_threshold_shift(parameters)) {
  const int half = quest_grid_size(parameters) / 2;
  for (int i = -half; i <= half; ++i) {
    const double offset = i * parameters.grain;
    const double z = offset / parameters.t_guess_sd;
    offsets_.push_back(offset);
    posterior_.push_back(std::exp(-z * z / 2));
  }
}

void Quest::answer(double x, bool correct) {
  ++answers_;
  double largest = 0;
  std::vector<double> next(posterior_.size());
  for (std::size_t i = 0; i < next.size(); ++i) {
    const double p = quest_probability(parameters_, shift_, x, parameters_.t_guess + offsets_[i]);
    next[i] = posterior_[i] * (correct ? p : 1 - p);
    largest = std::max(largest, next[i]);
  }
  if (!(largest > 0)) return;  // impossible under every threshold of the grid (delta = 0): it says nothing about them
  for (double& value : next) value /= largest;
  posterior_ = std::move(next);
}

QuestEstimate Quest::estimate() const {
  const double total = std::accumulate(posterior_.begin(), posterior_.end(), 0.0);
  QuestEstimate estimate;
  double first = 0, sum = 0;
  std::size_t median = posterior_.size();
  for (std::size_t i = 0; i < posterior_.size(); ++i) {
    first += posterior_[i] * offsets_[i];
    sum += posterior_[i];
    if (median == posterior_.size() && sum >= total / 2) median = i;
  }
  first /= total;
  double second = 0;
  for (std::size_t i = 0; i < posterior_.size(); ++i)
    second += posterior_[i] * (offsets_[i] - first) * (offsets_[i] - first);
  const auto mode = std::max_element(posterior_.begin(), posterior_.end()) - posterior_.begin();
  estimate.mean = parameters_.t_guess + first;
  estimate.sd = std::sqrt(second / total);
  estimate.mode = parameters_.t_guess + offsets_[static_cast<std::size_t>(mode)];
  estimate.median = parameters_.t_guess + offsets_[median];
  return estimate;
}

}  // namespace jnd
