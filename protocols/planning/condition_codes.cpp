#include "protocols/planning/condition_codes.h"

#include "protocols/random_stream.h"

namespace jnd {

std::vector<std::string> condition_codes(const Protocol& protocol, std::uint64_t seed) {
  std::vector<std::string> codes;
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
    codes.emplace_back(1, static_cast<char>('A' + static_cast<int>(i)));
  RandomStream(seed, 0, "condition codes").shuffle(codes);
  return codes;
}

}  // namespace jnd
