#include "runner/blinded_problem.h"

#include <algorithm>
#include <array>
#include <exception>
#include <string_view>

#include "data/blinding.h"
#include "runner/study_access.h"

namespace jnd {

namespace {

// In messages that go on to say what was planned or presented, or that quote an event.
constexpr std::array<std::string_view, 7> kTelling = {" presented ", "condition", "series",   "seed",
                                                      "stimul",      "track",     "last read"};

bool sealed(const Study& study) {
  try {
    return plan_sealed(study, protocol_of(study));
  } catch (const std::exception&) {
    return true;
  }
}

}  // namespace

std::vector<std::string> unsealed_problems(std::vector<std::string> problems, const Study& study) {
  if (problems.empty() || !sealed(study)) return problems;
  for (std::string& problem : problems) {
    if (std::none_of(kTelling.begin(), kTelling.end(),
                     [&](std::string_view word) { return problem.find(word) != std::string::npos; }))
      continue;
    const std::string::size_type colon = problem.find(": ");
    problem = (colon == std::string::npos ? "The study" : problem.substr(0, colon)) +
              ": contradicts the plan or the rest of the study; what exactly is sealed while the study is blinded.";
  }
  return problems;
}

}  // namespace jnd
