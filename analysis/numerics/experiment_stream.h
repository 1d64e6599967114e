// Random numbers of simulated experiments: the same for the same seed on every machine, whatever was drawn before.
//
// Generator: Philox4x64-10 (Salmon, Moraes, Dror, Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3"), key =
// (seed, purpose), counter = (position, experiment, participant, 0): every participant has numbers of their own, in
// whatever order or on however many threads experiments run.
#pragma once

#include <cstdint>

#include <Random123/philox.h>

namespace jnd {

class ExperimentStream {
 public:
  // purpose: keeps different uses of one seed apart.
  ExperimentStream(std::uint64_t seed, std::uint64_t purpose, std::uint64_t experiment,
                   std::uint64_t participant = 0) noexcept
      : key_{{seed, purpose}}, counter_{{0, experiment, participant, 0}} {}

  std::uint64_t next() noexcept {  // uniform over all 64-bit values
    if (used_ == 4) {
      block_ = r123::Philox4x64{}(counter_, key_);
      ++counter_[0];
      used_ = 0;
    }
    return block_[used_++];
  }

 private:
  r123::Philox4x64::key_type key_;
  r123::Philox4x64::ctr_type counter_;
  r123::Philox4x64::ctr_type block_{};
  unsigned used_ = 4;
};

}  // namespace jnd
