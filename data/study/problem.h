// What verify found, and whether it may be said while a study is blinded.
#pragma once

#include <ostream>
#include <string>

#include "data/study/reveals.h"

namespace jnd {

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
