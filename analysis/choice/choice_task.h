// Tasks with a right answer, and how often d' gives it: P(d'), its complement, its slope and its inverse.
//
//   2afc, 3afc, 4afc  which of m intervals holds the signal: P = integral phi(x - d') Phi(x)^(m-1) dx over the line
//   oddity            which of three is the odd one (triangle), comparison of distances:
//                     P = 1 - 4 T(d'/sqrt 6, sqrt 3), which is 1 - F(3) of the noncentral F(1, 1; 2 d'^2 / 3)
//   abx, differencing           P = Phi(a) Phi(b) + Phi(-a) Phi(-b), a = d'/sqrt 2, b = d'/sqrt 6
//   abx, independent            the same with b = d'/2
//   duo_trio          2AFC with reminder under comparison of distances: the same as abx, differencing
//
// d' of m-AFC is signed: fewer right answers than by chance give d' < 0. The other tasks say nothing about a direction,
// and their d' is at least 0.
//
// Source: Hacker and Ratcliff 1979, Percept Psychophys 26:168 (m-AFC); Ennis 1993, J Sens Stud 8:353, and Bi 2015,
// Sensory Discrimination Tests and Measurements (triangle, duo-trio); Macmillan and Creelman 2005, chapter 9 (ABX).
// T is the function of Owen 1956, Ann Math Stat 27:1075, by Boost.Math. Accuracy: 1e-13 relative of P, of 1 - P and of
// the slope, as long as they do not underflow. Tests: R 4.2.2 (sensR, psyphy), adaptive quadrature.
#pragma once

#include <optional>
#include <string_view>

namespace jnd {

enum class ChoiceTask { two_afc, three_afc, four_afc, oddity, abx_differencing, abx_independent, duo_trio };

// "2afc", "3afc", "4afc", "oddity3", "abx_differencing", "abx_independent", "duo_trio".
std::string_view to_string(ChoiceTask task) noexcept;
std::optional<ChoiceTask> choice_task_from(std::string_view name) noexcept;

// 2, 3 or 4 alternatives; empty for another number.
std::optional<ChoiceTask> mafc_task(int alternatives) noexcept;

int chance_of_one_in(ChoiceTask task) noexcept;         // 2, 3 or 4: the chance level is one in so many
bool has_signed_dprime(ChoiceTask task) noexcept;       // m-AFC
inline double chance_level(ChoiceTask task) noexcept {  // P(0)
  return 1.0 / chance_of_one_in(task);
}

// The probability of the right answer and its complement, each to full relative accuracy, and dP/dd'.
struct ChoiceRate {
  double correct, wrong, slope;
};
// dprime may be infinite; its sign does not matter where d' is not signed, except to that of the slope. NaN gives NaN.
ChoiceRate choice_rate(ChoiceTask task, double dprime) noexcept;

// d' with P(d') = correct; wrong = 1 - correct, given apart so that no digit is lost near 1. Both in 0..1.
// correct = 1 gives inf; 0 gives -inf where d' is signed. 0 at the chance level, and below it where d' is not signed.
double choice_dprime(ChoiceTask task, double correct, double wrong) noexcept;

}  // namespace jnd
