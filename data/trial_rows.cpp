#include "data/trial_rows.h"

#include <string>
#include <unordered_map>

#include <fmt/format.h>

#include "data/study_impl.h"

namespace jnd {

std::string_view exclusion_reason(const Exclusions& rules, bool by_participant, double response_time_s,
                                  double saturated_share) noexcept {
  if (by_participant && rules.response_time_below_s && response_time_s < *rules.response_time_below_s)
    return kResponseTimeBelow;
  if (by_participant && rules.response_time_above_s && response_time_s > *rules.response_time_above_s)
    return kResponseTimeAbove;
  if (rules.saturated_share_above && saturated_share > *rules.saturated_share_above) return kSaturatedShareAbove;
  return {};
}

std::string_view exclusion_reason(const Exclusions& rules, const CountedTrial& trial) noexcept {
  return exclusion_reason(rules, trial.by_participant, trial.response_time_s, trial.saturated_share);
}

std::map<std::string, std::set<std::int64_t>> taken_back_of(const Study& study) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  return with_storage_errors(impl.path, [&] {
    std::map<std::string, std::set<std::int64_t>> found;
    for (const TakenBack& one : taken_back(impl.database())) found[one.session].insert(one.seq);
    return found;
  });
}

namespace {

// In the order of the file, without an index: page after page is several times faster than row after row, and the
// events of one session still come in their order, because they are only ever appended.
constexpr const char* kCompletedTrials =
    "SELECT session, seq, body, rowid FROM event NOT INDEXED WHERE kind = 'trial.completed' ORDER BY rowid";

// A session's place in the list that was asked for; -1 where it is not in it.
class SessionPlaces {
 public:
  explicit SessionPlaces(const std::vector<SessionInfo>& sessions) {
    for (std::size_t place = 0; place < sessions.size(); ++place)
      places_.emplace(sessions[place].id, static_cast<int>(place));
  }
  int of(const char* session) {
    if (last_ == session) return place_;  // neighbours in the file are mostly of one session
    last_ = session;
    const auto found = places_.find(last_);
    return place_ = found == places_.end() ? -1 : found->second;
  }

 private:
  std::unordered_map<std::string, int> places_;
  std::string last_;
  int place_ = -1;
};

bool within(int place, std::size_t size) noexcept {
  return place >= 0 && place < static_cast<int>(size);
}

}  // namespace

std::vector<CountedTrial> read_counted_trials(const Study& study, const Protocol& protocol,
                                              const std::vector<SessionInfo>& sessions) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  return with_storage_errors(impl.path, [&] {
    SQLite::Transaction reading(impl.database());  // both queries of one instant
    SQLite::Statement query(impl.database(), kCompletedTrials);
    SessionPlaces places(sessions);
    const std::vector<TakenBack> not_counted = taken_back(impl.database());
    auto next_taken_back = not_counted.begin();
    TrialBodyReader reader(protocol.stimulus.unit);
    std::vector<CountedTrial> trials;
    while (query.executeStep()) {
      const int place = places.of(query.getColumn(0).getText());
      if (next_taken_back != not_counted.end() && query.getColumn(3).getInt64() == next_taken_back->row) {
        ++next_taken_back;
        continue;
      }
      if (place < 0) continue;
      const SQLite::Column body = query.getColumn(2);
      const auto failed = [&](const std::string& what) {
        return StorageError(fmt::format("{}: session {}, event {}: {}; run jnd verify", impl.path.string(),
                                        sessions[static_cast<std::size_t>(place)].id, query.getColumn(1).getInt64(),
                                        what));
      };
      CountedTrial trial;
      try {
        trial = reader.read({body.getText(), static_cast<std::size_t>(body.getBytes())});
      } catch (const StorageError& error) {
        throw failed(error.what());
      }
      if (trial.practice) continue;
      trial.session = place;
      if (!within(trial.series, protocol.series.size()) || !within(trial.condition, protocol.conditions.size()))
        throw failed(fmt::format("series {} or condition {} is not in the protocol", trial.series, trial.condition));
      trials.push_back(trial);
    }
    return trials;
  });
}

}  // namespace jnd
