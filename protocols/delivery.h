// What a rig of the laboratory's own delivered, by its own measure, against what it was asked for.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

// A measured value may be off by this share of what was asked for, or of a tenth of the largest value there is: more is
// no noise of a measurement.
inline constexpr double kDeliveryTolerance = 0.2;

inline bool is_as_asked(double asked, double delivered, double largest) noexcept {
  return std::abs(delivered - asked) <= kDeliveryTolerance * std::max(std::abs(asked), 0.1 * std::abs(largest));
}

// The largest value that a protocol presents.
inline double largest_value(const Protocol& protocol) noexcept {
  double largest = 0;
  for (const Series& series : protocol.series)
    for (const double value : series.pair) largest = std::max(largest, std::abs(value));
  return largest;
}

// Intervals of trials.
struct Deliveries {
  int measured = 0;  // the rig said what it delivered
  int off = 0;       // of these, not as asked
  void add(double asked, double delivered, double largest) noexcept {
    ++measured;
    off += is_as_asked(asked, delivered, largest) ? 0 : 1;
  }
};

inline Deliveries deliveries_of(const std::vector<TrialRecord>& trials, const Protocol& protocol) {
  Deliveries deliveries;
  const double largest = largest_value(protocol);
  for (const TrialRecord& record : trials)
    for (std::size_t i = 0; i < record.presentations.size(); ++i) {
      const bool set = i + 1 == record.presentations.size() && !record.settings.empty();  // by the participant
      if (const std::optional<double>& delivered = record.presentations[i].delivered)
        deliveries.add(set ? record.settings.back() : record.trial.stimuli[i], *delivered, largest);
    }
  return deliveries;
}

}  // namespace jnd
