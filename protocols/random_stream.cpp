#include "protocols/random_stream.h"

#include <Random123/philox.h>

#include "analysis/numerics/normal.h"

namespace jnd {

RandomStream::RandomStream(std::uint64_t study_seed, std::uint64_t participant, std::string_view purpose,
                           std::uint64_t part) noexcept
    : key_{study_seed, hash_of_name(purpose)}, counter_{0, part, participant, 0} {}

void RandomStream::refill() noexcept {
  const r123::Philox4x64::ctr_type counter{{counter_[0], counter_[1], counter_[2], counter_[3]}};
  const r123::Philox4x64::key_type key{{key_[0], key_[1]}};
  const r123::Philox4x64::ctr_type block = r123::Philox4x64{}(counter, key);
  for (unsigned i = 0; i < 4; ++i) block_[i] = block[i];
  ++counter_[0];
  used_ = 0;
}

std::uint64_t RandomStream::next() noexcept {
  if (used_ == 4) refill();
  return block_[used_++];
}

std::uint64_t RandomStream::below(std::uint64_t bound) noexcept {
  // Values at the top that would make the first remainders likelier are drawn again.
  const std::uint64_t surplus = (0 - bound) % bound;  // 2^64 mod bound
  std::uint64_t value = next();
  while (value < surplus) value = next();
  return value % bound;
}

double RandomStream::uniform() noexcept {
  // The middles of 2^52 equal steps: never 0, never 1.
  return (static_cast<double>(next() >> 12U) + 0.5) * 0x1.0p-52;
}

double RandomStream::normal() noexcept {
  return normal_quantile(uniform());
}

}  // namespace jnd
