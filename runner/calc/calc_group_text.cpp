#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/calc/calc_group.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Align = TextTable::Align;

std::string interval_text(double low, double high) {
  return std::isnan(low) ? "-" : fmt::format("{} .. {}", statistic_text(low), statistic_text(high));
}

std::string conditions_text(const NamedComparison& named) {
  TextTable table({"condition", "n", "mean", "SD", "median", "95 % CI", "within-subject CI", "Shapiro W", "p"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right});
  for (std::size_t j = 0; j < named.conditions.size(); ++j) {
    const ConditionSummary& of = named.comparison.conditions[j];
    table.add({printable(named.conditions[j]), std::to_string(of.n), statistic_text(of.mean), statistic_text(of.sd),
               statistic_text(of.median), interval_text(of.ci_low, of.ci_high),
               interval_text(of.ci_within_low, of.ci_within_high), statistic_text(of.shapiro.w),
               p_value_text(of.shapiro.p)});
  }
  return table.text();
}

std::string df_text(double df1, double df2) {
  return std::isnan(df2) ? "-" : fmt::format("{}, {}", statistic_text(df1), statistic_text(df2));
}

std::string overall_text(const Comparison& comparison) {
  const RepeatedMeasures& anova = comparison.anova;
  const WithinEffect& effect = anova.effect;
  TextTable table({"all conditions", "statistic", "df", "p"}, {Align::left, Align::left, Align::right, Align::right});
  const auto corrected = [&](const char* name, double epsilon, double p) {
    const double used = std::min(1.0, epsilon);
    table.add({name, std::isnan(epsilon) ? "-" : "epsilon = " + statistic_text(epsilon),
               std::isnan(epsilon) ? "-" : df_text(used * effect.df1, used * effect.df2), p_value_text(p)});
  };
  table.add({"repeated-measures ANOVA", "F = " + statistic_text(effect.f), df_text(effect.df1, effect.df2),
             p_value_text(effect.p)});
  corrected("  Greenhouse-Geisser", effect.epsilon_gg, effect.p_gg);
  corrected("  Huynh-Feldt", effect.epsilon_hf, effect.p_hf);
  table.add({"  sphericity (Mauchly)", "W = " + statistic_text(effect.mauchly.w), "", p_value_text(effect.mauchly.p)});
  table.add({"  normal residuals (Shapiro-Wilk)", "W = " + statistic_text(comparison.residuals.w), "",
             p_value_text(comparison.residuals.p)});
  table.add({"Hotelling's T2 (needs no sphericity)", "F = " + statistic_text(effect.hotelling_f),
             df_text(effect.hotelling_df1, effect.hotelling_df2), p_value_text(effect.hotelling_p)});
  table.add({"Friedman", "chi2 = " + statistic_text(comparison.friedman.chi2), std::to_string(comparison.friedman.df),
             p_value_text(comparison.friedman.p)});
  return table.text() + fmt::format("  eta squared: generalised {}, partial {}; Kendall's W {}\n",
                                    statistic_text(anova.eta2_generalised), statistic_text(effect.eta2_partial),
                                    statistic_text(comparison.friedman.kendall_w));
}

std::string pair_name(const NamedComparison& named, const PairComparison& pair) {
  return printable(named.conditions[pair.a]) + " - " + printable(named.conditions[pair.b]);
}

std::string paired_text(const NamedComparison& named) {
  TextTable table({"pair", "difference", "95 % CI", "t", "df", "p", "p Holm", "dz", "Wilcoxon V", "p", "p Holm"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right, Align::right, Align::right});
  for (const PairComparison& pair : named.comparison.pairs)
    table.add({pair_name(named, pair), statistic_text(pair.mean_difference),
               interval_text(pair.t.ci_low, pair.t.ci_high), statistic_text(pair.t.t), statistic_text(pair.t.df),
               p_value_text(pair.t.p), p_value_text(pair.t_p_holm), statistic_text(pair.t.dz),
               statistic_text(pair.wilcoxon.v), p_value_text(pair.wilcoxon.p), p_value_text(pair.wilcoxon_p_holm)});
  return table.text();
}

std::string unpaired_text(const NamedComparison& named) {
  TextTable table({"pair", "Games-Howell q", "df", "p", "Tukey q", "p"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right});
  for (const PairComparison& pair : named.comparison.pairs)
    table.add({pair_name(named, pair), statistic_text(pair.games_howell.q), statistic_text(pair.games_howell.df),
               p_value_text(pair.games_howell.p), statistic_text(pair.tukey.q), p_value_text(pair.tukey.p)});
  return table.text();
}

std::string remarks_text(const Comparison& comparison) {
  std::string text;
  const RepeatedMeasures& anova = comparison.anova;
  if (anova.status == TestStatus::too_few)
    text += warn("One participant: nothing can be tested.") + "\n";
  else if (anova.status == TestStatus::no_variance)
    text += warn("The participants differ alike in every condition: F, Tukey and the epsilons are undefined.") + "\n";
  switch (anova.effect.mauchly.status) {
    case TestStatus::not_applicable:
      text += "Two conditions: the question of sphericity does not arise.\n";
      break;
    case TestStatus::singular:
      text += "The covariance is singular (a condition follows from the others): no Mauchly and no Hotelling test.\n";
      break;
    case TestStatus::too_few:
      if (anova.status == TestStatus::ok)
        text += "Fewer participants than conditions: no Mauchly and no Hotelling test.\n";
      break;
    default:
      break;
  }
  for (const PairComparison& pair : comparison.pairs) {
    if (pair.t.status != TestStatus::no_variance) continue;
    text += "A pair of which all differences are equal has no t test.\n";
    break;
  }
  return text;
}

}  // namespace

std::string statistic_text(double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const double size = std::abs(value);
  return size >= 1000 && size < 1e7 ? fmt::format("{:.1f}", value) : fmt::format("{:.4g}", value);
}

std::string comparison_text(const NamedComparison& named) {
  const Comparison& comparison = named.comparison;
  std::string text =
      bold(fmt::format("{} participant{}, {} conditions", comparison.n, comparison.n == 1 ? "" : "s", comparison.k)) +
      "\n\n";
  text += conditions_text(named) + "\n" + overall_text(comparison) + "\n";
  text += paired_text(named) + "\n" + unpaired_text(named);
  text += dim("  Games-Howell takes the conditions for separate groups, Tukey pools the error of all pairs: both "
              "ignore the "
              "pairing. Prefer the paired tests.") +
          "\n";
  const std::string remarks = remarks_text(comparison);
  if (!remarks.empty()) text += "\n" + remarks;
  return text;
}

std::string wilcoxon_text(const std::vector<WilcoxonRow>& rows) {
  TextTable table({"item", "n", "zeros", "ties", "V", "p", "method", "p exact", "rank-biserial", "p Holm", "p BH"},
                  {Align::left, Align::right, Align::right, Align::left, Align::right, Align::right, Align::left,
                   Align::right, Align::right, Align::right, Align::right});
  bool approximate = false;
  std::size_t tested = 0;
  for (const WilcoxonRow& row : rows) {
    const SignedRank& test = row.test;
    approximate = approximate || (test.status == TestStatus::ok && !test.exact);
    tested += test.status == TestStatus::ok ? 1 : 0;
    table.add({row.item.empty() ? "-" : printable(row.item), std::to_string(test.n), std::to_string(test.zeros),
               test.ties ? "yes" : "no", statistic_text(test.v), p_value_text(test.p),
               test.status != TestStatus::ok ? "-"
               : test.exact                  ? "exact"
                                             : "normal",
               p_value_text(test.p_exact_permutation), statistic_text(test.rank_biserial), p_value_text(row.p_holm),
               p_value_text(row.p_bh)});
  }
  std::string text = table.text();
  if (tested > 1) text += dim(fmt::format("  Holm and Benjamini-Hochberg over {} items, from p.", tested)) + "\n";
  if (approximate)
    text += dim("  normal: ties, zeros or 50 and more differences; p exact is the permutation p with midranks.") + "\n";
  if (tested < rows.size())
    text += "Without a difference there is nothing to test, and the item does not count in the corrections.\n";
  return text;
}

}  // namespace jnd
