// Same-different with given levels: counts by participant, condition and series, d' of each, and the JND by the slope of
// d' on the difference.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/detection/counts.h"
#include "analysis/detection/yes_no.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "analysis/thresholds/jnd.h"
#include "data/study/study.h"
#include "data/study/trial_rows.h"
#include "data/task_results/threshold_method.h"
#include "protocols/protocol.h"
#include "protocols/tasks/task.h"

namespace jnd {

struct TaskResults;

// Which difference of the stimuli stands on the x axis of the fit: the one asked, or the one that the devices delivered.
// mixed: some of several cells had nothing delivered to measure and fell back on the nominal difference.
enum class DifferenceSource { nominal, delivered, mixed };
inline constexpr auto kDifferenceSourceWords = words<DifferenceSource>({{"nominal", DifferenceSource::nominal},
                                                                        {"delivered", DifferenceSource::delivered},
                                                                        {"mixed", DifferenceSource::mixed}});
std::string_view to_string(DifferenceSource source) noexcept;
// What the protocol's analysis plan registers: nominal or delivered.
DifferenceSource registered_source(const Protocol& protocol) noexcept;
// What all of them are; mixed where they differ, nominal where there is none.
DifferenceSource combined(const std::vector<DifferenceSource>& sources) noexcept;

// A mean of what was delivered and how much it rests on; in the study's unit. NaN for n = 0.
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

// How JNDs come about.
struct PairMethod {
  DifferenceSource by = DifferenceSource::nominal;  // what was asked for: nominal or delivered
  ThresholdMethod method;                           // the registered one
  // Whether they carry intervals: of the fit itself (maximum likelihood), or a bootstrap of least squares, which is left out
  // above kMostInDetail participants.
  bool intervals = true;
};

// Beyond this many participants a table of them all is too long to be read: what takes a fit or a bootstrap for each of them is
// left to studies of an ordinary size.
inline constexpr std::size_t kMostInDetail = 200;

// Adds cells, estimates and exclusions. sessions: of one kind, by participant; trials: of these. seed: of the bootstrap.
void add_pairs(TaskResults& results, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
               const CountedTrials& trials, DifferenceSource by, std::uint64_t seed);

// The same from counts alone, over nominal differences: counts do not say what was delivered. Throws StorageError where a
// cell is not the protocol's.
struct CellCounts {
  std::string participant;
  int condition = 0, series = 0;
  Counts counts;
  std::optional<int> group{};  // of the participant, place in Protocol::groups
};
TaskResults results_of_counts(const std::vector<CellCounts>& cells, const Protocol& protocol, SessionKind kind);

// The cells of results.estimates[row], as every estimate takes them.
std::vector<SeriesCounts> series_of(const TaskResults& results, const Protocol& protocol, std::size_t row);
// As the task's outcomes have it: slope, JND and Weber fraction. reference: of the latter.
TaskEstimates estimates_of(const JndEstimate& estimate, double reference);

}  // namespace jnd
