// What verify found, and whether it may be said while a study is blinded.
#pragma once

#include <ostream>
#include <string>

namespace jnd {

struct Problem {
  // What the text gives away. A problem is sealed unless it is made with `nothing`.
  enum class Reveals {
    nothing,  // of conditions, stimuli, answers and the seed
    plan
  };

  std::string where;  // "Session P01, event 7": may always be said
  std::string text;   // the whole sentence
  Reveals reveals = Reveals::plan;

  bool operator==(const Problem&) const = default;
};

inline std::ostream& operator<<(std::ostream& stream, const Problem& problem) {
  return stream << problem.text;
}

}  // namespace jnd
