#include "analysis/group/compare.h"

#include <cmath>

#include "analysis/group/p_adjust.h"
#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

// Morey 2008: each participant's mean is taken off, and the variance left is too small by (k - 1)/k.
std::vector<std::vector<double>> without_participants(const std::vector<std::vector<double>>& columns, std::size_t n) {
  std::vector<std::vector<double>> result = columns;
  std::vector<double> row(columns.size());
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = columns[j][i];
    const double mean = moments(row).mean;
    for (std::size_t j = 0; j < row.size(); ++j) result[j][i] = row[j] - mean;
  }
  return result;
}

ConditionSummary summary(const std::vector<double>& values, const std::vector<double>& centred, double k,
                         double t_quantile) {
  ConditionSummary result;
  const Moments of = moments(values);
  result.n = of.n;
  result.mean = of.mean;
  result.sd = of.sd;
  result.median = median_of(values);
  result.shapiro = shapiro_wilk(values);
  result.ci_low = result.ci_high = result.ci_within_low = result.ci_within_high = kNaN;
  if (of.n < 2) {
    result.status = StatisticStatus::too_few;
    return result;
  }
  const double root_n = std::sqrt(static_cast<double>(of.n));
  const double half_width = t_quantile * of.sd / root_n;
  result.ci_low = of.mean - half_width;
  result.ci_high = of.mean + half_width;
  if (k >= 2) {
    const double within = t_quantile * moments(centred).sd * std::sqrt(k / (k - 1)) / root_n;
    result.ci_within_low = of.mean - within;
    result.ci_within_high = of.mean + within;
  }
  return result;
}

// Holm, Benjamini-Hochberg and Bonferroni over the pairs.
void adjust(std::vector<PairComparison>& pairs) {
  std::vector<double> t, wilcoxon;
  for (const PairComparison& pair : pairs) {
    t.push_back(pair.t.p);
    wilcoxon.push_back(pair.wilcoxon.p);
  }
  const std::vector<double> t_holm = holm(t), t_bh = benjamini_hochberg(t), t_bonferroni = bonferroni(t);
  const std::vector<double> wilcoxon_holm = holm(wilcoxon), wilcoxon_bh = benjamini_hochberg(wilcoxon);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].t_p_holm = t_holm[i];
    pairs[i].t_p_bh = t_bh[i];
    pairs[i].t_p_bonferroni = t_bonferroni[i];
    pairs[i].wilcoxon_p_holm = wilcoxon_holm[i];
    pairs[i].wilcoxon_p_bh = wilcoxon_bh[i];
  }
}

Comparison begun(const WithinTable& table) {
  Comparison result;
  result.n = table.n;
  result.k = table.k;
  if (table.n < 2 || table.k < 2) result.status = StatisticStatus::too_few;
  return result;
}

std::vector<std::vector<double>> columns_of(const WithinTable& table) {
  std::vector<std::vector<double>> columns;
  for (std::size_t j = 0; j < table.k; ++j) columns.push_back(table.column(j));
  return columns;
}

// each(a, b): (0,1), (0,2), ..., (1,2), ...
template <typename Each>
void for_pairs(const WithinTable& table, const Each& each) {
  for (std::size_t a = 0; a < table.k; ++a)
    for (std::size_t b = a + 1; b < table.k; ++b) each(a, b);
}

Tukey tukey_of(double mean_difference, const RepeatedMeasures& anova, const WithinTable& table) {
  const double mean_square_error = anova.status == StatisticStatus::ok ? anova.effect.ss_error / anova.effect.df2 : 0.0;
  return tukey(mean_difference, mean_square_error, static_cast<double>(table.n), anova.effect.df2,
               static_cast<int>(table.k));
}

}  // namespace

std::vector<ConditionSummary> summaries_of(const WithinTable& table) {
  const std::vector<std::vector<double>> columns = columns_of(table);
  const double t_quantile = student_t_quantile_two_sided(0.05, static_cast<double>(table.n) - 1);
  const std::vector<std::vector<double>> centred = without_participants(columns, table.n);
  std::vector<ConditionSummary> summaries;
  for (std::size_t j = 0; j < table.k; ++j)
    summaries.push_back(summary(columns[j], centred[j], static_cast<double>(table.k), t_quantile));
  return summaries;
}

Comparison compare(const WithinTable& table) {
  Comparison result = begun(table);
  const std::vector<std::vector<double>> columns = columns_of(table);
  const double t_quantile = student_t_quantile_two_sided(0.05, static_cast<double>(table.n) - 1);
  result.conditions = summaries_of(table);

  result.anova = repeated_measures(table);
  result.residuals = shapiro_wilk(result.anova.residuals);
  // Residuals of pure rounding have some shape, which means nothing.
  if (result.anova.status == StatisticStatus::no_variance) {
    result.residuals.w = result.residuals.p = kNaN;
    result.residuals.status = StatisticStatus::no_variance;
  }
  result.friedman = friedman(table);

  const int groups = static_cast<int>(table.k);
  for_pairs(table, [&](std::size_t a, std::size_t b) {
    PairComparison pair;
    pair.a = a;
    pair.b = b;
    pair.t = paired_t(columns[a], columns[b], t_quantile);
    pair.mean_difference = pair.t.mean_difference;
    pair.games_howell = games_howell(columns[a], columns[b], groups);
    pair.tukey = tukey_of(pair.mean_difference, result.anova, table);
    pair.wilcoxon = signed_rank(columns[a], columns[b]);
    result.pairs.push_back(pair);
  });
  adjust(result.pairs);
  return result;
}

Comparison compare_pairs(const WithinTable& table, PairTest test) {
  Comparison result = begun(table);
  const std::vector<std::vector<double>> columns = columns_of(table);
  if (test == PairTest::tukey) result.anova = repeated_measures(table);
  for_pairs(table, [&](std::size_t a, std::size_t b) {
    PairComparison pair;
    pair.a = a;
    pair.b = b;
    const PairedT t = paired_t(columns[a], columns[b]);
    pair.mean_difference = t.mean_difference;
    switch (test) {
      case PairTest::paired_t:
        pair.t = t;
        break;
      case PairTest::games_howell:
        pair.games_howell = games_howell(columns[a], columns[b], static_cast<int>(table.k));
        break;
      case PairTest::tukey:
        pair.tukey = tukey_of(pair.mean_difference, result.anova, table);
        break;
      case PairTest::wilcoxon:
        pair.wilcoxon = signed_rank(columns[a], columns[b]);
        break;
    }
    result.pairs.push_back(pair);
  });
  return result;
}

}  // namespace jnd
