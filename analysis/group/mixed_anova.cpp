#include "analysis/group/mixed_anova.h"

#include <algorithm>
#include <cmath>

#include "analysis/group/repeated_measures.h"
#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

double square(double x) {
  return x * x;
}

MixedEffect undefined_effect(StatisticStatus status) {
  MixedEffect effect;
  effect.ss = effect.ss_error = effect.f = effect.p = effect.p_gg = effect.p_hf = kNaN;
  effect.eta2_partial = effect.eta2_generalised = kNaN;
  effect.status = status;
  return effect;
}

// The F test of an effect, where its degrees of freedom and its error carry one.
MixedEffect tested(double ss, double df1, double ss_error, double df2, double scale) {
  MixedEffect effect = undefined_effect(StatisticStatus::ok);
  effect.ss = ss;
  effect.ss_error = ss_error;
  effect.df1 = df1;
  effect.df2 = df2;
  if (!(df1 > 0) || !(df2 > 0)) {
    effect.status = StatisticStatus::too_few;
    return effect;
  }
  if (only_rounding(std::sqrt(ss_error / df2), scale)) {
    effect.status = StatisticStatus::no_variance;
    return effect;
  }
  effect.f = ss / df1 / (ss_error / df2);
  effect.p = f_upper(effect.f, df1, df2);
  effect.eta2_partial = ss / (ss + ss_error);
  return effect;
}

// Means of a table whose values have been shifted towards 0.
struct MixedMeans {
  std::vector<double> participants;        // over conditions
  std::vector<double> groups;              // over participants and conditions
  std::vector<double> conditions;          // over participants, each weighing the same
  std::vector<std::vector<double>> cells;  // [group][condition]
  double grand = 0;
};

MixedMeans means_of(const GroupedTable& table) {
  const WithinTable& x = table.values;
  MixedMeans means;
  for (std::size_t i = 0; i < x.n; ++i) means.participants.push_back(moments(x.row(i)).mean);
  for (std::size_t j = 0; j < x.k; ++j) means.conditions.push_back(moments(x.column(j)).mean);
  for (std::size_t g = 0; g < table.groups; ++g) {
    std::vector<double> cells;
    for (std::size_t j = 0; j < x.k; ++j) cells.push_back(moments(table.cell(g, j)).mean);
    means.groups.push_back(moments(cells).mean);
    means.cells.push_back(std::move(cells));
  }
  means.grand = moments(means.participants).mean;
  return means;
}

struct MixedSquares {
  double group = 0, participants = 0, condition = 0, interaction = 0, error = 0;
};

MixedSquares squares_of_table(const GroupedTable& table, const MixedMeans& means) {
  const WithinTable& x = table.values;
  const auto k = static_cast<double>(x.k);
  MixedSquares ss;
  for (std::size_t i = 0; i < x.n; ++i) {
    const std::size_t g = table.group[i];
    ss.group += k * square(means.groups[g] - means.grand);
    ss.participants += k * square(means.participants[i] - means.groups[g]);
    for (std::size_t j = 0; j < x.k; ++j) {
      const double profile = means.cells[g][j] - means.groups[g];  // of the group over the conditions
      const double common = means.conditions[j] - means.grand;
      ss.condition += square(common);
      ss.interaction += square(profile - common);
      ss.error += square(x.at(i, j) - means.participants[i] - profile);
    }
  }
  return ss;
}

// Greenhouse-Geisser's epsilon of the pooled covariance of the groups; NaN where there is none.
double pooled_epsilon(const GroupedTable& table, const MixedMeans& means, double df) {
  const WithinTable& x = table.values;
  const std::size_t contrasts = x.k - 1;
  if (contrasts == 1) return 1;
  const std::vector<double> helmert = helmert_contrasts(x.k);
  std::vector<double> covariance(contrasts * contrasts, 0.0), score(contrasts);
  for (std::size_t i = 0; i < x.n; ++i) {
    for (std::size_t c = 0; c < contrasts; ++c) {
      score[c] = 0;
      for (std::size_t j = 0; j < x.k; ++j)
        score[c] += helmert[c * x.k + j] * (x.at(i, j) - means.cells[table.group[i]][j]);
    }
    for (std::size_t a = 0; a < contrasts; ++a)
      for (std::size_t b = 0; b < contrasts; ++b) covariance[a * contrasts + b] += score[a] * score[b] / df;
  }
  double trace = 0, squares = 0;
  for (std::size_t a = 0; a < contrasts; ++a) trace += covariance[a * contrasts + a];
  for (const double value : covariance) squares += value * value;
  return trace * trace / (static_cast<double>(contrasts) * squares);
}

void correct_for_sphericity(MixedEffect& effect, double gg, double hf) {
  if (effect.status != StatisticStatus::ok) return;
  const auto corrected = [&](double epsilon) {
    return std::isnan(epsilon) ? kNaN : f_upper(effect.f, epsilon * effect.df1, epsilon * effect.df2);
  };
  effect.p_gg = corrected(gg);
  effect.p_hf = corrected(std::isnan(hf) ? kNaN : std::min(1.0, hf));
}

}  // namespace

std::vector<double> GroupedTable::cell(std::size_t of_group, std::size_t condition) const {
  std::vector<double> found;
  for (std::size_t i = 0; i < values.n; ++i)
    if (group[i] == of_group) found.push_back(values.at(i, condition));
  return found;
}

MixedAnova mixed_anova(const GroupedTable& given) {
  MixedAnova result;
  result.epsilon_gg = result.epsilon_hf = kNaN;
  result.group = result.condition = result.interaction = undefined_effect(StatisticStatus::too_few);
  result.sizes.assign(given.groups, 0);
  for (const std::size_t group : given.group) ++result.sizes[group];
  const auto empty = std::count(result.sizes.begin(), result.sizes.end(), 0);
  if (given.groups < 2 || empty > 0 || given.values.k < 1) {
    result.status = StatisticStatus::too_few;
    return result;
  }
  result.unequal = *std::min_element(result.sizes.begin(), result.sizes.end()) !=
                   *std::max_element(result.sizes.begin(), result.sizes.end());
  GroupedTable table = given;
  const double scale = largest_magnitude(given.values.values);
  for (double& value : table.values.values) value -= given.values.values.front();
  const MixedMeans means = means_of(table);
  const MixedSquares ss = squares_of_table(table, means);
  const double groups = static_cast<double>(table.groups) - 1;
  const double within_groups = static_cast<double>(table.values.n - table.groups);
  result.group = tested(ss.group, groups, ss.participants, within_groups, scale);
  if (table.values.k < 2) return result;
  const auto contrasts = static_cast<double>(table.values.k - 1);
  result.condition = tested(ss.condition, contrasts, ss.error, contrasts * within_groups, scale);
  result.interaction = tested(ss.interaction, groups * contrasts, ss.error, contrasts * within_groups, scale);
  for (MixedEffect* effect : {&result.group, &result.condition, &result.interaction})
    if (effect->status == StatisticStatus::ok)
      effect->eta2_generalised = effect->ss / (effect->ss + ss.participants + ss.error);
  if (result.condition.status != StatisticStatus::ok) return result;
  const double gg = pooled_epsilon(table, means, within_groups);
  const double below = contrasts * (within_groups - contrasts * gg);
  result.epsilon_gg = gg;
  if (contrasts == 1)
    result.epsilon_hf = 1;
  else if (below > 1e-9 * within_groups)
    result.epsilon_hf = ((within_groups + 1) * contrasts * gg - 2) / below;
  correct_for_sphericity(result.condition, gg, result.epsilon_hf);
  correct_for_sphericity(result.interaction, gg, result.epsilon_hf);
  return result;
}

}  // namespace jnd
