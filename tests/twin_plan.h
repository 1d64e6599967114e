// Two studies that an operator must not be able to tell apart: their letters stand in the same places, and everything
// that letters hide is another.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocols/condition_words.h"
#include "protocols/planning/plan.h"

namespace jnd::test {

// The letter of every trial of the first `participants`; practice has none.
inline std::string letters_of(const Protocol& protocol, std::uint64_t seed, int participants) {
  const std::vector<std::string> codes = condition_codes(protocol, seed);
  std::string letters;
  for (int number = 1; number <= participants; ++number)
    for (const Trial& trial : make_plan(protocol, number, seed).trials)
      letters += trial.practice ? "-" : codes[static_cast<std::size_t>(trial.condition)];
  return letters;
}

// Whether no letter stands for the same condition, and at least a quarter of the trials differ in stimuli, and in class
// where there are classes.
inline bool differ_behind_letters(const Protocol& protocol, std::uint64_t a, std::uint64_t b, int participants) {
  const std::vector<std::string> of_a = condition_codes(protocol, a), of_b = condition_codes(protocol, b);
  for (std::size_t i = 0; i < of_a.size(); ++i)
    if (of_a.size() > 1 && of_a[i] == of_b[i]) return false;
  std::size_t trials = 0, differ = 0;
  for (int number = 1; number <= participants; ++number) {
    const Plan one = make_plan(protocol, number, a), other = make_plan(protocol, number, b);
    trials += one.trials.size();
    for (std::size_t i = 0; i < one.trials.size(); ++i)
      differ += (one.trials[i].target < 0 || one.trials[i].target != other.trials[i].target) &&
                one.trials[i].stimuli != other.trials[i].stimuli;
  }
  return 4 * differ >= trials;
}

inline std::uint64_t twin_of(const Protocol& protocol, std::uint64_t seed, int participants) {
  const std::string letters = letters_of(protocol, seed, participants);
  for (std::uint64_t other = seed + 1; other < seed + 100'000; ++other)
    if (letters_of(protocol, other, participants) == letters &&
        differ_behind_letters(protocol, seed, other, participants))
      return other;
  throw std::runtime_error("no seed has a plan that looks the same");
}

}  // namespace jnd::test
