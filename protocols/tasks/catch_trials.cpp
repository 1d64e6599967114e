#include "protocols/tasks/catch_trials.h"

#include <algorithm>
#include <cmath>

namespace jnd {
namespace {

constexpr int kLargestDenominator = 20;
constexpr int kShortestPosteriorBlock = 6;
constexpr double kShareTolerance = 0.001;  // 0.333 means a third

// Catch trials that go with so many others in a part of a block.
int catches_of_part(const CatchBlock& block, int different) {
  const int of_block = block.trials - block.catches;
  return (2 * block.catches * different + of_block) / (2 * of_block);
}

}  // namespace

std::optional<CatchBlock> catch_block(double share, int shortest) {
  if (!(share >= 0 && share < 1)) return std::nullopt;
  for (int denominator = 1; denominator <= kLargestDenominator; ++denominator) {
    const double catches = share * denominator;
    if (std::abs(catches - std::round(catches)) > kShareTolerance * denominator) continue;
    const int times = (shortest + denominator - 1) / denominator;
    return CatchBlock{times * denominator, times * static_cast<int>(std::round(catches))};
  }
  return std::nullopt;
}

std::optional<CatchBlock> catch_block_of(const AdaptiveProcedure& procedure) {
  return procedure.kind == AdaptiveProcedure::Kind::posterior
             ? catch_block(procedure.catch_share, kShortestPosteriorBlock)
             : catch_block(procedure.catch_share);
}

int slots_of_track(const CatchBlock& block, int different) {
  const int of_block = block.trials - block.catches;
  const int rest = different % of_block;
  return different / of_block * block.trials + (rest == 0 ? 0 : rest + catches_of_part(block, rest));
}

int trials_with_catches(const AdaptiveProcedure& procedure) {
  const auto block = catch_block_of(procedure);
  if (!block || procedure.trials < 1) return 0;
  return slots_of_track(*block, procedure.trials) * static_cast<int>(procedure.starts.size());
}

std::vector<std::array<double, 2>> draw_slots(const CatchBlock& block, int different, double reference,
                                              RandomStream& stream) {
  using Pair = std::array<double, 2>;
  const int of_block = block.trials - block.catches;
  const double comparison = set_by_answers(reference);
  std::vector<Pair> slots;
  while (different > 0) {
    const int now = std::min(different, of_block);
    const int catches = now == of_block ? block.catches : catches_of_part(block, now);
    std::vector<Pair> part;
    const auto add = [&](int count, const Pair& one, const Pair& other) {
      for (int i = 0; i < count / 2; ++i) part.insert(part.end(), {one, other});
      if (count % 2 != 0) part.push_back(stream.coin() ? one : other);
    };
    add(now, {reference, comparison}, {comparison, reference});
    add(catches, {reference, reference}, {comparison, comparison});
    stream.shuffle(part);
    slots.insert(slots.end(), part.begin(), part.end());
    different -= now;
  }
  return slots;
}

}  // namespace jnd
