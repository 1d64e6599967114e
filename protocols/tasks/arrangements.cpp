#include "protocols/tasks/arrangements.h"

namespace jnd {

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

}  // namespace jnd
