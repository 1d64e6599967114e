// Tables of the tests: all conditions together, pairs, condition x series, and the same under other methods.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"

namespace jnd {

namespace {

std::string_view post_hoc_name(PostHoc post_hoc) noexcept {
  switch (post_hoc) {
    case PostHoc::holm_t:
      return "paired t, Holm over the contrasts";
    case PostHoc::games_howell:
      return "Games-Howell";
    case PostHoc::tukey:
      return "Tukey";
    case PostHoc::wilcoxon:
      return "Wilcoxon signed ranks, Holm over the contrasts";
  }
  return "";
}

std::string contrast_name(const Contrast& contrast, const Protocol& protocol) {
  return condition_text(protocol, contrast.a) + " - " + condition_text(protocol, contrast.b);
}

std::string statistic(double value) {
  return number_text(value, 3);
}

std::string used(const OutcomeComparison& outcome) {
  const auto all = outcome.table.n + outcome.left_out.size();
  return fmt::format("{} of {}", outcome.table.n, all);
}

// Differences in digits that fit their size: slopes are thousandths.
std::string compact(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : number_text(value, 0);
}

std::string compact_range(double low, double high) {
  return std::isnan(low) || std::isnan(high) ? "-" : compact(low) + " .. " + compact(high);
}

std::string outcome_name(const OutcomeComparison& outcome) {
  return outcome.outcome + (outcome.registered ? " *" : "");
}

// How people read the numbers of a contrast's scale.
struct ScaleText {
  std::string name;
  double factor = 1;
  int decimals = 3;
};

ScaleText scale_text(const ContrastRow& row, const Protocol& protocol) {
  ScaleText text;
  text.name = row.outcome;
  if (row.outcome == to_string(Outcome::slope)) {
    text.factor = slope_step(protocol);
    text.name = fmt::format("d' per {} {}", slope_step(protocol), unit_of(protocol));
  } else if (row.outcome == to_string(Outcome::log_jnd)) {
    text.name = "ln JND";
  } else {
    text.name = fmt::format("{} {}", row.outcome == to_string(Outcome::jnd) ? "JND" : row.outcome, unit_of(protocol));
    text.decimals = stiffness_decimals(protocol);
  }
  if (row.registered) text.name += " *";
  return text;
}

}  // namespace

ResultTable contrasts_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"contrasts", "Registered contrasts", "", {}, {}, {}};
  const std::vector<ContrastRow> rows = contrasts_of(results, protocol);
  if (rows.empty()) return table;
  const OutcomeComparison& tested = results.comparisons.front();
  table.note = fmt::format(
      "paired differences with Student's interval, each row on one scale; p: {}, on the registered scale (*)",
      post_hoc_name(protocol.analysis.tests.post_hoc));
  table.columns = {{"contrast"},      {"scale"},   {"n", true}, {"mean difference", true},
                   {"95 % CI", true}, {"p", true}, {"remarks"}};
  for (const ContrastRow& row : rows) {
    const ScaleText scale = scale_text(row, protocol);
    table.rows.push_back(
        {contrast_name({row.a, row.b}, protocol), scale.name,
         fmt::format("{} of {}", row.difference.n, row.participants),
         number_text(scale.factor * row.difference.mean, scale.decimals),
         range_text(scale.factor * row.difference.ci_low, scale.factor * row.difference.ci_high, scale.decimals),
         row.registered ? p_value_text(row.p) : "",
         joined(source_remark(row.difference_source, results.analysis), row.refused.empty() ? "" : "refused")});
  }
  if (!tested.refused.empty()) table.remarks.push_back("no tests: " + tested.refused);
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
  table.columns = {{"outcome"},
                   {"n", true},
                   {"F", true},
                   {"df", true},
                   {"p", true},
                   {"p(GG)", true},
                   {"eta2 g", true},
                   {"eta2 p", true},
                   {"Mauchly p", true},
                   {"Shapiro p", true},
                   {"Friedman chi2", true},
                   {"p", true},
                   {"Kendall W", true}};
  for (const OutcomeComparison& outcome : results.comparisons) {
    if (!outcome.refused.empty()) {
      table.remarks.push_back(fmt::format("{}: no test: {}", outcome.outcome, outcome.refused));
      continue;
    }
    const Comparison& c = outcome.comparison;
    const WithinEffect& e = c.anova.effect;
    table.rows.push_back({outcome_name(outcome), used(outcome), statistic(e.f), fmt::format("{:g}, {:g}", e.df1, e.df2),
                          p_value_text(e.p), p_value_text(e.p_gg), statistic(c.anova.eta2_generalised),
                          statistic(e.eta2_partial), p_value_text(e.mauchly.p), p_value_text(c.residuals.p),
                          statistic(c.friedman.chi2), p_value_text(c.friedman.p), statistic(c.friedman.kendall_w)});
  }
  return table;
}

ResultTable pairs_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{
      "pairs",
      "Pairs of conditions",
      "Holm over the pairs of an outcome; Games-Howell and Tukey ignore the pairing; dz: mean difference / SD "
      "of the differences",
      {},
      {},
      {}};
  table.columns = {{"outcome"},        {"pair"},
                   {"n", true},        {"difference", true},
                   {"95 % CI", true},  {"t", true},
                   {"p", true},        {"p(Holm)", true},
                   {"dz", true},       {"Games-Howell p", true},
                   {"Tukey p", true},  {"Wilcoxon V", true},
                   {"p(exact)", true}, {"p(Holm)", true}};
  for (const OutcomeComparison& outcome : results.comparisons) {
    if (!outcome.refused.empty()) continue;
    for (const PairComparison& pair : outcome.comparison.pairs)
      table.rows.push_back(
          {outcome_name(outcome), protocol.conditions[pair.a].name + " - " + protocol.conditions[pair.b].name,
           std::to_string(outcome.table.n), compact(pair.mean_difference), compact_range(pair.t.ci_low, pair.t.ci_high),
           statistic(pair.t.t), p_value_text(pair.t.p), p_value_text(pair.t_p_holm), number_text(pair.t.dz, 2),
           p_value_text(pair.games_howell.p), p_value_text(pair.tukey.p), number_text(pair.wilcoxon.v, 1),
           p_value_text(pair.wilcoxon.p_exact_permutation), p_value_text(pair.wilcoxon_p_holm)});
  }
  return table;
}

ResultTable series_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"series", "Condition x series", "", {}, {}, {}};
  const SeriesComparison& series = results.by_series;
  if (protocol.conditions.size() < 2 || protocol.series.size() < 2) return table;
  table.note = fmt::format(
      "yes-no d' of {} rates, both factors within participants; does the effect of a condition depend on the "
      "series?",
      protocol.analysis.correction);
  table.columns = {{"effect"},  {"n", true},     {"F", true},      {"df", true},
                   {"p", true}, {"p(GG)", true}, {"eta2 g", true}, {"eta2 p", true}};
  if (!series.refused.empty()) return table;
  const auto add = [&](const char* name, const TwoWayEffect& effect) {
    const WithinEffect& e = effect.effect;
    table.rows.push_back({name, fmt::format("{} of {}", series.n, series.n + static_cast<int>(series.left_out.size())),
                          statistic(e.f), fmt::format("{:g}, {:g}", e.df1, e.df2), p_value_text(e.p),
                          p_value_text(e.p_gg), statistic(effect.eta2_generalised), statistic(e.eta2_partial)});
  };
  add("condition", series.test.a);
  add("series", series.test.b);
  add("condition x series", series.test.ab);
  return table;
}

ResultTable sensitivity_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{
      "sensitivity",
      "Would another method change the conclusion?",
      fmt::format("median JND in {} (no sensitivity counts as infinite; ceiling: below what was tested); tests on the "
                  "{} as registered, alpha = "
                  "{:g}; models measure d' differently: JNDs of different models are not comparable",
                  unit_of(protocol), to_string(protocol.analysis.tests.outcome), protocol.analysis.tests.alpha),
      {},
      {},
      {}};
  table.columns = {{"model"}, {"rates"}, {"method"}};
  for (const Condition& condition : protocol.conditions) table.columns.push_back({condition.name, true});
  table.columns.push_back({"n", true});
  table.columns.push_back({"omnibus p", true});
  for (const Contrast& contrast : protocol.analysis.contrasts)
    table.columns.push_back({"p " + contrast_name(contrast, protocol), true});
  table.columns.push_back({"conclusion"});
  for (const SensitivityRow& row : results.sensitivity) {
    std::vector<std::string> cells = {
        row.method.model,
        row.method.correction == Correction::none ? "raw" : std::string(to_string(row.method.correction)),
        std::string(to_string(row.method.method))};
    for (std::size_t i = 0; i < row.median_jnd.size(); ++i)
      cells.push_back(median_text(row.median_status[i], row.median_jnd[i], protocol));
    cells.push_back(fmt::format("{} of {}", row.n, row.participants));
    cells.push_back(p_value_text(row.omnibus_p));
    for (const double p : row.contrast_p) cells.push_back(p_value_text(p));
    cells.emplace_back(row.registered         ? "registered"
                       : !row.refused.empty() ? "no test"
                       : row.same_conclusion  ? "the same"
                                              : "DIFFERENT");
    table.rows.push_back(std::move(cells));
  }
  return table;
}

ResultTable models_table(const StudyModels& models, const Protocol& protocol) {
  ResultTable table{
      "models",
      "Every model",
      fmt::format("slope per {} {}; JND in {}; 95 % CI of the same method; deviance p against a rate for each "
                  "class and series",
                  slope_step(protocol), unit_of(protocol), unit_of(protocol)),
      {},
      {},
      {}};
  table.columns = {{"participant"}, {"condition"},        {"model"},     {"rates"},
                   {"method"},      {"slope", true},      {"JND", true}, {"95 % CI", true},
                   {"Weber", true}, {"deviance p", true}, {"status"}};
  for (const ThresholdModel& row : models.thresholds)
    table.rows.push_back(
        {row.participant, condition_text(protocol, row.condition), row.method.model,
         row.method.correction == Correction::none ? "raw" : std::string(to_string(row.method.correction)),
         std::string(to_string(row.method.method)), number_text(slope_step(protocol) * row.jnd.slope, 3),
         stiffness_text(row.jnd.jnd, protocol),
         range_text(row.jnd.ci_low, row.jnd.ci_high, stiffness_decimals(protocol)), percent_text(row.jnd.weber),
         row.quality ? p_value_text(row.quality->deviance_p) : "", std::string(to_string(row.jnd.status))});
  return table;
}

}  // namespace jnd
