#include "data/study/trial_rows.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "data/study/study_impl.h"

namespace jnd {

std::string_view exclusion_reason(const Exclusions& rules, bool by_participant, double response_time_s,
                                  double saturated_share, bool off_prescription) noexcept {
  if (by_participant && rules.response_time_below_s && response_time_s < *rules.response_time_below_s)
    return kResponseTimeBelow;
  if (by_participant && rules.response_time_above_s && response_time_s > *rules.response_time_above_s)
    return kResponseTimeAbove;
  if (rules.saturated_share_above && saturated_share > *rules.saturated_share_above) return kSaturatedShareAbove;
  if (rules.off_prescription && off_prescription) return kOffPrescription;
  return {};
}

std::string_view exclusion_reason(const Exclusions& rules, const CountedTrial& trial) noexcept {
  return exclusion_reason(rules, trial.by_participant, trial.response_time_s, trial.saturated_share,
                          trial.off_prescription);
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

// In the order of the file, without an index: page after page is several times faster than row after row. The events of
// one session come in their order, because they are only ever appended; where they do not, they are sorted afterwards.
constexpr const char* kCompletedTrials =
    "SELECT session, seq, body FROM event NOT INDEXED WHERE kind = 'trial.completed' ORDER BY rowid";

// The events of taken-back answers, by session and number.
using EventPlaces = std::set<std::pair<std::string, std::int64_t>>;

EventPlaces taken_back_places(SQLite::Database& database) {
  EventPlaces places;
  for (TakenBack& one : taken_back(database)) places.emplace(std::move(one.session), one.seq);
  return places;
}

// Trials as they are read, with the number of each one's event.
class TrialsInOrder {
 public:
  void add(const CountedTrial& trial, std::int64_t seq) {
    std::int64_t& last = last_[trial.session];
    sorted_ = sorted_ && seq > last;
    last = seq;
    trials_.push_back(trial);
    seqs_.push_back(seq);
  }
  // By session and seq where the file has them in another order; else in that of the file.
  std::vector<CountedTrial> take() {
    if (sorted_) return std::move(trials_);
    std::vector<std::size_t> places(trials_.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::sort(places.begin(), places.end(), [&](std::size_t a, std::size_t b) {
      return std::tie(trials_[a].session, seqs_[a]) < std::tie(trials_[b].session, seqs_[b]);
    });
    std::vector<CountedTrial> sorted;
    sorted.reserve(trials_.size());
    for (const std::size_t place : places) sorted.push_back(trials_[place]);
    return sorted;
  }

 private:
  std::vector<CountedTrial> trials_;
  std::vector<std::int64_t> seqs_;
  std::unordered_map<int, std::int64_t> last_;  // by session
  bool sorted_ = true;
};

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

// Calls with(trial, the number of its event).
template <typename With>
void read_trials(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions, With&& with) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  with_storage_errors(impl.path, [&] {
    SQLite::Transaction reading(impl.database());  // both queries of one instant
    SQLite::Statement query(impl.database(), kCompletedTrials);
    SessionPlaces places(sessions);
    const EventPlaces not_counted = taken_back_places(impl.database());
    TrialBodyReader reader(protocol.stimulus.unit);
    while (query.executeStep()) {
      const int place = places.of(query.getColumn(0).getText());
      if (place < 0) continue;
      const std::int64_t seq = query.getColumn(1).getInt64();
      if (!not_counted.empty() && not_counted.contains({query.getColumn(0).getString(), seq})) continue;
      const SQLite::Column body = query.getColumn(2);
      const auto failed = [&](const std::string& what) {
        return StorageError(fmt::format("{}: session {}, event {}: {}; run jnd verify", impl.path.string(),
                                        sessions[static_cast<std::size_t>(place)].id, seq, what));
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
      with(trial, seq);
    }
    return 0;
  });
}

}  // namespace

void for_counted_trials(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                        const WithTrial& with) {
  read_trials(study, protocol, sessions, [&](const CountedTrial& trial, std::int64_t) { with(trial); });
}

std::vector<CountedTrial> read_counted_trials(const Study& study, const Protocol& protocol,
                                              const std::vector<SessionInfo>& sessions) {
  TrialsInOrder trials;
  read_trials(study, protocol, sessions, [&](const CountedTrial& trial, std::int64_t seq) { trials.add(trial, seq); });
  return trials.take();
}

CountedTrials::CountedTrials(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                             bool held)
    : study_(study), protocol_(protocol), sessions_(sessions) {
  if (held) held_ = read_counted_trials(study, protocol, sessions);
}

void CountedTrials::for_each(const WithTrial& with) const {
  if (!held_) return for_counted_trials(study_, protocol_, sessions_, with);
  for (const CountedTrial& trial : *held_) with(trial);
}

}  // namespace jnd
