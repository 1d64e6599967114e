#include "runner/study_commands/blinded_problem.h"

#include <exception>

#include "data/study/blinding.h"
#include "runner/opening/study_access.h"

namespace jnd {

bool is_sealed(const Study& study) {
  try {
    return plan_sealed(study, protocol_of(study));
  } catch (const std::exception&) {
    return true;
  }
}

namespace {

std::vector<std::string> texts_of(const std::vector<Problem>& problems, bool in_words) {
  std::vector<std::string> texts;
  for (const Problem& problem : problems)
    texts.push_back(in_words || problem.reveals == Reveals::nothing
                        ? problem.text
                        : problem.where +
                              ": contradicts the plan or the rest of the study; what exactly is sealed "
                              "while the study is blinded.");
  return texts;
}

}  // namespace

std::vector<std::string> unsealed_problems(const std::vector<Problem>& problems, const Study& study) {
  return texts_of(problems, problems.empty() || !is_sealed(study));
}

std::vector<std::string> sealed_problems(const std::vector<Problem>& problems) {
  return texts_of(problems, false);
}

}  // namespace jnd
