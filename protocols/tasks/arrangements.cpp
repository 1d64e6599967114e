#include "protocols/tasks/arrangements.h"

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

void add_level(std::vector<DrawnTrial>& cell, std::vector<DrawnTrial> arrangements, int trials, Sampling sampling,
               RandomStream& stream) {
  const auto count = static_cast<int>(arrangements.size());
  if (sampling == Sampling::random) {
    for (int i = 0; i < trials; ++i)
      cell.push_back(arrangements[static_cast<std::size_t>(stream.below(arrangements.size()))]);
    return;
  }
  for (int i = 0; i < trials / count; ++i) cell.insert(cell.end(), arrangements.begin(), arrangements.end());
  stream.shuffle(arrangements);
  for (int i = 0; i < trials % count; ++i) cell.push_back(arrangements[static_cast<std::size_t>(i)]);
}

std::vector<DrawnTrial> track_of(const std::vector<DrawnTrial>& arrangements, int trials, RandomStream& stream) {
  std::vector<DrawnTrial> track;
  while (static_cast<int>(track.size()) < trials) {
    std::vector<DrawnTrial> part;
    for (int twice = 0; twice < 2; ++twice) part.insert(part.end(), arrangements.begin(), arrangements.end());
    stream.shuffle(part);
    track.insert(track.end(), part.begin(), part.end());
  }
  track.resize(static_cast<std::size_t>(trials));
  return track;
}

std::vector<Intervals> orders_of(double standard, double comparison, bool standard_first) {
  if (standard_first) return {{standard, comparison}};
  return {{standard, comparison}, {comparison, standard}};
}

std::string_view how_often(const Protocol& protocol) {
  return protocol.design.sampling == Sampling::balanced ? "equally often" : "at random";
}

std::vector<TaskProblem> problems_of_places(const Protocol& protocol) {
  if (!protocol.task.together || !protocol.rig.built_in()) return {};
  return {{"$.task.presentation", "our own devices present one value after another",
           "write \"sequential\", or the rig \"specimens\" or \"external\""}};
}

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
