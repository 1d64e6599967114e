#include "analysis/numerics/falling_answers.h"

#include <algorithm>
#include <cmath>

namespace jnd {

namespace {

constexpr double kNormal999 = 3.090232306167813;  // the 99.9 % quantile

template <typename Row>
EndOfLevels end_of(Row row, Row stop) {
  constexpr long long kEnough = 10;
  EndOfLevels end{row->level, row->level};
  for (; row != stop && (end.n < kEnough || row->level == end.to); ++row) {
    end.to = row->level;
    end.n += row->n;
    end.k += row->k;
  }
  return end;
}

}  // namespace

std::optional<FallingAnswers> falling_answers(std::vector<AnsweredLevel> rows) {
  std::erase_if(rows, [](const AnsweredLevel& one) { return one.n == 0; });
  std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.level < b.level; });
  double n = 0, k = 0, sum = 0;
  for (const AnsweredLevel& one : rows) {
    n += static_cast<double>(one.n);
    k += static_cast<double>(one.k);
    sum += static_cast<double>(one.n) * one.level;
  }
  double trend = 0, spread = 0;
  for (const AnsweredLevel& one : rows) {
    const double x = one.level - sum / n;
    trend += static_cast<double>(one.k) * x;
    spread += static_cast<double>(one.n) * x * x;
  }
  if (!(trend < -kNormal999 * std::sqrt(k / n * (1 - k / n) * spread))) return std::nullopt;
  return FallingAnswers{end_of(rows.begin(), rows.end()), end_of(rows.rbegin(), rows.rend())};
}

}  // namespace jnd
