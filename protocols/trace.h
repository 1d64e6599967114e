// What a rig that is none of our devices measured while an interval was felt: samples of the channels that it names, such
// as a grip force. It is stored beside the trial (data/log/trace_blob.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace jnd {

struct Trace {
  struct Channel {
    std::string name, unit;  // as the rig's hello has them; at most 40 bytes of UTF-8 each
    bool operator==(const Channel&) const = default;
  };
  struct Sample {
    double heard_s = 0;  // when it came, since the interval began, on this program's clock
    double rig_s = 0;    // when it was measured, on the rig's own clock
    int channel = 0;     // place in `channels`
    double value = 0;    // in its unit
    bool operator==(const Sample&) const = default;
  };
  std::vector<Channel> channels;
  std::vector<Sample> samples;  // in the order in which they came
  std::int64_t dropped = 0;     // that were lost before they could be kept
};

}  // namespace jnd
