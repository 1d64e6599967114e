// Counter-based random numbers: every draw is a pure function of (study seed, participant, purpose, part, position).
//
// A stream has no hidden state that another stream could disturb: adding a condition, a participant or a trial never
// changes what any other stream gives. The integers are the same on every machine, for ever; normals go through an
// inverse CDF and agree within rounding.
//
// Generator: kGeneratorName (Salmon, Moraes, Dror, Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3"),
// key = (study seed, hash of the purpose), counter = (position, part, participant, 0).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace jnd {

// What the program calls the generator wherever it names it: Philox on four words of 64 bits, ten rounds.
inline constexpr std::string_view kGeneratorName = "Philox4x64-10";

// FNV-1a, 64 bits: names of purposes become numbers. Fixed: changing it would change every plan.
constexpr std::uint64_t hash_of_name(std::string_view name) noexcept {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char character : name) {
    hash ^= static_cast<std::uint8_t>(character);
    hash *= 1099511628211ULL;
  }
  return hash;
}

class RandomStream {
 public:
  // participant: 0 for what belongs to the whole study. purpose: a fixed name, such as "classes/1/SV".
  // part: separates streams of one purpose, such as a trial's index.
  RandomStream(std::uint64_t study_seed, std::uint64_t participant, std::string_view purpose,
               std::uint64_t part = 0) noexcept;

  std::uint64_t next() noexcept;                         // uniform over all 64-bit values
  std::uint64_t below(std::uint64_t bound) noexcept;     // uniform over 0..bound-1, without modulo bias; bound >= 1
  bool coin() noexcept { return (next() >> 63U) != 0; }  // true half the time
  double uniform() noexcept;                             // open interval (0, 1)
  double normal() noexcept;                              // mean 0, standard deviation 1, by inverse CDF

  // Fisher-Yates: every order of the elements is equally likely.
  template <typename Container>
  void shuffle(Container& container) noexcept {
    for (std::size_t remaining = container.size(); remaining > 1; --remaining) {
      using std::swap;
      swap(container[remaining - 1], container[static_cast<std::size_t>(below(remaining))]);
    }
  }

 private:
  void refill() noexcept;

  std::array<std::uint64_t, 2> key_;
  std::array<std::uint64_t, 4> counter_;
  std::array<std::uint64_t, 4> block_{};
  unsigned used_ = 4;
};

}  // namespace jnd
