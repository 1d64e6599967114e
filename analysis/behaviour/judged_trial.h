// One same-different trial as a plain record, for questions about the order and the time of trials.
#pragma once

#include <span>
#include <vector>

#include "analysis/detection/counts.h"

namespace jnd {

struct JudgedTrial {
  bool same = false;            // the two stimuli were equal
  bool first_stiffer = false;   // of different stimuli, the stiffer came in the first interval; unused where same
  bool said_different = false;  // the answer
  double difference = 0;        // between the stimuli, N/m; 0 where same
  double time_fraction = 0;     // place in the session, 0 (first trial) .. 1 (last)

  bool correct() const noexcept { return said_different != same; }
};

// The four numbers of a cell, over all of the trials.
Counts counts_of(std::span<const JudgedTrial> trials) noexcept;

// k of n as a share with its Wilson score interval, 95 % (Wilson 1927, J Am Stat Assoc 22:209).
struct Share {
  int k = 0, n = 0;
  double value = 0;                // k / n; NaN for n = 0
  double ci_low = 0, ci_high = 0;  // in 0..1; NaN for n = 0
};
Share share_of(int k, int n) noexcept;  // 0 <= k <= n

}  // namespace jnd
