#include "analysis/procedures/posterior_defaults.h"

#include <cmath>

namespace jnd {
namespace {

constexpr double kScaledStandard = 900;  // that the numbers below are for

// from, from + step, ...
std::vector<double> even_grid(double from, double step, int size) {
  std::vector<double> grid;
  for (int i = 0; i < size; ++i) grid.push_back(from + i * step);
  return grid;
}

std::vector<double> logarithmic_grid(double low, double high, int size) {
  return even_grid(std::log(low), (std::log(high) - std::log(low)) / (size - 1), size);
}

}  // namespace

PosteriorConfiguration default_posterior(PosteriorTask task, double standard) {
  const double scale = standard / kScaledStandard;
  PosteriorConfiguration c;
  c.task = task;
  if (task == PosteriorTask::same_different) {
    c.ln_s = logarithmic_grid(60 * scale, 1200 * scale, 31);
    c.shift = even_grid(-0.5, 0.1875, 17);
    c.lapse = {0, 0.025, 0.05};
    c.ln_s_prior = {std::log(275 * scale), 0.7};
    c.shift_prior = {0.75, 0.75};
    c.lapse_weights = {0.5, 0.3, 0.2};
    return c;
  }
  c.standard = standard;
  c.ln_s = logarithmic_grid(40 * scale, 800 * scale, 30);
  c.shift = even_grid(-120 * scale, 20 * scale, 13);
  c.lapse = {0, 0.02, 0.06};
  c.ln_s_prior = {std::log(180 * scale), 0.8};
  c.shift_prior = {0, 60 * scale};
  c.lapse_weights = {0.5, 0.35, 0.15};
  return c;
}

}  // namespace jnd
