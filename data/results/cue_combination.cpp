#include "data/results/cue_combination.h"

#include <algorithm>
#include <cmath>

namespace jnd {

namespace {

bool shares(const Cues& a, const Cues& b) noexcept {
  return (a.force && b.force) || (a.vibration && b.vibration) || (a.kinaesthetic && b.kinaesthetic);
}

Cues together(const Cues& a, const Cues& b) noexcept {
  return {a.force || b.force, a.vibration || b.vibration, a.kinaesthetic || b.kinaesthetic};
}

CueCombination combination(const std::vector<ParticipantRows>& people, std::size_t jnd, int a, int b, int both) {
  CueCombination result{a, b, both, {}, {}};
  std::vector<double> ratios;
  for (const ParticipantRows& person : people) {
    const auto jnd_of = [&](int condition) {
      const TaskEstimateRow* const row = person.of[static_cast<std::size_t>(condition)];
      return row == nullptr ? std::nullopt : row->estimates.values[jnd].value;
    };
    CombinedParticipant one{person.participant, {}, jnd_of(both)};
    const std::optional<double> alone_a = jnd_of(a), alone_b = jnd_of(b);
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

std::vector<CueCombination> cue_combinations(const TaskResults& results, const Protocol& protocol) {
  std::vector<CueCombination> found;
  const auto jnd = std::find_if(results.outcomes.begin(), results.outcomes.end(),
                                [](const TaskOutcome& outcome) { return outcome.key == "jnd"; });
  if (jnd == results.outcomes.end() || judged_standard_count(protocol) > 1) return found;
  const auto conditions = static_cast<int>(protocol.conditions.size());
  const std::vector<ParticipantRows> people = by_participant(results.estimates, protocol.conditions.size());
  const auto cues = [&](int place) { return protocol.conditions[static_cast<std::size_t>(place)].cues; };
  for (int both = 0; both < conditions; ++both)
    for (int a = 0; a < conditions; ++a)
      for (int b = a + 1; b < conditions; ++b) {
        if (a == both || b == both || cues(a) == Cues{} || cues(b) == Cues{}) continue;
        if (!shares(cues(a), cues(b)) && together(cues(a), cues(b)) == cues(both))
          found.push_back(combination(people, static_cast<std::size_t>(jnd - results.outcomes.begin()), a, b, both));
      }
  return found;
}

}  // namespace jnd
