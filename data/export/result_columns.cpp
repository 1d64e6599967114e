#include "data/export/result_columns.h"

#include <cmath>
#include <utility>

#include "data/export/column_makers.h"
#include "data/export/export_tables.h"
#include "data/export/questionnaire_columns.h"

namespace jnd {

namespace {

// One row for each outcome and each of its pairs.
struct TestRow {
  const OutcomeComparison* outcome;
};
struct PairRow {
  const OutcomeComparison* outcome;
  const PairComparison* pair;
};

Columns<TestRow> test_columns() {
  using R = TestRow;
  const auto effect = [](double WithinEffect::*member) {
    return [member](const R& r) { return r.outcome->comparison.anova.effect.*member; };
  };
  return {
      text<R>("outcome", "what is compared over the conditions", [](const R& r) { return r.outcome->outcome; }),
      text<R>("unit", "unit of the outcome's values", [](const R& r) { return r.outcome->unit; }),
      {"registered", "1 for the registered test", "", "0 1",
       [](const R& r) { return csv_flag(r.outcome->registered); }},
      number<R>("n_used", "complete participants",
                [](const R& r) { return static_cast<std::int64_t>(r.outcome->table.n); }),
      number<R>("n", "participants",
                [](const R& r) { return static_cast<std::int64_t>(r.outcome->table.n + r.outcome->left_out.size()); }),
      number<R>("f", "F of the one-way repeated-measures analysis of variance", effect(&WithinEffect::f)),
      number<R>("df1", "its degrees of freedom", effect(&WithinEffect::df1)),
      number<R>("df2", "of its error", effect(&WithinEffect::df2)),
      number<R>("p", "p assuming sphericity", effect(&WithinEffect::p)),
      number<R>("epsilon_gg", "Greenhouse and Geisser's epsilon", effect(&WithinEffect::epsilon_gg)),
      number<R>("p_gg", "p with that correction", effect(&WithinEffect::p_gg)),
      number<R>("epsilon_hf", "Huynh and Feldt's epsilon, uncapped", effect(&WithinEffect::epsilon_hf)),
      number<R>("p_hf", "p with that correction, capped at 1", effect(&WithinEffect::p_hf)),
      number<R>("eta2_generalised", "generalised eta squared",
                [](const R& r) { return r.outcome->comparison.anova.eta2_generalised; }),
      number<R>("eta2_partial", "partial eta squared", effect(&WithinEffect::eta2_partial)),
      number<R>("mauchly_w", "Mauchly's W", [](const R& r) { return r.outcome->comparison.anova.effect.mauchly.w; }),
      number<R>("mauchly_p", "its p", [](const R& r) { return r.outcome->comparison.anova.effect.mauchly.p; }),
      number<R>("shapiro_w", "Shapiro-Wilk W of the residuals",
                [](const R& r) { return r.outcome->comparison.residuals.w; }),
      number<R>("shapiro_p", "its p", [](const R& r) { return r.outcome->comparison.residuals.p; }),
      number<R>("friedman_chi2", "Friedman's chi-square",
                [](const R& r) { return r.outcome->comparison.friedman.chi2; }),
      number<R>("friedman_p", "its p", [](const R& r) { return r.outcome->comparison.friedman.p; }),
      number<R>("kendall_w", "Kendall's W", [](const R& r) { return r.outcome->comparison.friedman.kendall_w; })};
}

Columns<PairRow> pair_columns(const Protocol& protocol) {
  using R = PairRow;
  return {
      text<R>("outcome", "what is compared", [](const R& r) { return r.outcome->outcome; }),
      text<R>("condition_a", "first condition",
              [&protocol](const R& r) { return protocol.conditions[r.pair->a].name; }),
      text<R>("condition_b", "second condition",
              [&protocol](const R& r) { return protocol.conditions[r.pair->b].name; }),
      number<R>("n", "complete participants", [](const R& r) { return r.pair->t.n; }),
      number<R>("mean_difference", "mean of a - b, in the outcome's unit",
                [](const R& r) { return r.pair->mean_difference; }),
      number<R>("ci95_low", "lower end of its 95 % interval (Student t)", [](const R& r) { return r.pair->t.ci_low; }),
      number<R>("ci95_high", "upper end", [](const R& r) { return r.pair->t.ci_high; }),
      number<R>("t", "paired t", [](const R& r) { return r.pair->t.t; }),
      number<R>("t_df", "its degrees of freedom", [](const R& r) { return r.pair->t.df; }),
      number<R>("t_p", "its two-sided p", [](const R& r) { return r.pair->t.p; }),
      number<R>("t_p_holm", "that p with Holm's correction over the pairs of the outcome",
                [](const R& r) { return r.pair->t_p_holm; }),
      number<R>("dz", "mean difference / SD of the differences", [](const R& r) { return r.pair->t.dz; }),
      number<R>("games_howell_p", "Games-Howell p (ignores the pairing)",
                [](const R& r) { return r.pair->games_howell.p; }),
      number<R>("tukey_p", "Tukey's p (assumes sphericity)", [](const R& r) { return r.pair->tukey.p; }),
      number<R>("wilcoxon_v", "Wilcoxon's V", [](const R& r) { return r.pair->wilcoxon.v; }),
      number<R>("wilcoxon_p", "its p as R computes it", [](const R& r) { return r.pair->wilcoxon.p; }),
      number<R>("wilcoxon_p_exact", "its exact permutation p with midranks",
                [](const R& r) { return r.pair->wilcoxon.p_exact_permutation; }),
      number<R>("wilcoxon_p_holm", "wilcoxon_p with Holm's correction over the pairs of the outcome",
                [](const R& r) { return r.pair->wilcoxon_p_holm; })};
}

// One row a method and condition.
struct MethodRow {
  const SensitivityRow* row;
  std::size_t condition;
};

Columns<MethodRow> sensitivity_columns(const Protocol& protocol) {
  using R = MethodRow;
  Columns<R> columns = {
      text<R>(
          "model", "model of d'", [](const R& r) { return r.row->method.model; },
          "yes-no differencing independent-observation"),
      text<R>(
          "correction", "of rates of 0 and 1; none for maximum likelihood",
          [](const R& r) { return to_string(r.row->method.correction); }, "none loglinear half"),
      text<R>("method", "how the JND comes from the series",
              [](const R& r) { return to_string(r.row->method.method); }),
      {"registered", "1 for the registered method", "", "0 1", [](const R& r) { return csv_flag(r.row->registered); }},
      text<R>("condition", "feedback condition",
              [&protocol](const R& r) { return protocol.conditions[r.condition].name; }),
      number<R>(
          "jnd_median", "median JND; Inf or empty where its status says why",
          [](const R& r) { return r.row->median_jnd[r.condition]; }, std::string(to_string(protocol.stimulus.unit))),
      text<R>(
          "jnd_median_status", kMedianStatus, [](const R& r) { return to_string(r.row->median_status[r.condition]); },
          kJndStatuses),
      number<R>(
          "jnd_mean", "mean JND over status ok", [](const R& r) { return r.row->mean_jnd[r.condition]; },
          std::string(to_string(protocol.stimulus.unit))),
      number<R>("n_ok", "participants with status ok", [](const R& r) { return r.row->n_ok[r.condition]; }),
      number<R>("n_tested", "participants in the tests", [](const R& r) { return r.row->n; }),
      number<R>("omnibus_p", "p of the registered test over all conditions; empty where refused",
                [](const R& r) { return r.row->omnibus_p; }),
      {"same_conclusion", "1 where every registered test decides as under the registered method", "", "0 1",
       [](const R& r) { return csv_flag(r.row->same_conclusion); }}};
  for (std::size_t i = 0; i < protocol.analysis.contrasts.size(); ++i) {
    const Contrast& contrast = protocol.analysis.contrasts[i];
    const std::string name = condition_of(protocol, contrast.a) + "_" + condition_of(protocol, contrast.b);
    columns.push_back(number<R>("p_" + name, "p of the registered contrast, adjusted as registered",
                                [i](const R& r) { return r.row->contrast_p[i]; }));
  }
  return columns;
}

Columns<BehaviourRow> behaviour_columns(const Protocol& protocol) {
  using R = BehaviourRow;
  return {
      text<R>("participant", "code of the participant; empty for all together",
              [](const R& r) { return r.participant; }),
      text<R>("condition", "feedback condition; empty for all together",
              [&protocol](const R& r) { return condition_of(protocol, r.condition); }),
      text<R>("order_status", "whether both orders of different pairs occur",
              [](const R& r) { return to_string(r.order.status); }),
      number<R>("order_difference", "rate of \"different\" with the stiffer stimulus first minus second",
                [](const R& r) { return r.order.difference; }),
      number<R>("order_ci95_low", "lower end of its 95 % interval (Newcombe)",
                [](const R& r) { return r.order.ci_low; }),
      number<R>("order_ci95_high", "upper end", [](const R& r) { return r.order.ci_high; }),
      number<R>("order_p", "Fisher's exact p", [](const R& r) { return r.order.p; }),
      text<R>("bias_status", "whether the criterion is defined", [](const R& r) { return to_string(r.bias.status); }),
      number<R>("criterion", "c over all trials, log-linear rates; positive: tends to say same",
                [](const R& r) { return r.bias.criterion; }),
      number<R>("criterion_ci95_low", "lower end of its 95 % interval", [](const R& r) { return r.bias.ci_low; }),
      number<R>("criterion_ci95_high", "upper end", [](const R& r) { return r.bias.ci_high; }),
      number<R>("said_different", "share of \"different\" answers",
                [](const R& r) { return r.bias.said_different.value; }),
      number<R>("bias_p", "exact binomial p of that share against the planned one",
                [](const R& r) { return r.bias.p; }),
      text<R>("drift_status", "whether both halves have both classes",
              [](const R& r) { return to_string(r.drift.status); }),
      number<R>("drift_dprime", "d' in the second half of each cell's trials minus the first",
                [](const R& r) { return r.drift.dprime.difference; }),
      number<R>("drift_dprime_ci95_low", "lower end of its 95 % interval",
                [](const R& r) { return r.drift.dprime.ci_low; }),
      number<R>("drift_dprime_ci95_high", "upper end", [](const R& r) { return r.drift.dprime.ci_high; }),
      number<R>("drift_dprime_p", "likelihood-ratio p of no change", [](const R& r) { return r.drift.dprime.p; }),
      number<R>("drift_criterion", "criterion in the second half of each cell's trials minus the first",
                [](const R& r) { return r.drift.criterion.difference; }),
      number<R>("drift_criterion_p", "likelihood-ratio p of no change", [](const R& r) { return r.drift.criterion.p; }),
      number<R>("session_drift_dprime",
                "of all together: d' in the second half of the session minus the first, each series against itself",
                [](const R& r) { return r.session_drift ? r.session_drift->difference : std::nan(""); }),
      number<R>("session_drift_dprime_p", "p of no change",
                [](const R& r) { return r.session_drift ? r.session_drift->p : std::nan(""); })};
}

struct RatingRow {
  const PairedItemResult* item;
  const ItemPair* pair;
};

Columns<RatingRow> rating_columns(const Protocol& protocol) {
  using R = RatingRow;
  return {
      text<R>("item", "identifier of the question", [](const R& r) { return r.item->id; }),
      text<R>("condition_a", "first condition",
              [&protocol](const R& r) { return protocol.conditions[r.pair->a].name; }),
      text<R>("condition_b", "second condition",
              [&protocol](const R& r) { return protocol.conditions[r.pair->b].name; }),
      number<R>("n", "participants who answered for both", [](const R& r) { return r.pair->test.n; }),
      number<R>("median_a", "median answer under a", [](const R& r) { return r.item->conditions[r.pair->a].median; }),
      number<R>("median_b", "median answer under b", [](const R& r) { return r.item->conditions[r.pair->b].median; }),
      number<R>("zeros", "equal answers, which the test drops", [](const R& r) { return r.pair->test.zeros; }),
      number<R>("v", "Wilcoxon's V", [](const R& r) { return r.pair->test.v; }),
      number<R>("p", "exact permutation p (normal beyond 200 differences)", [](const R& r) { return r.pair->p; }),
      number<R>("p_holm", "with Holm's correction over all pairs of all items",
                [](const R& r) { return r.pair->p_holm; }),
      number<R>("p_bh", "with Benjamini and Hochberg's", [](const R& r) { return r.pair->p_bh; }),
      number<R>("rank_biserial", "effect size, -1 to 1", [](const R& r) { return r.pair->test.rank_biserial; })};
}

Columns<ThresholdModel> model_columns(const Protocol& protocol) {
  using R = ThresholdModel;
  const std::string unit(to_string(protocol.stimulus.unit));
  return {text<R>("participant", "code of the participant", [](const R& r) { return r.participant; }),
          text<R>("condition", "feedback condition",
                  [&protocol](const R& r) { return condition_of(protocol, r.condition); }),
          text<R>(
              "model", "model of d'", [](const R& r) { return r.method.model; },
              "yes-no differencing independent-observation"),
          text<R>(
              "correction", "of rates of 0 and 1; none for maximum likelihood",
              [](const R& r) { return to_string(r.method.correction); }, "none loglinear half"),
          text<R>("method", "how the JND comes from the series", [](const R& r) { return to_string(r.method.method); }),
          number<R>("slope", "slope of d' on the stiffness difference", [](const R& r) { return r.jnd.slope; }),
          number<R>(
              "jnd", "1 / slope; empty where status says why", [](const R& r) { return r.jnd.jnd; }, unit),
          number<R>(
              "jnd_ci95_low", "lower end of its 95 % interval", [](const R& r) { return r.jnd.ci_low; }, unit),
          number<R>(
              "jnd_ci95_high", "upper end", [](const R& r) { return r.jnd.ci_high; }, unit),
          number<R>("weber", "JND / reference", [](const R& r) { return r.jnd.weber; }),
          text<R>(
              "status", "what the estimate is", [](const R& r) { return to_string(r.jnd.status); }, kJndStatuses),
          number<R>("log_likelihood", "of maximum likelihood, without binomial constants",
                    [](const R& r) { return r.jnd.log_likelihood; }),
          number<R>("deviance", "against a rate for each class of each series",
                    [](const R& r) { return r.quality ? r.quality->deviance : std::nan(""); }),
          number<R>("deviance_p", "its chi-square p",
                    [](const R& r) { return r.quality ? r.quality->deviance_p : std::nan(""); })};
}

Columns<AdaptiveRow> track_columns(const Protocol& protocol) {
  using R = AdaptiveRow;
  const std::string unit(to_string(protocol.stimulus.unit));
  const bool staircase = protocol.design.procedure->kind == AdaptiveProcedure::Kind::staircase;
  return {
      text<R>("participant", "code of the participant", [](const R& r) { return r.participant; }),
      text<R>("condition", "feedback condition",
              [&protocol](const R& r) { return condition_of(protocol, r.condition); }),
      {"track", "track of the condition, from 1; empty for all of them", "", "",
       [](const R& r) { return r.track == 0 ? std::string() : csv_number(r.track); }},
      {"finished", "1 where the stopping rule was met", "", "0 1", [](const R& r) { return csv_flag(r.finished); }},
      number<R>("trials", "answered trials with a difference", [](const R& r) { return r.trials; }),
      number<R>("hits", "of them answered different", [](const R& r) { return r.hits; }),
      number<R>("catch_trials", "answered trials with equal stimuli", [](const R& r) { return r.catch_trials; }),
      number<R>("false_alarms", "of them answered different", [](const R& r) { return r.false_alarms; }),
      number<R>(
          "threshold", "difference at the procedure's target rate", [](const R& r) { return r.threshold.threshold; },
          unit),
      number<R>(
          "sd",
          staircase ? "standard deviation of the averaged reversals" : "standard deviation of the posterior of log10",
          [](const R& r) { return r.threshold.sd; }, staircase ? unit : ""),
      number<R>("n", staircase ? "reversals averaged" : "trials behind the posterior",
                [](const R& r) { return r.threshold.n; }),
      number<R>("weber", "threshold / reference", [](const R& r) { return r.weber; }),
      text<R>(
          "status", "what the threshold is", [](const R& r) { return to_string(r.threshold.status); },
          "ok too_few_reversals no_trials pinned_at_clamp")};
}

}  // namespace

std::vector<ResultFile> result_files(const StudyResults& results, const Protocol& protocol, const StudyModels* models) {
  std::vector<TestRow> tests;
  std::vector<PairRow> pairs;
  for (const OutcomeComparison& outcome : results.comparisons) {
    if (!outcome.refused.empty()) continue;
    tests.push_back({&outcome});
    for (const PairComparison& pair : outcome.comparison.pairs) pairs.push_back({&outcome, &pair});
  }
  std::vector<MethodRow> sensitivity;
  for (const SensitivityRow& row : results.sensitivity)
    for (std::size_t condition = 0; condition < protocol.conditions.size(); ++condition)
      sensitivity.push_back({&row, condition});
  std::vector<BehaviourRow> behaviour = results.behaviour.conditions;
  behaviour.insert(behaviour.end(), results.behaviour.participants.begin(), results.behaviour.participants.end());
  std::vector<RatingRow> ratings;
  for (const PairedItemResult& item : results.ratings.items)
    for (const ItemPair& pair : item.pairs) ratings.push_back({&item, &pair});

  std::vector<ResultFile> files;
  if (results.adaptive) add_file(files, "tracks.csv", track_columns(protocol), results.adaptive->rows);
  add_file(files, "tests.csv", test_columns(), tests);
  add_file(files, "pairs.csv", pair_columns(protocol), pairs);
  add_file(files, "sensitivity.csv", sensitivity_columns(protocol), sensitivity);
  add_file(files, "behaviour.csv", behaviour_columns(protocol), behaviour);
  add_items_file(files, results.items, protocol);
  add_file(files, "ratings.csv", rating_columns(protocol), ratings);
  if (models != nullptr) add_file(files, "models.csv", model_columns(protocol), models->thresholds);
  if (results.questionnaire)
    for (ResultFile& file : questionnaire_files(*results.questionnaire, protocol)) files.push_back(std::move(file));
  return files;
}

void write_results(ExportFolder& files, const StudyResults& results, const Protocol& protocol,
                   const StudyModels* models) {
  const StudyAnalysis& analysis = results.analysis;
  std::vector<ResultFile> all;
  // Those of an adaptive study are empty, and so left out.
  add_file(all, "thresholds.csv", report_columns(protocol), analysis.thresholds);
  add_file(all, "cells.csv", cell_columns(protocol), analysis.cells);
  add_file(all, "group.csv", group_columns(protocol, analysis.kind), analysis.group);
  add_file(all, "contrasts.csv", contrast_columns(protocol, analysis.kind), contrasts_of(results, protocol));
  for (ResultFile& file : result_files(results, protocol, models)) all.push_back(std::move(file));
  std::vector<DictionaryRow> dictionary;
  for (const ResultFile& file : all) {
    files.write(file.name, file.text);
    dictionary.insert(dictionary.end(), file.dictionary.begin(), file.dictionary.end());
  }
  describe("dictionary.csv", dictionary_columns(), dictionary);
  files.write("dictionary.csv", csv_table(dictionary_columns(), dictionary));
}

}  // namespace jnd
