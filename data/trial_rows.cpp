#include "data/trial_rows.h"

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

namespace {

// Two fingers with two devices each: the largest rig. One with more would be refused, not read in part.
constexpr int kDevices = 4;
constexpr int kFirstDelivered = 11;  // column of the query

std::string query_text(StiffnessUnit unit) {
  const std::string_view suffix = name_suffix(unit);
  std::string text = fmt::format(
      "SELECT json_extract(body, '$.series_place'), json_extract(body, '$.condition_place'), same, answer, entered_by, "
      "response_time_s, duration_s, saturated_share, seq, json_extract(body, '$.stimulus_1_{0}'), json_extract(body, "
      "'$.stimulus_2_{0}')",
      suffix);
  for (int interval = 0; interval < 2; ++interval) {
    for (int device = 0; device < kDevices; ++device)
      text +=
          fmt::format(", json_extract(body, '$.presentations[{}].fingers[{}].stiffness_{}')", interval, device, suffix);
    text += fmt::format(", json_extract(body, '$.presentations[{}].fingers[{}]') IS NOT NULL", interval, kDevices);
  }
  return text + " FROM event WHERE kind = 'trial.completed' AND session = ? AND practice = 0 ORDER BY seq";
}

std::optional<double> mean_delivered(SQLite::Statement& query, int interval) {
  const int first = kFirstDelivered + interval * (kDevices + 1);
  if (query.getColumn(first + kDevices).getInt() != 0)
    throw StorageError(fmt::format("a presentation has more than {} devices", kDevices));
  double sum = 0;
  int fits = 0;
  for (int device = 0; device < kDevices; ++device) {
    const SQLite::Column stiffness = query.getColumn(first + device);
    if (stiffness.isNull()) continue;
    sum += stiffness.getDouble();
    ++fits;
  }
  return fits > 0 ? std::optional<double>(sum / fits) : std::nullopt;
}

}  // namespace

std::vector<CountedTrial> read_counted_trials(const Study& study, const Protocol& protocol,
                                              const std::vector<SessionInfo>& sessions) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  return with_storage_errors(impl.path, [&] {
    SQLite::Statement query(impl.database(), query_text(protocol.stimulus.unit));
    std::vector<CountedTrial> trials;
    for (std::size_t place = 0; place < sessions.size(); ++place) {
      query.bind(1, sessions[place].id);
      while (query.executeStep()) {
        CountedTrial trial;
        trial.session = static_cast<int>(place);
        trial.series = query.getColumn(0).getInt();
        trial.condition = query.getColumn(1).getInt();
        const bool known = trial.series >= 0 && trial.series < static_cast<int>(protocol.series.size()) &&
                           trial.condition >= 0 && trial.condition < static_cast<int>(protocol.conditions.size());
        if (!known)
          throw StorageError(fmt::format(
              "{}: session {}, event {}: series {} or condition {} is not in the protocol; "
              "run jnd verify",
              impl.path.string(), sessions[place].id, query.getColumn(8).getInt64(), trial.series, trial.condition));
        trial.same = query.getColumn(2).getInt() != 0;
        trial.said_different = query.getColumn(3).getString() == to_string(Judgement::different);
        trial.by_participant = query.getColumn(4).getString() == to_string(EnteredBy::participant);
        trial.response_time_s = query.getColumn(5).getDouble();
        trial.duration_s = query.getColumn(6).getDouble();
        trial.saturated_share = query.getColumn(7).getDouble();
        trial.asked = {query.getColumn(9).getDouble(), query.getColumn(10).getDouble()};
        trial.delivered = {mean_delivered(query, 0), mean_delivered(query, 1)};
        trials.push_back(trial);
      }
      query.reset();
    }
    return trials;
  });
}

}  // namespace jnd
