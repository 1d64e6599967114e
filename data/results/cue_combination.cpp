#include "data/results/cue_combination.h"

#include <cmath>
#include <map>

namespace jnd {

namespace {

bool shares(const Cues& a, const Cues& b) noexcept {
  return (a.force && b.force) || (a.vibration && b.vibration) || (a.kinaesthetic && b.kinaesthetic);
}

Cues together(const Cues& a, const Cues& b) noexcept {
  return {a.force || b.force, a.vibration || b.vibration, a.kinaesthetic || b.kinaesthetic};
}

std::optional<double> jnd_of(const std::map<int, const ThresholdResult*>& own, int condition) {
  const auto found = own.find(condition);
  if (found == own.end() || found->second->jnd.status != JndStatus::ok) return std::nullopt;
  return found->second->jnd.jnd;
}

CueCombination combination(std::span<const ThresholdResult> thresholds, int a, int b, int both) {
  CueCombination result{a, b, both, {}, {}};
  std::vector<double> ratios;
  for (std::size_t from = 0; from < thresholds.size();) {
    std::map<int, const ThresholdResult*> own;
    const std::string& participant = thresholds[from].participant;
    for (; from < thresholds.size() && thresholds[from].participant == participant; ++from)
      own[thresholds[from].condition] = &thresholds[from];
    CombinedParticipant one{participant, {}, jnd_of(own, both)};
    const std::optional<double> alone_a = jnd_of(own, a), alone_b = jnd_of(own, b);
    if (alone_a && alone_b) one.predicted = optimal_jnd(*alone_a, *alone_b);
    if (one.predicted && one.observed) ratios.push_back(std::log(*one.observed / *one.predicted));
    result.participants.push_back(std::move(one));
  }
  result.log_ratio = mean_with_ci(ratios);
  return result;
}

}  // namespace

double optimal_jnd(double a, double b) noexcept {
  return a * b / std::hypot(a, b);
}

std::vector<CueCombination> cue_combinations(std::span<const ThresholdResult> thresholds, const Protocol& protocol) {
  std::vector<CueCombination> found;
  const auto conditions = static_cast<int>(protocol.conditions.size());
  const auto cues = [&](int place) { return protocol.conditions[static_cast<std::size_t>(place)].cues; };
  for (int both = 0; both < conditions; ++both)
    for (int a = 0; a < conditions; ++a)
      for (int b = a + 1; b < conditions; ++b) {
        if (a == both || b == both || cues(a) == Cues{} || cues(b) == Cues{}) continue;
        if (!shares(cues(a), cues(b)) && together(cues(a), cues(b)) == cues(both))
          found.push_back(combination(thresholds, a, b, both));
      }
  return found;
}

}  // namespace jnd
