#include "analysis/group/compare_groups.h"

#include "analysis/group/p_adjust.h"
#include "analysis/numerics/moments.h"

namespace jnd {

namespace {

void correct_pairs(std::vector<GroupPair>& pairs) {
  std::vector<double> welch, ranks;
  for (const GroupPair& pair : pairs) {
    welch.push_back(pair.welch.p);
    ranks.push_back(pair.ranks.p);
  }
  welch = holm(welch);
  ranks = holm(ranks);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].welch_p_holm = welch[i];
    pairs[i].ranks_p_holm = ranks[i];
  }
}

}  // namespace

GroupComparison compare_groups(const GroupedTable& table) {
  GroupComparison found;
  found.anova = mixed_anova(table);
  for (std::size_t j = 0; j < table.values.k; ++j) {
    std::vector<std::vector<double>> values;
    for (std::size_t g = 0; g < table.groups; ++g) {
      values.push_back(table.cell(g, j));
      found.cells.push_back({g, j, mean_interval(values[g]), median_of(values[g]), shapiro_wilk(values[g])});
    }
    for (std::size_t a = 0; a < table.groups; ++a)
      for (std::size_t b = a + 1; b < table.groups; ++b)
        found.pairs.push_back({a, b, j, welch_t(values[a], values[b]), 0, mann_whitney(values[a], values[b]), 0});
  }
  correct_pairs(found.pairs);
  return found;
}

}  // namespace jnd
