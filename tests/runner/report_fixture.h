// Results of invented studies for the tests of figures and pages: counts drawn from a small generator, everything else
// computed by the program's own analysis.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "data/results/study_results.h"
#include "protocols/reading/protocol_json.h"

namespace jnd {

inline Protocol published_protocol() {
  return load_protocol(JND_SOURCE_DIR "/protocols/chinello2017.json");
}

// 0..1, the same everywhere (a linear congruential generator: nothing here rests on its quality).
class InventedNumbers {
 public:
  explicit InventedNumbers(std::uint64_t seed) : state_(seed * 2 + 1) {}
  double next() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11U) * 0x1p-53;
  }
  int successes(int n, double share) {
    int count = 0;
    for (int i = 0; i < n; ++i) count += next() < share ? 1 : 0;
    return count;
  }

 private:
  std::uint64_t state_;
};

// Six trials a class and cell; "different" the more often the larger the difference, by condition.
inline std::vector<CellCounts> invented_counts(const Protocol& protocol, int participants, std::uint64_t seed) {
  InventedNumbers numbers(seed);
  std::vector<CellCounts> cells;
  for (int person = 1; person <= participants; ++person)
    for (std::size_t condition = 0; condition < protocol.conditions.size(); ++condition)
      for (std::size_t series = 0; series < protocol.series.size(); ++series) {
        const double difference = protocol.series[series].pair[1] - protocol.series[series].pair[0];
        const double share = 0.25 + 0.0016 * difference * (condition == 1 ? 0.6 : 1.0);
        cells.push_back({"P" + std::string(person < 10 ? "0" : "") + std::to_string(person),
                         static_cast<int>(condition),
                         static_cast<int>(series),
                         {6, numbers.successes(6, share > 0.97 ? 0.97 : share), 6, numbers.successes(6, 0.25)}});
      }
  return cells;
}

// The results over those counts, with times and the protocol's paired rating invented, and nothing to be warned of.
inline StudyResults invented_results(const Protocol& protocol, const std::vector<CellCounts>& cells) {
  TaskResults task = results_of_counts(cells, protocol, SessionKind::simulated);
  InventedNumbers numbers(77);
  std::vector<std::string> participants;
  for (TaskEstimateRow& row : task.estimates) {
    row.mean_trial_s = 9 + 3 * numbers.next();
    if (row.condition == 0) participants.push_back(row.participant);
  }
  StudyResults results = results_of(std::move(task), static_cast<int>(participants.size()), protocol);
  for (const std::string& participant : participants)
    results.attendance.heads.push_back(
        {participant, "session-" + participant, std::string(64, 'a'), SessionKind::simulated, true});
  results.comparisons.push_back(compare_times(results.task, protocol));
  for (std::size_t place = 0; place < protocol.questions.size(); ++place) {
    if (protocol.questions[place].kind != Question::Kind::rating || !protocol.questions[place].per_condition) continue;
    RatedQuestion rated;
    rated.question = static_cast<int>(place);
    rated.paired = true;
    for (std::size_t i = 0; i < participants.size() * protocol.conditions.size(); ++i)
      rated.ratings.push_back(1 + numbers.successes(8, 0.6));
    results.comparisons.push_back(compare_ratings(rated, participants, protocol));
  }
  results.deviations.clear();
  results.cautions.clear();
  return results;
}

inline StudyResults invented_study(const Protocol& protocol, int participants) {
  return invented_results(protocol, invented_counts(protocol, participants, 5));
}

}  // namespace jnd
