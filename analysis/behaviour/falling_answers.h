// Whether answers grow rarer with the level, as answers do that are coded the other way round.
//
// Source: Cochran 1954 (Biometrics 10:417) and Armitage 1955 (Biometrics 11:375), the test for a linear trend in
// proportions. Tests: closed cases.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace jnd {

struct AnsweredLevel {
  double level = 0;  // finite
  long long n = 0, k = 0;
};

// The answers at either end of the levels: of the outermost one, or of as many as have 10 trials together.
struct FallingAnswers {
  struct End {
    double from = 0, to = 0;  // the outermost level first
    long long n = 0, k = 0;
  } low, high;
};

// Empty unless they fall with a one-sided p below .001. Rows of one level count together, in any order.
inline std::optional<FallingAnswers> falling_answers(std::vector<AnsweredLevel> rows) {
  constexpr double kNormal999 = 3.090232306167813;  // the 99.9 % quantile
  std::erase_if(rows, [](const AnsweredLevel& one) { return one.n == 0; });
  std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.level < b.level; });
  double n = 0, k = 0, nx = 0, kx = 0, nxx = 0;
  for (const AnsweredLevel& one : rows) {
    const auto trials = static_cast<double>(one.n), positive = static_cast<double>(one.k);
    const double x = one.level - rows.front().level;
    n += trials;
    k += positive;
    nx += trials * x;
    kx += positive * x;
    nxx += trials * x * x;
  }
  if (!(kx - k * nx / n < -kNormal999 * std::sqrt(k / n * (1 - k / n) * (nxx - nx * nx / n)))) return std::nullopt;
  const auto end_of = [](auto row, auto stop) {
    FallingAnswers::End end{row->level, row->level};
    for (; row != stop && (end.n < 10 || row->level == end.to); ++row)
      end = {end.from, row->level, end.n + row->n, end.k + row->k};
    return end;
  };
  return FallingAnswers{end_of(rows.begin(), rows.end()), end_of(rows.rbegin(), rows.rend())};
}

}  // namespace jnd
