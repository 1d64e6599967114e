#include "analysis/selftest/selftest.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/choice/choice_dprime.h"
#include "analysis/choice/two_interval.h"
#include "analysis/detection/detection_row.h"
#include "analysis/group/compare.h"
#include "analysis/group/p_adjust.h"
#include "analysis/group/shapiro_wilk.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/studentised_range.h"
#include "analysis/procedures/quest.h"
#include "analysis/procedures/staircase.h"
#include "analysis/psychometric/psychometric.h"
#include "analysis/ratings/identification.h"
#include "analysis/ratings/rating_roc.h"
#include "analysis/ratings/sureness.h"
#include "analysis/selftest/model_quantities.h"
#include "analysis/selftest/reference_numbers.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {
namespace {

using nlohmann::json;
using Quantities = std::vector<SelftestQuantity>;

// The number under the key; NaN where the independent program gave none.
double number_at(const json& object, const char* key) {
  return reference_number(object.value(key, json()));
}

// ---- signal detection

void compare_yes_no(SelftestQuantity& scores, SelftestQuantity& errors, const YesNo& ours, const json& reference) {
  scores.absolute(ours.dprime, number_at(reference, "dprime"));
  scores.absolute(ours.criterion, number_at(reference, "criterion_c"));
  scores.absolute(ours.ln_beta, number_at(reference, "ln_beta"));
  errors.absolute(ours.se, number_at(reference, "se_gg"));
  errors.absolute(ours.ci_low, number_at(reference, "wald_lo"));
  errors.absolute(ours.ci_high, number_at(reference, "wald_hi"));
}

Quantities detection_quantities() {
  SelftestQuantity scores{"yes-no d', c, ln beta", 1e-10};
  SelftestQuantity errors{"yes-no standard error and Wald interval", 1e-10};
  SelftestQuantity profile{"yes-no profile interval", 1e-6};
  SelftestQuantity likelihood{"log-likelihood of yes-no and differencing", 1e-10};
  SelftestQuantity differencing{"differencing d', tau and errors", 1e-8};
  SelftestQuantity differencing_profile{"differencing profile interval", 1e-6};
  SelftestQuantity p_value{"differencing p of d' = 0", 1e-9};
  SelftestQuantity rates{"differencing d', tau of log-linear rates", 1e-8};
  SelftestQuantity unit_slope{"independent observation, unit slope", 1e-10};
  SelftestQuantity exact{"independent observation, likelihood ratio", 1e-6};
  SelftestQuantity bootstrap{"exact bootstrap of d'", 1e-10};
  for (const json& one : reference_numbers("signal_detection")) {
    if (one.contains("status")) continue;  // a class without trials: every number is missing
    const DetectionRow row =
        detection_row({one.at("n_diff"), one.at("hits"), one.at("n_same"), one.at("false_alarms")});
    compare_yes_no(scores, errors, row.none, one.at("yesno_none"));
    compare_yes_no(scores, errors, row.loglinear, one.at("yesno_loglinear"));
    compare_yes_no(scores, errors, row.half, one.at("yesno_half_n"));
    const json& by_profile = one.at("yesno_profile95");
    scores.absolute(row.profile.dprime, number_at(by_profile, "dprime_mle"));
    profile.absolute(row.profile.ci_low, number_at(by_profile, "lo"));
    profile.absolute(row.profile.ci_high, number_at(by_profile, "hi"));
    likelihood.absolute(row.profile.log_likelihood, number_at(by_profile, "logLik"));
    const DifferencingFit& fit = row.differencing.fit;
    const json& by_sensr = one.at("differencing_ml_raw");
    const double dprime = number_at(by_sensr, "delta");
    likelihood.absolute(fit.log_likelihood, number_at(by_sensr, "logLik_exact"));
    differencing.absolute(fit.dprime, dprime);
    differencing.absolute(fit.se_dprime, number_at(by_sensr, "se_delta"));
    if (dprime > 0 && std::isfinite(dprime)) {  // at a boundary of d' sensR stops short of the maximum over tau
      differencing.absolute(fit.tau, number_at(by_sensr, "tau"));
      differencing.absolute(fit.se_tau, number_at(by_sensr, "se_tau"));
    }
    differencing_profile.absolute(row.differencing.ci_low, number_at(by_sensr, "profile_delta_lo"));
    differencing_profile.absolute(row.differencing.ci_high, number_at(by_sensr, "profile_delta_hi"));
    p_value.absolute(row.differencing.p_value, number_at(by_sensr, "p_one_sided"));
    const json& of_rates = one.at("differencing_loglinear");
    rates.absolute(row.differencing_loglinear.dprime, number_at(of_rates, "dprime"));
    rates.absolute(row.differencing_loglinear.tau, number_at(of_rates, "tau"));
    const json &loglinear = one.at("independent_obs_loglinear"), &half = one.at("independent_obs_half_n");
    unit_slope.absolute(row.independent_loglinear.unit_slope, number_at(loglinear, "unit_slope"));
    unit_slope.absolute(row.independent_half.unit_slope, number_at(half, "unit_slope"));
    exact.absolute(row.independent_loglinear.exact, number_at(loglinear, "exact_lr"));
    exact.absolute(row.independent_half.exact, number_at(half, "exact_lr"));
    const json& enumerated = one.at("exact_parametric_bootstrap_loglinear");
    bootstrap.absolute(row.bootstrap.mean, number_at(enumerated, "mean"));
    bootstrap.absolute(row.bootstrap.sd, number_at(enumerated, "sd"));
    bootstrap.absolute(row.bootstrap.q025, number_at(enumerated, "q025"));
    bootstrap.absolute(row.bootstrap.q975, number_at(enumerated, "q975"));
  }
  return {scores,  errors, profile,    likelihood, differencing, differencing_profile,
          p_value, rates,  unit_slope, exact,      bootstrap};
}

// ---- thresholds: the estimates that a study's numbers rest on

Quantities jnd_quantities() {
  SelftestQuantity closed{"JND, closed forms (relative)", 1e-10};
  SelftestQuantity slope{"JND, maximum-likelihood slope (relative)", 1e-6};
  SelftestQuantity bounds{"JND, profile bounds of the slope (relative)", 1e-5};
  for (const json& one : reference_numbers("jnd").at("cases")) {
    std::vector<SeriesCounts> series;
    for (const json& row : one.at("series")) series.push_back({row[0], {row[1], row[2], row[3], row[4]}});
    const auto estimate_by = [&](std::string_view method) {
      return estimate_jnd(series, one.at("reference"), jnd_method_from(method).value(), Correction::loglinear);
    };
    for (const char* method : {"least_squares", "weighted", "inverse_mean_slope", "mean_of_ratios"}) {
      const json& reference = one.at(method);
      // A mean over a pole, which the reference prints, is undefined here.
      closed.relative(estimate_by(method).jnd, reference.value("defined", true) ? number_at(reference, "jnd") : kNaN);
    }
    for (const char* method :
         {"ml_yes_no_common", "ml_yes_no_series", "ml_differencing_common", "ml_differencing_series"}) {
      const JndEstimate estimate = estimate_by(method);
      const json& reference = one.at(method);
      slope.relative(estimate.slope, number_at(reference, "slope"));
      bounds.relative(estimate.slope_ci_low, number_at(reference, "slope_ci_low"));
      bounds.relative(estimate.slope_ci_high, number_at(reference, "slope_ci_high"));
    }
  }
  return {closed, slope, bounds};
}

// ---- group statistics

struct GroupQuantities {
  SelftestQuantity intervals{"t and Cousineau-Morey intervals (relative)", 1e-9};
  SelftestQuantity shapiro_w{"Shapiro-Wilk W", 1e-8}, shapiro_p{"Shapiro-Wilk p", 1e-6};
  SelftestQuantity sphericity{"Mauchly W, epsilons (relative)", 1e-9};
  SelftestQuantity anova{"F, eta squared, t, chi squared (relative)", 1e-9};
  SelftestQuantity p{"p of F, t, chi squared, Mauchly", 1e-9};
  SelftestQuantity range_p{"p of the studentised range", 1e-6};
  SelftestQuantity range_q{"quantile of the studentised range", 1e-4};
  SelftestQuantity wilcoxon{"Wilcoxon V, rank-biserial (relative)", 1e-9};
  SelftestQuantity wilcoxon_p{"Wilcoxon p", 1e-12};
  SelftestQuantity adjusted{"Holm, Benjamini-Hochberg", 1e-12};

  // In the order in which they are printed.
  Quantities all() const {
    return {intervals, shapiro_w, shapiro_p, sphericity, anova, p, range_p, range_q, wilcoxon, wilcoxon_p, adjusted};
  }
};

void compare_pair(GroupQuantities& q, const PairComparison& ours, const json& dataset, std::size_t place) {
  const json& t = dataset.at("paired_t").at(place);
  q.anova.relative(ours.t.t, number_at(t, "t"));
  q.p.absolute(ours.t.p, number_at(t, "p"));
  q.adjusted.absolute(ours.t_p_holm, number_at(t, "p_holm"));
  const json& games_howell = dataset.at("games_howell").at(place);
  q.anova.relative(ours.games_howell.q, number_at(games_howell, "q"));
  q.anova.relative(ours.games_howell.df, number_at(games_howell, "df"));
  q.range_p.absolute(ours.games_howell.p, number_at(games_howell, "p"));
  const json& tukey = dataset.at("tukey_rm").at(place);
  q.anova.relative(ours.tukey.q, number_at(tukey, "q"));
  q.range_p.absolute(ours.tukey.p, number_at(tukey, "p"));
  const json& wilcoxon = dataset.at("wilcoxon").at(place);
  q.wilcoxon.relative(ours.wilcoxon.v, number_at(wilcoxon, "V"));
  q.wilcoxon.relative(ours.wilcoxon.rank_biserial, number_at(wilcoxon, "rank_biserial_matched"));
  q.wilcoxon_p.absolute(ours.wilcoxon.p, number_at(wilcoxon, "R_default_p"));
  q.wilcoxon_p.absolute(ours.wilcoxon.p_exact_permutation, number_at(wilcoxon, "perm_exact_p_zeros_dropped"));
}

void compare_dataset(GroupQuantities& q, const json& dataset) {
  WithinTable table{dataset.at("data").size(), dataset.at("conditions").size(), {}};
  for (const json& row : dataset.at("data"))
    for (const json& value : row) table.values.push_back(value);
  const Comparison found = compare(table);
  for (std::size_t j = 0; j < table.k; ++j) {
    const ConditionSummary& of = found.conditions[j];
    q.intervals.relative(of.ci_high - of.mean, dataset.at("ci95_halfwidth_t").at(j));
    q.intervals.relative(of.ci_within_high - of.mean, dataset.at("ci95_within_morey").at(j));
    q.shapiro_w.absolute(of.shapiro.w, number_at(dataset.at("shapiro").at(j), "W"));
    q.shapiro_p.absolute(of.shapiro.p, number_at(dataset.at("shapiro").at(j), "p"));
  }
  for (std::size_t pair = 0; pair < found.pairs.size(); ++pair) compare_pair(q, found.pairs[pair], dataset, pair);
  const WithinEffect& effect = found.anova.effect;
  const json &mauchly = dataset.at("mauchly"), &anova = dataset.at("rm_anova"), &friedman = dataset.at("friedman");
  q.sphericity.relative(effect.mauchly.w, number_at(mauchly, "W"));
  q.sphericity.relative(effect.epsilon_gg, number_at(anova, "eps_gg"));
  q.sphericity.relative(effect.epsilon_hf, number_at(anova, "eps_hf"));
  q.anova.relative(effect.f, number_at(anova, "F"));
  q.anova.relative(found.anova.eta2_generalised, number_at(anova, "eta2_generalized"));
  q.anova.relative(effect.eta2_partial, number_at(anova, "eta2_partial"));
  q.anova.relative(found.friedman.chi2, number_at(friedman, "chi2"));
  q.anova.relative(found.friedman.kendall_w, number_at(friedman, "kendall_W"));
  q.p.absolute(effect.mauchly.p, number_at(mauchly, "p"));
  q.p.absolute(effect.p, number_at(anova, "p"));
  q.p.absolute(effect.p_gg, number_at(anova, "p_gg"));
  q.p.absolute(effect.p_hf, number_at(anova, "p_hf"));
  q.p.absolute(found.friedman.p, number_at(friedman, "p"));
}

Quantities group_quantities() {
  const json& reference = reference_numbers("group");
  GroupQuantities q;
  for (const json& dataset : reference.at("datasets")) compare_dataset(q, dataset);
  for (const json& one : reference.at("ptukey"))
    q.range_p.absolute(studentised_range_upper(one.at("q"), one.at("k"), one.at("df")), number_at(one, "upper_p"));
  for (const json& one : reference.at("qtukey"))
    q.range_q.absolute(studentised_range_quantile(one.at("p"), one.at("k"), one.at("df")), number_at(one, "q"));
  for (const json& one : reference.at("shapiro_extra")) {
    const ShapiroWilk found = shapiro_wilk(one.at("x").get<std::vector<double>>());
    q.shapiro_w.absolute(found.w, number_at(one, "W"));
    q.shapiro_p.absolute(found.p, number_at(one, "p"));
  }
  const json& adjusted = reference.at("padjust");
  const std::vector<double> p = adjusted.at("p");
  const std::vector<double> by_holm = holm(p, 17), by_bh = benjamini_hochberg(p, 17);
  for (std::size_t i = 0; i < p.size(); ++i) {
    q.adjusted.absolute(by_holm[i], adjusted.at("holm_m17").at(i));
    q.adjusted.absolute(by_bh[i], adjusted.at("BH_m17").at(i));
  }
  return q.all();
}

// ---- psychometric functions

Quantities psychometric_quantities() {
  SelftestQuantity parameters{"psychometric parameters (relative)", 1e-5};
  SelftestQuantity errors{"psychometric standard errors (relative)", 1e-5};
  SelftestQuantity deviance{"psychometric log-likelihood and deviance", 1e-7};
  SelftestQuantity thresholds{"psychometric PSE and JND (relative)", 1e-5};
  for (const json& data : reference_numbers("psychometric").at("cases")) {
    std::vector<PsychometricLevel> levels;
    for (std::size_t i = 0; i < data.at("x").size(); ++i)
      levels.push_back({data.at("x")[i], data.at("n")[i], data.at("k")[i]});
    PsychometricModel model;
    model.guess = data.at("guess");
    model.lapse.reset();
    if (!data.at("lapse_fixed").is_null()) model.lapse = data.at("lapse_fixed").get<double>();
    const auto compare_fit = [&](const json& reference) {
      model.function = psychometric_function_from(reference.at("family").get<std::string>()).value();
      const PsychometricFit fit = fit_psychometric(levels, model);
      const json &values = reference.at("par"), &ses = reference.at("se_observed_info");
      parameters.relative(fit.location.value, values.at(0));
      parameters.relative(fit.second.value, values.at(1));
      errors.relative(fit.location.se, ses.at(0));
      errors.relative(fit.second.se, ses.at(1));
      if (!model.lapse) {
        parameters.relative(fit.lapse.value, values.at(2));
        errors.relative(fit.lapse.se, ses.at(2));
      }
      deviance.absolute(fit.log_likelihood, number_at(reference, "logLik_no_binomial_const"));
      deviance.absolute(fit.deviance, number_at(reference, "deviance"));
      thresholds.relative(fit.pse.value, number_at(reference, "F50"));
      thresholds.relative(fit.jnd.value, number_at(reference, "JND_F75_minus_F50"));
    };
    for (const json& reference : data.at("fits")) compare_fit(reference);
    model.estimator = PsychometricEstimator::map;
    model.prior = {2, 50};
    for (const json& reference : data.value("map_fits", json::array())) compare_fit(reference);
  }
  return {parameters, errors, deviance, thresholds};
}

// ---- choices between two intervals

struct ChoiceQuantities {
  SelftestQuantity likelihood{"two-interval log-likelihood and deviance", 1e-7};
  SelftestQuantity estimates{"two-interval PSE, s and JND (relative)", 1e-6};
  SelftestQuantity lapse{"two-interval lapse rate", 1e-5};
  SelftestQuantity bounds{"two-interval profile bounds (relative)", 1e-5};
  SelftestQuantity order{"two-interval order term and its test", 1e-6};
};

void compare_bounds(SelftestQuantity& quantity, const std::optional<ChoiceBounds>& ours, const json& expected,
                    const char* key) {
  if (!expected.contains(key)) return;
  const ChoiceBounds bounds = ours.value_or(ChoiceBounds{kNaN, kNaN});
  quantity.relative(bounds.low, reference_number(expected.at(key).at(0)));
  quantity.relative(bounds.high, reference_number(expected.at(key).at(1)));
}

void compare_choices(ChoiceQuantities& q, const std::vector<ChoiceRow>& rows, const TwoIntervalOptions& options,
                     const json& expected) {
  const TwoIntervalFit fit = fit_two_interval(rows, options);
  const bool alike = word_of(kTwoIntervalStatusWords, fit.status) == expected.at("status").get<std::string>();
  q.likelihood.absolute(alike ? fit.log_likelihood.value_or(kNaN) : kInf, number_at(expected, "loglik"));
  q.likelihood.absolute(fit.deviance.value_or(kNaN), number_at(expected, "deviance"));
  const double s = fit.s.value_or(kNaN);
  const ChoiceJnds jnds = choice_jnds(options.link, s);
  q.estimates.relative(fit.pse.value_or(kNaN), number_at(expected, "pse"));
  q.estimates.relative(s, number_at(expected, "s"));
  q.estimates.relative(jnds.jnd_75, number_at(expected, "jnd_75"));
  q.estimates.relative(jnds.jnd_84, number_at(expected, "jnd_84"));
  q.estimates.relative(jnds.jnd_dprime1, number_at(expected, "jnd_dprime1"));
  q.lapse.absolute(fit.lapse.value_or(kNaN), number_at(expected, "lapse"));
  const TwoIntervalIntervals intervals = two_interval_intervals(rows, options);
  compare_bounds(q.bounds, fit.pse_range, expected, "pse_range");
  compare_bounds(q.bounds, intervals.pse, expected, "pse_ci");
  compare_bounds(q.bounds, intervals.s, expected, "s_ci");
  compare_bounds(q.bounds, intervals.order_b, expected, "order_b_ci");
  if (!options.order_term) return;
  const OrderTermTest test = test_order_term(rows, options, fit);
  q.order.absolute(fit.order_b.value_or(kNaN), number_at(expected, "order_b"));
  q.order.absolute(test.lr, number_at(expected, "order_lr"));
  q.order.absolute(test.p, number_at(expected, "order_p"));
}

Quantities two_interval_quantities() {
  ChoiceQuantities q;
  for (const json& one : reference_numbers("two_interval").at("cases")) {
    const json& input = one.at("input");
    TwoIntervalOptions options;
    options.link = value_of(kChoiceLinkWords, input.at("link").get<std::string>()).value();
    options.lapse.reset();
    if (!input.at("lapse").is_string()) options.lapse = input.at("lapse").get<double>();
    options.order_term = input.contains("order");
    std::vector<ChoiceRow> rows;
    for (std::size_t i = 0; i < input.at("x").size(); ++i)
      rows.push_back({input.at("x")[i], input.at("n")[i], input.at("k")[i],
                      options.order_term ? input.at("order")[i].get<int>() : 0});
    compare_choices(q, rows, options, one.at("expected"));
  }
  return {q.likelihood, q.estimates, q.lapse, q.bounds, q.order};
}

// ---- adaptive procedures

// Sequences of unequal length differ in every case.
void compare_sequences(SelftestQuantity& quantity, const std::vector<double>& ours,
                       const std::vector<double>& reference) {
  for (std::size_t i = 0; i < std::max(ours.size(), reference.size()); ++i)
    quantity.absolute(i < ours.size() ? ours[i] : HUGE_VAL, i < reference.size() ? reference[i] : -HUGE_VAL);
}

void compare_staircases(SelftestQuantity& levels, SelftestQuantity& targets) {
  const json& staircases = reference_numbers("adaptive").at("staircases");
  for (const json& reference : staircases.at("runs")) {
    StaircaseRule rule;
    rule.start = staircases.at("start");
    rule.up = reference.at("up");
    rule.down = reference.at("down");
    rule.step_up = rule.step_down = reference.at("step");
    rule.halve_after = reference.at("halve_after").get<std::vector<int>>();
    rule.clamp = staircases.at("clamp").get<std::array<double, 2>>();
    Staircase run(rule);
    std::vector<double> ours;
    for (const char answer : staircases.at("answers").get_ref<const std::string&>()) {
      ours.push_back(run.level());
      run.answer(answer == '1');
    }
    compare_sequences(levels, ours, reference.at("levels"));
    compare_sequences(levels, run.reversals(), reference.at("reversals"));
    levels.absolute(run.level(), number_at(reference, "next"));
    targets.absolute(staircase_target(rule), number_at(reference, "target"));
  }
}

Quantities adaptive_quantities() {
  SelftestQuantity levels{"staircase levels and reversals", 0};
  SelftestQuantity targets{"staircase target probability", 1e-12};
  compare_staircases(levels, targets);
  SelftestQuantity shift{"QUEST threshold shift", 1e-14};
  SelftestQuantity posterior{"QUEST mean and sd", 1e-12};
  SelftestQuantity grid{"QUEST mode and median", 1e-12};
  const json& quest = reference_numbers("adaptive").at("quest");
  shift.absolute(quest_threshold_shift(reference_quest()), number_at(quest, "threshold_shift"));
  Quest run(reference_quest());
  for (const json& trial : quest.at("trials")) {
    run.answer(trial.at("x"), trial.at("correct"));
    const QuestEstimate estimate = run.estimate();
    posterior.absolute(estimate.mean, number_at(trial, "mean"));
    posterior.absolute(estimate.sd, number_at(trial, "sd"));
    grid.absolute(estimate.mode, number_at(trial, "mode"));
    grid.absolute(estimate.median, number_at(trial, "median"));
  }
  return {levels, targets, shift, posterior, grid};
}

// ---- choice: tasks with a right answer

void compare_two_rates(SelftestQuantity& quantity, const TwoRates& ours, const json& reference) {
  quantity.absolute(ours.z_difference, reference_number(reference.at("z_difference")));
  quantity.absolute(ours.dprime_differencing, reference_number(reference.at("dprime_differencing")));
  quantity.absolute(ours.dprime_independent, reference_number(reference.at("dprime_independent")));
  if (reference.contains("pc_unbiased"))
    quantity.absolute(ours.pc_unbiased, reference_number(reference.at("pc_unbiased")));
}

RatesTask rates_task_of(const json& name) {
  if (name == "abx") return RatesTask::abx;
  return name == "reminder_2afc" ? RatesTask::reminder_two_intervals : RatesTask::reminder_one_interval;
}

Quantities choice_quantities() {
  SelftestQuantity dprime{"m-AFC, oddity, ABX, duo-trio d' and error", 1e-8};
  SelftestQuantity interval{"m-AFC, oddity, ABX, duo-trio interval", 1e-7};
  SelftestQuantity likelihood{"m-AFC, oddity, ABX, duo-trio log-likelihood", 1e-10};
  SelftestQuantity rates{"ABX and reminder d' of rates", 1e-8};
  for (const json& one : reference_numbers("choice").at("counts")) {
    const json &input = one.at("input"), &reference = one.at("expected");
    const ChoiceTask task = choice_task_from(input.at("task").get<std::string>()).value();
    const ChoiceDprime ours = choice_dprime_of_counts(task, input.at("correct"), input.at("n"));
    dprime.absolute(ours.dprime, reference_number(reference.at("dprime")));
    dprime.absolute(ours.se, reference_number(reference.at("se")));
    likelihood.absolute(ours.log_likelihood, reference_number(reference.at("loglik")));
    interval.absolute(ours.ci_low, reference_number(reference.at("dprime_ci").at(0)));
    interval.absolute(ours.ci_high, reference_number(reference.at("dprime_ci").at(1)));
  }
  for (const json& one : reference_numbers("choice").at("rates")) {
    const json &input = one.at("input"), &reference = one.at("expected");
    const RatesDprime ours =
        dprime_of_rates(rates_task_of(input.at("task")),
                        {input.at("n_signal"), input.at("hits"), input.at("n_noise"), input.at("false_alarms")});
    compare_two_rates(rates, ours.raw, reference.at("raw"));
    compare_two_rates(rates, ours.loglinear, reference.at("loglinear"));
  }
  return {dprime, interval, likelihood, rates};
}

// ---- ratings: answers in ordered categories

struct RatingQuantities {
  SelftestQuantity information{"identification, bits", 1e-12};
  SelftestQuantity adjacent{"identification, adjacent d' and errors", 1e-7};
  SelftestQuantity equal{"rating ROC, equal variances", 1e-7};
  SelftestQuantity unequal{"rating ROC, unequal variances", 1e-6};
  SelftestQuantity trapezoids{"rating ROC, trapezoids and DeLong's error", 1e-12};
  SelftestQuantity sureness_sigma{"sureness, sigma and interval (relative)", 1e-6};
  SelftestQuantity sureness_criteria{"sureness, criteria", 1e-6};
  SelftestQuantity likelihood{"log-likelihood of ordered categories", 1e-8};

  // In the order in which they are printed.
  Quantities all() const {
    return {information, adjacent, equal, unequal, trapezoids, sureness_sigma, sureness_criteria, likelihood};
  }
};

void compare_identification(RatingQuantities& q, const json& input, const json& reference) {
  const Identification ours = identification(input.at("confusion"));
  q.information.absolute(ours.information_bits, reference_number(reference.at("information_bits")));
  q.information.absolute(ours.stimulus_entropy_bits, reference_number(reference.at("stimulus_entropy_bits")));
  q.information.absolute(ours.response_entropy_bits, reference_number(reference.at("response_entropy_bits")));
  q.information.absolute(ours.miller_madow_bits, reference_number(reference.at("miller_madow_bits")));
  q.information.absolute(ours.table_corrected_bits, reference_number(reference.at("table_corrected_bits")));
  q.information.absolute(ours.relative, reference_number(reference.at("relative")));
  const json& ml = reference.at("ml");
  q.likelihood.absolute(ours.ml.log_likelihood, reference_number(ml.at("loglik")));
  for (std::size_t i = 0; i < ml.at("adjacent").size(); ++i) {
    q.adjacent.absolute(ours.adjacent_loglinear.at(i), reference_number(reference.at("adjacent_loglinear").at(i)));
    q.adjacent.absolute(ours.ml.adjacent.at(i).dprime, reference_number(ml.at("adjacent").at(i).at("dprime")));
    q.adjacent.absolute(ours.ml.adjacent.at(i).se, reference_number(ml.at("adjacent").at(i).at("se")));
  }
}

void compare_estimate(SelftestQuantity& quantity, const RatingEstimate& ours, const json& reference,
                      const std::string& key) {
  quantity.absolute(ours.value, reference_number(reference.at(key)));
  quantity.absolute(ours.se, reference_number(reference.at(key + "_se")));
}

void compare_rating(RatingQuantities& q, const json& input, const json& reference) {
  const RatingRoc ours = rating_roc(input.at("noise"), input.at("signal"));
  const json &equal = reference.at("equal_variance"), &unequal = reference.at("unequal_variance");
  q.likelihood.absolute(ours.equal.log_likelihood, reference_number(equal.at("loglik")));
  compare_estimate(q.equal, ours.equal.dprime, equal, "dprime");
  compare_estimate(q.equal, ours.equal.area, equal, "A_z");
  q.likelihood.absolute(ours.unequal.log_likelihood, reference_number(unequal.at("loglik")));
  compare_estimate(q.unequal, ours.unequal.mu, unequal, "mu");
  compare_estimate(q.unequal, ours.unequal.ln_sigma, unequal, "ln_sigma");
  compare_estimate(q.unequal, ours.unequal.zroc_slope, unequal, "zroc_slope");
  compare_estimate(q.unequal, ours.unequal.d_a, unequal, "d_a");
  compare_estimate(q.unequal, ours.unequal.area, unequal, "A_z");
  q.trapezoids.absolute(ours.area_trapezoid.value, reference_number(reference.at("auc_trapezoid")));
  q.trapezoids.absolute(ours.area_trapezoid.se, reference_number(reference.at("auc_delong_se")));
}

void compare_sureness(RatingQuantities& q, const json& input, const json& reference) {
  std::vector<SurenessLevel> levels;
  for (std::size_t i = 0; i < input.at("dK").size(); ++i)
    levels.push_back({input.at("dK").at(i), input.at("counts").at(i)});
  const Sureness ours = sureness(levels);
  q.likelihood.absolute(ours.log_likelihood, reference_number(reference.at("loglik")));
  q.sureness_sigma.relative(ours.sigma, reference_number(reference.at("sigma")));
  q.sureness_sigma.relative(ours.sigma_low, reference_number(reference.at("sigma_ci").at(0)));
  q.sureness_sigma.relative(ours.sigma_high, reference_number(reference.at("sigma_ci").at(1)));
  for (std::size_t j = 0; j < reference.at("criteria").size(); ++j)
    q.sureness_criteria.absolute(ours.criteria.at(j), reference_number(reference.at("criteria").at(j)));
}

Quantities ratings_quantities() {
  RatingQuantities quantities;
  const json& cases = reference_numbers("ratings");
  for (const json& one : cases.at("identification"))
    compare_identification(quantities, one.at("input"), one.at("expected"));
  for (const json& one : cases.at("rating")) compare_rating(quantities, one.at("input"), one.at("expected"));
  for (const json& one : cases.at("sureness")) compare_sureness(quantities, one.at("input"), one.at("expected"));
  return quantities.all();
}

}  // namespace

std::vector<SelftestQuantity> selftest() {
  Quantities all;
  for (const auto part : {detection_quantities, jnd_quantities, group_quantities, psychometric_quantities,
                          adaptive_quantities, scaling_quantities, posterior_quantities, choice_quantities,
                          two_interval_quantities, ratings_quantities, hierarchical_quantities}) {
    const Quantities some = part();
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace jnd
