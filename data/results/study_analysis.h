// The registered analysis of a study: counts by participant, condition and series, and what its protocol's analysis
// plan makes of them. Practice never counts; exclusions are the registered ones, each counted with its reason.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/detection/counts.h"
#include "analysis/detection/yes_no.h"
#include "analysis/group/group.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "analysis/thresholds/jnd.h"
#include "data/results/threshold_method.h"
#include "data/study/study.h"
#include "data/study/study_admin.h"
#include "data/study/trial_rows.h"
#include "protocols/protocol.h"

namespace jnd {

// Which stiffness difference stands on the x axis of the fit: the one asked, or the one that the devices delivered.
// mixed: some of several cells had nothing delivered to measure and fell back on the nominal difference.
enum class DifferenceSource { nominal, delivered, mixed };
inline constexpr auto kDifferenceSourceWords = words<DifferenceSource>({{"nominal", DifferenceSource::nominal},
                                                                        {"delivered", DifferenceSource::delivered},
                                                                        {"mixed", DifferenceSource::mixed}});
std::string_view to_string(DifferenceSource source) noexcept;
// What the protocol's analysis plan registers: nominal or delivered.
DifferenceSource registered_source(const Protocol& protocol) noexcept;

// A mean of what was delivered and how much it rests on; stiffnesses in the study's unit. NaN for n = 0.
struct DeliveredMean {
  double mean = kNaN;
  int n = 0;
};

// Of some trials, and of these the sure answers (is_sure() of protocols/tasks/task.h).
struct HalfCounts {
  Counts counts, sure;
};

// One participant, condition and series.
struct CellResult {
  std::string participant;
  SessionKind kind = SessionKind::simulated;
  int condition = 0, series = 0;  // places in the protocol
  Counts counts;
  // Of these, the first and the second half as they were answered; all in the first of more than kMostInDetail people.
  std::array<HalfCounts, 2> halves{};
  int excluded = 0;  // trials left out by the registered rules
  int missing = 0;   // planned trials without an answer
  YesNo yes_no;      // under the registered correction
  // The x of the fit. By delivered stiffness it is delivered_difference where n > 0, else the nominal one.
  double difference = 0;
  DifferenceSource difference_source = DifferenceSource::nominal;  // nominal or delivered
  // Mean of |k2 - k1| over the counted trials with different stimuli in which both intervals have a fitted stiffness;
  // k is the mean over the interval's devices.
  DeliveredMean delivered_difference{};
  int without_fit = 0;  // the others of those trials
  // By nominal stiffness of the series' pair, the softer and the stiffer: mean k over the intervals that asked it.
  std::array<DeliveredMean, 2> delivered{};
  std::optional<int> group{};  // of the participant, place in Protocol::groups
};

// One participant and condition.
struct ThresholdResult {
  std::string participant;
  SessionKind kind = SessionKind::simulated;
  int condition = 0;
  JndEstimate jnd;
  double median_response_time_s = 0;                               // participant's own entries; NaN without one
  double mean_trial_s = 0;                                         // time per trial; NaN without one
  DifferenceSource difference_source = DifferenceSource::nominal;  // of the series in the fit
  std::optional<int> group{};                                      // of the participant, place in Protocol::groups
};

// Rows by participant: where groups of participants get different conditions, nobody has a row of them all.
template <typename Row>
struct ParticipantRows {
  std::string participant;
  std::optional<int> group;    // place in Protocol::groups
  std::vector<const Row*> of;  // by condition: null where the group does not get it
};
// rows: those of a participant together; of several of one participant and condition the first counts. They must
// outlive the result.
template <typename Row>
std::vector<ParticipantRows<Row>> by_participant(const std::vector<Row>& rows, std::size_t conditions) {
  std::vector<ParticipantRows<Row>> all;
  for (const Row& row : rows) {
    if (all.empty() || all.back().participant != row.participant)
      all.push_back({row.participant, row.group, std::vector<const Row*>(conditions, nullptr)});
    const Row*& place = all.back().of[static_cast<std::size_t>(row.condition)];
    if (place == nullptr) place = &row;
  }
  return all;
}

// One condition, over all who get it.
struct GroupResult {
  int condition = 0;
  JndGroup jnd;                                                    // mean, CI, median, ... with n used of N
  DifferenceSource difference_source = DifferenceSource::nominal;  // over all participants
};

struct ContrastResult {
  int a = 0, b = 0;
  MeanEstimate difference;  // paired JND difference a - b, in the study's unit, over participants with both
  DifferenceSource difference_source = DifferenceSource::nominal;  // of both conditions
};

struct SessionHead {
  std::string participant, session, hash;
  SessionKind kind = SessionKind::simulated;
  bool closed = false;
  bool unblinded = false;  // its operator saw forces
};

// Beyond this many participants a table of them all is too long to be read: what takes a fit or a bootstrap for each of them is
// left to studies of an ordinary size.
inline constexpr std::size_t kMostInDetail = 200;

// Who took part, in a study of whatever kind.
struct Attendance {
  SessionKind kind = SessionKind::simulated;
  int participants = 0;
  std::vector<SessionHead> heads;             // by participant
  std::vector<ExcludedParticipant> excluded;  // nothing of theirs is in the results
};

struct StudyAnalysis {
  Attendance attendance;
  DifferenceSource by = DifferenceSource::nominal;  // what was asked for: nominal or delivered
  ThresholdMethod method;                           // the registered one, behind every slope and JND here
  // Whether thresholds carry intervals: of the fit itself (maximum likelihood), or a bootstrap of least squares, which
  // is left out above 500 participants.
  bool intervals = true;
  std::vector<CellResult> cells;            // by participant, condition that they get, series
  std::vector<ThresholdResult> thresholds;  // by participant, condition that they get
  std::vector<GroupResult> group;           // by condition
  std::vector<ContrastResult> contrasts;
  std::map<std::string, int> exclusions;  // reason -> trials
};

// Sessions of one kind only: the three kinds are never pooled. by: nominal or delivered; without it, the registered
// one.
StudyAnalysis analyze(const Study& study, const Protocol& protocol, SessionKind kind);
StudyAnalysis analyze(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by);
// The same of trials that callers want for more than this.
StudyAnalysis analyze(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by,
                      const std::vector<SessionInfo>& sessions, const CountedTrials& trials);
// What counts: without the sessions of excluded participants. By participant number, then the participant's session.
std::vector<SessionInfo> sessions_of(const Study& study, SessionKind kind);
// sessions: those of sessions_of.
Attendance attendance_of(const Study& study, SessionKind kind, const std::vector<SessionInfo>& sessions);
// Each once, in the order of the sessions.
std::vector<std::string> participants_of(const std::vector<SessionInfo>& sessions);
// Those of one kind, in the order in which they were excluded.
std::vector<ExcludedParticipant> excluded_of(const Study& study, SessionKind kind);
// The kinds of which something counts, real first.
std::vector<SessionKind> kinds_in(const Study& study);

// The same from counts alone (no study), over nominal differences: counts do not say what was delivered. Cells of one
// participant and condition.
struct CellCounts {
  std::string participant;
  int condition = 0, series = 0;
  Counts counts;
  std::optional<int> group{};  // of the participant, place in Protocol::groups
};
StudyAnalysis analyze_counts(const std::vector<CellCounts>& cells, const Protocol& protocol, SessionKind kind);

}  // namespace jnd
