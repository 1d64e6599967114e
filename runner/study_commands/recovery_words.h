// What `jnd recover` says to an operator whose disk was damaged: what is whole, what is gone, and what to do next.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/copies/recover.h"

namespace jnd {

// Names of files, as the user gave them.
struct RecoveryFiles {
  std::string damaged, to;
};

// problems: of the new study, as far as they may be said (blinded_problem.h). Printable; columns: of the terminal, 0
// where lines may be of any length. Ends with a newline.
std::string recovery_text(const RecoveryFiles& files, const RecoveryReport& report,
                          const std::vector<std::string>& problems, std::size_t columns);

nlohmann::ordered_json recovery_json(const RecoveryFiles& files, const RecoveryReport& report,
                                     const std::vector<std::string>& problems);

}  // namespace jnd
