#include "analysis/selftest/posterior_quantities.h"

#include <cmath>
#include <string>

#include "analysis/procedures/posterior.h"
#include "analysis/selftest/reference_numbers.h"

namespace jnd {

namespace {

using nlohmann::json;

// from, from + step, ...
std::vector<double> even_grid(double from, double step, int size) {
  std::vector<double> grid;
  for (int i = 0; i < size; ++i) grid.push_back(from + i * step);
  return grid;
}

void compare_trial(const PosteriorProcedure& run, const PosteriorChoice& choice, const json& trial,
                   std::vector<SelftestQuantity>& q) {
  const PosteriorEstimate of = run.estimate();
  const bool which = trial.contains("mean_ln_s");
  const auto reference = [&](const char* key) { return reference_number(trial.at(key)); };
  q[0].absolute(run.level(choice.level), reference("level"));
  q[1].absolute(choice.utility, reference("utility"));
  q[2].absolute(of.mean_ln_s, reference(which ? "mean_ln_s" : "mean_ln_sigma"));
  q[2].absolute(of.sd_ln_s, reference(which ? "sd_ln_s" : "sd_ln_sigma"));
  q[2].absolute(of.mean_shift, reference(which ? "mean_a" : "mean_k"));
  if (which) q[2].absolute(of.sd_shift, reference("sd_a"));
  q[2].absolute(of.mean_lapse, reference("mean_lapse"));
  q[3].relative(std::exp(of.mean_ln_s), reference(which ? "s_geomean" : "jnd_geomean"));
}

bool answer_of(const json& input, std::size_t trial) {
  return input.at("responses").at(trial) == 1;
}

}  // namespace

PosteriorConfiguration reference_posterior(PosteriorTask task, PosteriorUtility utility) {
  PosteriorConfiguration c = default_posterior(task, 900);
  c.utility = utility;
  if (task == PosteriorTask::same_different) {
    c.levels = even_grid(0, 25, 25);
    return c;
  }
  c.levels = even_grid(400, 50, 21);
  c.levels.erase(c.levels.begin() + 10);  // the standard is no level
  return c;
}

PosteriorConfiguration reference_posterior(const json& input) {
  return reference_posterior(
      input.at("definition") == "same_different" ? PosteriorTask::same_different : PosteriorTask::which,
      input.at("utility") == "entropy" ? PosteriorUtility::entropy : PosteriorUtility::variance);
}

PosteriorSlot reference_slot(const json& input, std::size_t trial) {
  const auto task = input.at("definition") == "same_different" ? PosteriorTask::same_different : PosteriorTask::which;
  return posterior_slot_from(input.at("types").get_ref<const std::string&>().at(trial), task).value();
}

std::vector<SelftestQuantity> posterior_quantities() {
  std::vector<SelftestQuantity> q = {{"posterior procedure, levels", 0},
                                     {"posterior procedure, utilities", 1e-10},
                                     {"posterior procedure, means and SDs", 1e-10},
                                     {"posterior procedure, JND (relative)", 1e-9}};
  for (const json& one : reference_numbers("posterior").at("cases")) {
    const json &input = one.at("input"), &trials = one.at("expected").at("trials");
    PosteriorProcedure run(reference_posterior(input));
    for (std::size_t t = 0; t < trials.size(); ++t) {
      const PosteriorChoice choice = run.choose(reference_slot(input, t));
      run.update(choice.level, answer_of(input, t));
      compare_trial(run, choice, trials.at(t), q);
    }
  }
  return q;
}

}  // namespace jnd
