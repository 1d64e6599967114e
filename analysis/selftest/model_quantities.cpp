#include "analysis/selftest/model_quantities.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/numerics/special_values.h"
#include "analysis/selftest/reference_numbers.h"

namespace jnd {

namespace {

using nlohmann::json;

struct HierarchicalQuantities {
  SelftestQuantity likelihood{"hierarchical model, log-likelihood", 1e-6};
  SelftestQuantity means{"hierarchical model, ln JND and criteria", 1e-4};
  SelftestQuantity spreads{"hierarchical model, spreads", 1e-3};
  SelftestQuantity bounds{"hierarchical model, profile intervals", 3e-4};
  SelftestQuantity tests{"hierarchical model, likelihood-ratio tests", 1e-5};
};

void compare_ends(SelftestQuantity& quantity, const ProfileEnds& ours, const json& reference) {
  if (reference.is_null()) return;  // not computed there
  quantity.absolute(ours.low, reference_number(reference.at(0)));
  quantity.absolute(ours.high, reference_number(reference.at(1)));
}

// Criteria of choices and their spread have the unit of the levels; here they are shares of the JND.
void compare_hierarchical(HierarchicalQuantities& q, HierarchicalAnalysis& analysis, bool choice,
                          const json& expected) {
  const HierarchicalFit& fit = analysis.fit();
  const HierarchicalPlace& place = fit.maximum.place;
  const double unit = choice ? std::exp(place.mu.front()) : 1;
  q.likelihood.absolute(fit.maximum.log_likelihood, reference_number(expected.at("loglik")));
  const json& criteria = expected.at(choice ? "alpha" : "kappa");
  for (std::size_t c = 0; c < fit.conditions.size(); ++c)
    q.means.absolute(fit.conditions[c].criterion / unit, reference_number(criteria.at(c)) / unit);
  for (std::size_t c = 0; c < expected.at("mu").size(); ++c)
    q.means.absolute(fit.conditions[c].mu, reference_number(expected.at("mu").at(c)));
  q.spreads.absolute(place.tu, reference_number(expected.at("tu")));
  if (expected.contains("tv")) q.spreads.absolute(place.tv, reference_number(expected.at("tv")));
  q.spreads.absolute(place.tw / unit, reference_number(expected.at("tw")) / unit);
  if (expected.contains("lr_equal_mu")) {
    q.tests.absolute(fit.lr, reference_number(expected.at("lr_equal_mu")));
    q.tests.absolute(fit.p, reference_number(expected.at("p_equal_mu")));
  }
  if (expected.contains("mu_ci")) {
    analysis.add_intervals();
    for (std::size_t c = 0; c < fit.conditions.size(); ++c)
      compare_ends(q.bounds, fit.conditions[c].ends, expected.at("mu_ci").at(c));
  }
  if (!expected.contains("mu_diff")) return;
  const std::vector<ConditionDifference> differences = analysis.complete({.pairs = analysis.pairs()}).differences;
  for (const json& one : expected.at("mu_diff"))
    for (const ConditionDifference& ours : differences)
      if (ours.a + 1 == one.at("a") && ours.b + 1 == one.at("b")) {
        q.means.absolute(ours.difference, reference_number(one.at("diff")));
        compare_ends(q.bounds, ours.ends, one.at("ci"));
      }
}

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

using nlohmann::json;

// The number under the key; NaN where there is none.
double scaling_number(const json& object, const char* key) {
  return reference_number(object.value(key, json()));
}

struct ScalingQuantities {
  SelftestQuantity means{"magnitudes: geometric means, equal moduli (relative)", 1e-9};
  SelftestQuantity laws{"magnitudes: exponents, errors, intervals (relative)", 1e-9};
  SelftestQuantity refused{"magnitudes: answers that are refused", 0};
  SelftestQuantity settings{"adjustment: PSE, JND, start effect (relative)", 1e-9};
  SelftestQuantity group{"adjustment: group (relative)", 1e-9};
};

void compare_list(SelftestQuantity& quantity, const std::vector<double>& ours, const json& reference) {
  quantity.absolute(static_cast<double>(ours.size()), static_cast<double>(reference.size()));
  for (std::size_t i = 0; i < ours.size() && i < reference.size(); ++i)
    quantity.relative(ours[i], reference_number(reference.at(i)));
}

// By their distances from the middle, whose size is what they are known to: one that ends near 0 has no digits of its own.
void compare_interval(SelftestQuantity& quantity, double middle, double low, double high, const json& reference) {
  quantity.relative(low - middle, reference_number(reference.at(0)) - middle);
  quantity.relative(high - middle, reference_number(reference.at(1)) - middle);
}

void compare_mean(SelftestQuantity& quantity, const MeanInterval& ours, const json& reference) {
  quantity.absolute(ours.n, scaling_number(reference, "n"));
  quantity.relative(ours.mean, scaling_number(reference, "mean"));
  quantity.relative(ours.sd, scaling_number(reference, "sd"));
  quantity.relative(ours.se, scaling_number(reference, "se"));
  compare_interval(quantity, ours.mean, ours.ci_low, ours.ci_high, reference.at("ci"));
}

void compare_law(SelftestQuantity& quantity, const PowerLaw& ours, const json& reference) {
  quantity.relative(ours.exponent, scaling_number(reference, "exponent"));
  quantity.relative(ours.intercept, scaling_number(reference, "intercept"));
  quantity.relative(ours.se, scaling_number(reference, "se"));
  compare_interval(quantity, ours.exponent, ours.ci_low, ours.ci_high, reference.at("ci"));
  quantity.relative(ours.r2, scaling_number(reference, "r2"));
  quantity.relative(ours.residual_sd, scaling_number(reference, "residual_sd"));
}

void compare_refused(SelftestQuantity& quantity, const MagnitudeScale& ours, const json& reference) {
  quantity.absolute(static_cast<double>(ours.refused.size()), static_cast<double>(reference.size()));
  for (std::size_t i = 0; i < ours.refused.size() && i < reference.size(); ++i) {
    const RefusedAnswer& one = ours.refused[i];
    quantity.absolute(static_cast<double>(one.participant), reference.at(i).at(0));
    quantity.absolute(static_cast<double>(one.stimulus), reference.at(i).at(1));
    quantity.absolute(static_cast<double>(one.repeat), reference.at(i).at(2));
    quantity.absolute(one.answer, reference.at(i).at(3));
  }
}

void compare_magnitudes(ScalingQuantities& q, const json& input, const json& expected) {
  const MagnitudeScale ours = magnitude_scale(reference_magnitudes(input));
  if (expected.at("status") == "refused") {
    compare_refused(q.refused, ours, expected.at("not_positive"));
    return;
  }
  q.means.relative(ours.grand_geometric_mean, scaling_number(expected, "grand_geometric_mean"));
  for (std::size_t p = 0; p < ours.participants.size(); ++p) {
    const ParticipantMagnitudes& one = ours.participants[p];
    compare_list(q.means, one.cells, expected.at("cell_geometric_means").at(p));
    compare_list(q.means, one.normalised, expected.at("normalised").at(p));
    q.means.relative(one.geometric_mean, reference_number(expected.at("participant_geometric_mean").at(p)));
    compare_law(q.laws, one.law, expected.at("participants").at(p));
  }
  compare_list(q.means, ours.group_geometric_means, expected.at("group_geometric_means"));
  compare_list(q.means, ours.group_ln_se, expected.at("group_ln_se"));
  compare_law(q.laws, ours.group, expected.at("group"));
  compare_mean(q.laws, ours.exponents, expected.at("exponents"));
}

void compare_settings(SelftestQuantity& quantity, const Adjustment& ours, const json& reference) {
  quantity.absolute(ours.settings.n, scaling_number(reference, "n"));
  quantity.relative(ours.settings.mean, scaling_number(reference, "pse"));
  quantity.relative(ours.constant_error, scaling_number(reference, "constant_error"));
  quantity.relative(ours.settings.sd, scaling_number(reference, "sd"));
  quantity.relative(ours.jnd, scaling_number(reference, "jnd"));
  quantity.relative(ours.weber, scaling_number(reference, "weber"));
  quantity.relative(ours.settings.se, scaling_number(reference, "se"));
  compare_interval(quantity, ours.settings.mean, ours.settings.ci_low, ours.settings.ci_high, reference.at("pse_ci"));
  quantity.relative(ours.mean_from_above, scaling_number(reference, "mean_from_above"));
  quantity.relative(ours.mean_from_below, scaling_number(reference, "mean_from_below"));
  quantity.relative(ours.start_effect, scaling_number(reference, "start_effect"));
  quantity.relative(ours.variable_error, scaling_number(reference, "variable_error"));
  quantity.relative(ours.jnd_within_side, scaling_number(reference, "jnd_within_side"));
  quantity.relative(ours.start_t, scaling_number(reference, "start_t"));
  quantity.relative(ours.start_p, scaling_number(reference, "start_p"));
  if (reference.contains("start_df")) quantity.absolute(ours.start_df, scaling_number(reference, "start_df"));
}

void compare_adjustments(ScalingQuantities& q, const json& input, const json& expected) {
  const std::vector<Adjustment> ours = reference_adjustments(input);
  for (std::size_t p = 0; p < ours.size(); ++p)
    compare_settings(q.settings, ours[p], expected.at("participants").at(p));
  const AdjustmentGroup group = adjustment_group(ours);
  const json& reference = expected.at("group");
  compare_mean(q.group, group.pse, reference.at("pse"));
  compare_mean(q.group, group.constant_error, reference.at("constant_error"));
  q.group.relative(group.constant_error_test.t, scaling_number(reference, "constant_error_t"));
  q.group.relative(group.constant_error_test.p, scaling_number(reference, "constant_error_p"));
  compare_mean(q.group, group.jnd, reference.at("jnd"));
  compare_mean(q.group, group.ln_jnd, reference.at("ln_jnd"));
  q.group.relative(group.jnd_geometric_mean, scaling_number(reference, "jnd_geometric_mean"));
  compare_list(q.group, {group.jnd_geometric_ci_low, group.jnd_geometric_ci_high}, reference.at("jnd_geometric_ci"));
  if (reference.contains("start_effect")) compare_mean(q.group, group.start_effect, reference.at("start_effect"));
  q.group.relative(group.start_effect_test.t, scaling_number(reference, "start_effect_t"));
  q.group.relative(group.start_effect_test.p, scaling_number(reference, "start_effect_p"));
}

}  // namespace

std::vector<HierarchicalCell> reference_answers(const json& one_case) {
  std::vector<HierarchicalCell> cells;
  for (const json& row : one_case.at("input").at("rows")) {
    const double n = row.at(3), positive = row.at(4);
    cells.push_back({row.at(0).get<int>() - 1, row.at(1).get<int>() - 1, row.at(2), positive, n - positive});
  }
  return cells;
}

HierarchicalModel reference_model(const json& fit, ResponseModel response) {
  const json& given = fit.at("model");
  const auto has = [&given](const char* name) {
    return std::any_of(given.at("random").begin(), given.at("random").end(),
                       [name](const json& one) { return one == name; });
  };
  HierarchicalModel model;
  model.response = response;
  model.shared.lapse = given.at("lapse");
  model.tu = has("tu");
  model.tv = has("tv");
  model.tw = has("tw");
  model.rho = has("rho");
  model.one_mean = given.at("label") == "a_common_slope";
  return model;
}

std::vector<SelftestQuantity> hierarchical_quantities() {
  HierarchicalQuantities q;
  for (const auto& [task, response] :
       {std::pair{"same_different", ResponseModel::yes_no}, {"which", ResponseModel::choice}})
    for (const json& one : reference_numbers("hierarchical").at(task))
      for (const json& fit : one.at("expected")) {
        HierarchicalAnalysis analysis(reference_answers(one), reference_model(fit, response));
        compare_hierarchical(q, analysis, response == ResponseModel::choice, fit.at("expected"));
      }
  return {q.likelihood, q.means, q.spreads, q.bounds, q.tests};
}

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

MagnitudeEstimates reference_magnitudes(const json& input) {
  return {input.at("stimuli"), input.at("estimates")};
}

std::vector<Adjustment> reference_adjustments(const json& input) {
  std::vector<Adjustment> participants;
  for (const json& one : input.at("participants")) {
    std::vector<Setting> settings;
    for (std::size_t k = 0; k < one.at("setting").size(); ++k)
      settings.push_back({one.at("setting").at(k), one.at("start").at(k) > 0 ? StartSide::above : StartSide::below});
    participants.push_back(adjustment(settings, input.at("standard")));
  }
  return participants;
}

std::vector<SelftestQuantity> scaling_quantities() {
  ScalingQuantities q;
  for (const json& one : reference_numbers("scaling").at("cases")) {
    const json &input = one.at("input"), &expected = one.at("expected");
    if (input.contains("stimuli"))
      compare_magnitudes(q, input, expected);
    else
      compare_adjustments(q, input, expected);
  }
  return {q.means, q.laws, q.refused, q.settings, q.group};
}

}  // namespace jnd
