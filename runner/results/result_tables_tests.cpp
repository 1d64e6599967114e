// Tables of the tests: all conditions together, pairs, condition x series, and the same under other methods.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/words.h"
#include "data/fields/result_fields.h"
#include "runner/results/field_output.h"
#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"

namespace jnd {

namespace {

std::string_view post_hoc_name(PostHoc post_hoc) noexcept {
  constexpr auto kWords = words<PostHoc>({{"paired t, Holm over the contrasts", PostHoc::holm_t},
                                          {"Games-Howell", PostHoc::games_howell},
                                          {"Tukey", PostHoc::tukey},
                                          {"Wilcoxon signed ranks, Holm over the contrasts", PostHoc::wilcoxon}});
  return word_of(kWords, post_hoc);
}

// How the contrasts come about, all of them or the registered ones.
std::string contrasts_note(const Protocol& protocol, bool registered_only) {
  const bool hierarchical = protocol.analysis.hierarchical;
  const std::string tests = hierarchical ? "likelihood ratio in the hierarchical model, Holm over the contrasts"
                                         : std::string(post_hoc_name(protocol.analysis.tests.post_hoc));
  if (registered_only)
    return hierarchical ? fmt::format("ln of the ratio of JNDs with its profile interval; p: {}", tests)
                        : fmt::format("paired differences with Student's interval; p: {}", tests);
  return fmt::format(
      "paired differences with Student's interval{}, each row on one scale; p: {}, on the registered scale (*)",
      hierarchical ? ", of the hierarchical model with its profile interval" : "", tests);
}

std::string contrast_name(const Contrast& contrast, const Protocol& protocol) {
  return condition_text(protocol, contrast.a) + " - " + condition_text(protocol, contrast.b);
}

std::string outcome_name(const OutcomeComparison& outcome) {
  return outcome.outcome + (outcome.registered ? " *" : "");
}

// Of models that work on the raw counts there is no correction.
std::string rates_name(const ThresholdMethod& method) {
  return method.correction == Correction::none ? "raw" : std::string(to_string(method.correction));
}

template <typename Row>
TableColumn<Row> degrees_of_freedom(const TableMaker<Row>& of, const WithinEffect& (*effect)(const Row&)) {
  return of.words(
      "df", [effect](const Row& row) { return fmt::format("{:g}, {:g}", effect(row).df1, effect(row).df2); }, true);
}

}  // namespace

ResultTable contrasts_table(const StudyResults& results, const Protocol& protocol, ContrastScales scales) {
  ResultTable table{"contrasts", "Registered contrasts", "", {}, {}, {}};
  std::vector<ContrastRow> rows = contrasts_of(results, protocol);
  const bool registered_only = scales == ContrastScales::registered;
  if (registered_only) std::erase_if(rows, [](const ContrastRow& row) { return !row.registered; });
  if (rows.empty()) return table;
  const OutcomeComparison& tested = results.comparisons.front();
  const auto* constant = std::get_if<ConstantResults>(&results.measured);
  table.note = contrasts_note(protocol, registered_only);
  if (registered_only) table.title += ": " + contrast_scale(rows.front(), tested, protocol).name;
  const TableMaker of(contrast_fields(protocol, attendance_of(results).kind));
  using Row = ContrastRow;
  const auto mean = [&](const Row& row) {
    const ContrastScale scale = contrast_scale(row, tested, protocol);
    return number_text(scale.factor * row.difference.mean, scale.decimals);
  };
  const auto interval = [&](const Row& row) {
    const ContrastScale scale = contrast_scale(row, tested, protocol);
    return range_text(scale.factor * row.difference.ci_low, scale.factor * row.difference.ci_high, scale.decimals);
  };
  const auto p = [&](const Row& row) { return row.registered ? of.text("p", row) : ""; };
  const std::string& refused = protocol.analysis.hierarchical ? rows.front().refused : tested.refused;
  const bool alike = std::all_of(rows.begin(), rows.end(), [&](const Row& row) {
    return !protocol.analysis.hierarchical || !row.registered || row.refused == refused;
  });
  const auto cautions = [&](const Row& row) {
    return joined(constant == nullptr ? "" : source_caution(row.difference_source, constant->analysis),
                  row.refused.empty() ? ""
                  : alike             ? "refused"
                                      : row.refused);
  };
  std::vector<TableColumn<Row>> columns = {of.words("contrast", [&](const Row& row) {
    return contrast_name({row.a, row.b}, protocol);
  })};
  if (!registered_only)
    columns.push_back(of.words("scale", [&](const Row& row) {
      return contrast_scale(row, tested, protocol).name + (row.registered ? " *" : "");
    }));
  columns.insert(columns.end(),
                 {of.share("difference.n", "participants", "n"),
                  of.words(protocol.analysis.hierarchical ? "difference" : "mean difference", mean, true),
                  of.words("95 % CI", interval, true), of.words("p", p, true), of.words("cautions", cautions)});
  table = of(std::move(table), columns, rows);
  if (alike && !refused.empty()) table.footnotes.push_back("no tests: " + refused);
  if (std::all_of(table.rows.begin(), table.rows.end(), [](const auto& row) { return row.back().empty(); })) {
    table.columns.pop_back();
    for (auto& row : table.rows) row.pop_back();
  }
  return table;
}

ResultTable omnibus_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"tests", "Conditions compared", "", {}, {}, {}};
  if (protocol.conditions.size() < 2) return table;
  table.note =
      "one-way repeated measures; p(GG): Greenhouse-Geisser; eta2: generalised, partial; Friedman by ranks; * "
      "registered";
  std::vector<TestRow> rows;
  for (const OutcomeComparison& outcome : results.comparisons) {
    if (outcome.refused.empty())
      rows.push_back({&outcome});
    else
      table.footnotes.push_back(fmt::format("{}: no test: {}", outcome.outcome, outcome.refused));
  }
  const TableMaker of(test_fields());
  const auto effect = [](const TestRow& row) -> const WithinEffect& { return row.outcome->comparison.anova.effect; };
  return of(
      std::move(table),
      {of.words("outcome", [](const TestRow& row) { return outcome_name(*row.outcome); }), of.share("n_used", "n", "n"),
       of("f"), degrees_of_freedom<TestRow>(of, effect), of("p"), of("p_gg"), of("eta2_generalised"),
       of("eta2_partial"), of("mauchly_p"), of("shapiro_p"), of("friedman_chi2"), of("friedman_p"), of("kendall_w")},
      rows);
}

ResultTable pairs_table(const StudyResults& results, const Protocol& protocol) {
  std::vector<PairRow> rows;
  for (const OutcomeComparison& outcome : results.comparisons)
    if (outcome.refused.empty())
      for (const PairComparison& pair : outcome.comparison.pairs) rows.push_back({&outcome, &pair});
  const TableMaker of(pair_fields(protocol));
  return of(
      {"pairs",
       "Pairs of conditions",
       "Holm over the pairs of an outcome; Games-Howell and Tukey ignore the pairing; dz: mean difference / SD "
       "of the differences",
       {},
       {},
       {}},
      {of.words("outcome", [](const PairRow& row) { return outcome_name(*row.outcome); }),
       of.words("pair",
                [&](const PairRow& row) { return of.text("condition_a", row) + " - " + of.text("condition_b", row); }),
       of("n"), of("mean_difference"), of.range("ci95_low", "ci95_high"), of("t"), of("t_p"), of("t_p_holm"), of("dz"),
       of("games_howell_p"), of("tukey_p"), of("wilcoxon_v"), of("wilcoxon_p"), of("wilcoxon_p_holm"),
       of("wilcoxon_p_exact")},
      rows);
}

ResultTable series_table(const ConstantResults& results, const Protocol& protocol) {
  ResultTable table{"series", "Condition x series", "", {}, {}, {}};
  const SeriesComparison& series = results.by_series;
  if (protocol.conditions.size() < 2 || protocol.series.size() < 2) return table;
  table.note = fmt::format(
      "yes-no d' of {} rates, both factors within participants; does the effect of a condition depend on the "
      "series?",
      protocol.analysis.correction);
  std::vector<EffectRow> rows;
  if (series.refused.empty())
    rows = {{"condition", &series.test.a, &series},
            {"series", &series.test.b, &series},
            {"condition x series", &series.test.ab, &series}};
  const TableMaker of(effect_fields());
  const auto effect = [](const EffectRow& row) -> const WithinEffect& { return row.effect->effect; };
  return of(std::move(table),
            {of("effect"), of.share("n_used", "n", "n"), of("f"), degrees_of_freedom<EffectRow>(of, effect), of("p"),
             of("p_gg"), of("eta2_generalised"), of("eta2_partial")},
            rows);
}

ResultTable sensitivity_table(const ConstantResults& results, const Protocol& protocol) {
  using Row = MethodRow;
  const TableMaker of(sensitivity_fields(protocol));
  const auto number = [&results](const Row& row) { return std::to_string(row.row - results.sensitivity.data() + 1); };
  std::vector<TableColumn<Row>> columns = {
      of.words("no.", number), of("model"),
      of.words("rates", [](const Row& row) { return rates_name(row.row->method); }), of("method")};
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
    columns.push_back(of.words(
        protocol.conditions[i].name,
        [&protocol, i](const Row& row) {
          return median_text(row.row->median_status[i], row.row->median_jnd[i], protocol);
        },
        true));
  columns.push_back(of.share("n", "participants", "n"));
  columns.push_back(of("omnibus_p"));
  for (const Contrast& contrast : protocol.analysis.contrasts)
    columns.push_back(of("p_" + condition_text(protocol, contrast.a) + "_" + condition_text(protocol, contrast.b)));
  columns.push_back(of.words("conclusion", [](const Row& row) {
    return row.row->registered         ? "registered"
           : !row.row->refused.empty() ? "no test"
           : row.row->same_conclusion  ? "the same"
                                       : "DIFFERENT";
  }));
  std::vector<Row> rows;
  for (const SensitivityRow& row : results.sensitivity) rows.push_back({&row, 0});
  return of(
      {"sensitivity",
       "Would another method change the conclusion?",
       fmt::format("median JND in {} (no sensitivity counts as infinite; ceiling: below what was tested); tests on the "
                   "{} as registered, alpha = "
                   "{:g}; models measure d' differently: JNDs of different models are not comparable{}",
                   unit_of(protocol), to_string(protocol.analysis.tests.outcome), protocol.analysis.tests.alpha,
                   protocol.analysis.hierarchical
                       ? "; the contrasts are registered by the hierarchical model, and stand here by separate values"
                       : ""),
       {},
       {},
       {}},
      columns, rows);
}

ResultTable models_table(const StudyModels& models, const Protocol& protocol) {
  const TableMaker of(model_fields(protocol));
  const bool few = std::any_of(models.thresholds.begin(), models.thresholds.end(), [](const ThresholdModel& one) {
    return one.quality && one.quality->status == FitStatus::few_trials;
  });
  return of({"models",
             "Every model",
             fmt::format("slope per {} {}; JND in {}; 95 % CI of the same method; deviance p against a rate for each "
                         "class and series",
                         slope_step(protocol), unit_of(protocol), unit_of(protocol)),
             {},
             {},
             few ? std::vector<std::string>{"deviance p is empty where too few trials per class and series leave "
                                            "chi-square without meaning; jnd calc jnd --bootstrap draws one"}
                 : std::vector<std::string>()},
            {of("participant"), of("condition"), of("model"),
             of.words("rates", [](const ThresholdModel& row) { return rates_name(row.method); }), of("method"),
             of("slope"), of("jnd"), of.range("ci_low", "ci_high"), of("weber"), of("fit.p"), of("status")},
            models.thresholds);
}

}  // namespace jnd
