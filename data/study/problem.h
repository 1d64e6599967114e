// What a sentence or a column tells of a blinded study; what verify found.
#pragma once

#include <ostream>
#include <string>

namespace jnd {

// Whatever is not made with `nothing` stays sealed while a study is blinded.
enum class Reveals {
  nothing,  // of conditions, stimuli, answers and the seed
  plan
};

struct Problem {
  std::string where;  // "Session P01, event 7": may always be said
  std::string text;   // the whole sentence
  Reveals reveals = Reveals::plan;

  bool operator==(const Problem&) const = default;
};

inline std::ostream& operator<<(std::ostream& stream, const Problem& problem) {
  return stream << problem.text;
}

}  // namespace jnd
