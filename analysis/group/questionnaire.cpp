#include "analysis/group/questionnaire.h"

#include <algorithm>
#include <cmath>

#include <boost/math/special_functions/beta.hpp>

#include "analysis/group/p_adjust.h"
#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

std::vector<double> answered(std::span<const double> values) {
  std::vector<double> result;
  for (const double value : values)
    if (!std::isnan(value)) result.push_back(value);
  return result;
}

// The participants who answered after every condition.
WithinTable complete(const WithinTable& table) {
  WithinTable result;
  result.k = table.k;
  for (std::size_t i = 0; i < table.n; ++i) {
    const std::span<const double> row = table.row(i);
    if (std::any_of(row.begin(), row.end(), [](double value) { return std::isnan(value); })) continue;
    result.values.insert(result.values.end(), row.begin(), row.end());
    ++result.n;
  }
  return result;
}

ItemPair item_pair(const WithinTable& ratings, std::size_t a, std::size_t b) {
  ItemPair pair;
  pair.a = a;
  pair.b = b;
  std::vector<double> of_a, of_b, differences;
  for (std::size_t i = 0; i < ratings.n; ++i) {
    if (std::isnan(ratings.at(i, a)) || std::isnan(ratings.at(i, b))) continue;
    of_a.push_back(ratings.at(i, a));
    of_b.push_back(ratings.at(i, b));
    differences.push_back(of_a.back() - of_b.back());
  }
  pair.test = signed_rank(of_a, of_b);
  pair.median_difference = median_of(differences);
  pair.exact = !std::isnan(pair.test.p_exact_permutation);
  pair.p = pair.exact ? pair.test.p_exact_permutation : pair.test.p_normal;
  return pair;
}

// P(Binomial(n, 1/2) < r), 1 <= r <= n: how often x(r) lies above the median.
double fewer_than(std::size_t r, std::size_t n) {
  const auto places = static_cast<double>(r), size = static_cast<double>(n);
  return boost::math::ibeta(size - places + 1, places, 0.5);
}

}  // namespace

MedianInterval median_interval(std::span<const double> values, double confidence) {
  MedianInterval result;
  result.n = static_cast<int>(values.size());
  result.median = median_of(values);
  result.ci_low = result.ci_high = result.coverage = kNaN;
  if (values.empty()) {
    result.status = StatisticStatus::too_few;
    return result;
  }
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  std::size_t r = 1;
  double outside = fewer_than(r, values.size());
  while (2 * (r + 1) <= values.size() + 1) {
    const double wider = fewer_than(r + 1, values.size());
    if (1 - 2 * wider < confidence) break;
    outside = wider;
    ++r;
  }
  result.ci_low = sorted[r - 1];
  result.ci_high = sorted[sorted.size() - r];
  result.coverage = std::max(0.0, 1 - 2 * outside);
  if (result.coverage < confidence) result.status = StatisticStatus::too_few;
  return result;
}

PairedQuestionnaire paired_questionnaire(std::span<const PairedItem> items) {
  PairedQuestionnaire result;
  std::vector<double> p;
  for (const PairedItem& item : items) {
    PairedItemResult one;
    one.id = item.id;
    const WithinTable& ratings = item.ratings;
    for (std::size_t j = 0; j < ratings.k; ++j) one.conditions.push_back(median_interval(answered(ratings.column(j))));
    one.friedman = friedman(complete(ratings));
    if (ratings.k == 2) {
      one.friedman = {};
      one.friedman.status = StatisticStatus::not_applicable;
      one.friedman.chi2 = one.friedman.p = one.friedman.kendall_w = kNaN;
      one.friedman.f_iman_davenport = one.friedman.p_iman_davenport = kNaN;
    }
    for (std::size_t a = 0; a < ratings.k; ++a) {
      for (std::size_t b = a + 1; b < ratings.k; ++b) {
        one.pairs.push_back(item_pair(ratings, a, b));
        p.push_back(one.pairs.back().p);
      }
    }
    result.items.push_back(std::move(one));
  }
  result.family =
      static_cast<std::size_t>(std::count_if(p.begin(), p.end(), [](double value) { return !std::isnan(value); }));
  const std::vector<double> by_holm = holm(p), by_bh = benjamini_hochberg(p);
  std::size_t test = 0;
  for (PairedItemResult& item : result.items) {
    for (ItemPair& pair : item.pairs) {
      pair.p_holm = by_holm[test];
      pair.p_bh = by_bh[test];
      ++test;
    }
  }
  return result;
}

}  // namespace jnd
