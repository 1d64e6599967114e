// Whether answers grow rarer with the level, as answers do that are coded the other way round.
//
// Source: Cochran 1954 (Biometrics 10:417) and Armitage 1955 (Biometrics 11:375), the test for a linear trend in
// proportions. Tests: closed cases.
#pragma once

#include <optional>
#include <vector>

namespace jnd {

struct AnsweredLevel {
  double level = 0;  // finite
  long long n = 0, k = 0;
};

// The answers at one end of the levels: of the outermost one, or of as many as have 10 trials together.
struct EndOfLevels {
  double from = 0, to = 0;  // the outermost level first
  long long n = 0, k = 0;
};

struct FallingAnswers {
  EndOfLevels low, high;
};

// Empty unless they fall with a one-sided p below .001. Rows of one level count together, in any order.
std::optional<FallingAnswers> falling_answers(std::vector<AnsweredLevel> rows);

}  // namespace jnd
