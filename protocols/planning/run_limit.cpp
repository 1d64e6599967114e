#include "protocols/planning/run_limit.h"

#include <algorithm>
#include <stdexcept>

namespace jnd {
namespace {

constexpr int kMostTrials = 1000;

// ways(first, same, different): sequences of the rest that begin with a run of class `first` (1 = same).
class RunCounts {
 public:
  RunCounts(int same, int different, int limit)
      : width_(static_cast<std::size_t>(different) + 1),
        limit_(limit),
        ways_(2 * (static_cast<std::size_t>(same) + 1) * width_) {
    for (int s = 0; s <= same; ++s) {
      for (int d = 0; d <= different; ++d) {
        for (const int first : {0, 1}) {
          double& ways = ways_[place(first, s, d)];
          if (s == 0 && d == 0) {
            ways = 1;  // nothing is left: one way to end
            continue;
          }
          for (int run = 1; run <= longest(first, s, d); ++run) ways += after(first, run, s, d);
        }
      }
    }
  }

  double ways(int first, int same, int different) const { return ways_[place(first, same, different)]; }
  int longest(int first, int same, int different) const { return std::min(limit_, first == 1 ? same : different); }
  // The ways that remain after a run of class `first`: the other class must follow.
  double after(int first, int run, int same, int different) const {
    return first == 1 ? ways(0, same - run, different) : ways(1, same, different - run);
  }

 private:
  std::size_t place(int first, int same, int different) const {
    return 2 * (static_cast<std::size_t>(same) * width_ + static_cast<std::size_t>(different)) +
           static_cast<std::size_t>(first);
  }
  std::size_t width_;
  int limit_;
  std::vector<double> ways_;
};

}  // namespace

std::vector<bool> draw_limited_sequence(int same, int different, int limit, RandomStream& stream) {
  if (same < 0 || different < 0 || limit < 1 || same + different > kMostTrials)
    throw std::invalid_argument("a run limit needs limit >= 1 and 0 to 1000 trials");
  std::vector<bool> sequence;
  if (same + different == 0) return sequence;
  const RunCounts counts(same, different, limit);
  const double all = counts.ways(0, same, different) + counts.ways(1, same, different);
  if (!(all > 0)) throw std::invalid_argument("no sequence of these classes keeps the run limit");

  int first = stream.uniform() * all < counts.ways(1, same, different) ? 1 : 0;
  while (same + different > 0) {
    // Inverse of the cumulative counts; rounding can at most fall through to the last possible run.
    double rest = stream.uniform() * counts.ways(first, same, different);
    int run = 0;
    for (int candidate = 1; candidate <= counts.longest(first, same, different); ++candidate) {
      const double ways = counts.after(first, candidate, same, different);
      if (ways <= 0) continue;
      run = candidate;
      if (rest < ways) break;
      rest -= ways;
    }
    sequence.insert(sequence.end(), static_cast<std::size_t>(run), first == 1);
    (first == 1 ? same : different) -= run;
    first = 1 - first;
  }
  return sequence;
}

}  // namespace jnd
