#include "protocols/planning/specimen_codes.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "protocols/planning/allotment.h"
#include "protocols/random_stream.h"

namespace jnd {

namespace {

constexpr int kOnlookers = 20;
constexpr int kUnlearned = 12;  // trials at the beginning, of which none is judged
constexpr std::uint64_t kAnySeed = 1;
constexpr std::uint64_t kAttempts = 1U << 16U;  // of a trial, at most

struct Guesses {
  int right = 0, alike = 0, all = 0;
};

// One session, watched.
void watch(const Protocol& protocol, const Plan& plan, Guesses& guesses) {
  std::map<std::pair<std::string, std::string>, int> together;
  int most = 0, seen = 0;
  for (const Trial& trial : plan.trials) {
    const std::vector<std::string> codes = specimen_codes(protocol, plan, trial.index, 1, trial.stimuli);
    ++seen;
    for (std::size_t i = 0; i < codes.size(); ++i)
      for (std::size_t j = i + 1; j < codes.size(); ++j) {
        int& count = together[std::minmax(codes[i], codes[j])];
        const bool alike = trial.stimuli[i] == trial.stimuli[j];
        if (seen > kUnlearned) {
          guesses.right += (2 * count > most) == alike ? 1 : 0;
          guesses.alike += alike ? 1 : 0;
          ++guesses.all;
        }
        most = std::max(most, ++count);
      }
  }
}

}  // namespace

std::vector<std::string> specimen_codes(const Protocol& protocol, const Plan& plan, int trial, int attempt,
                                        const Intervals& values) {
  RandomStream stream(plan.seed, static_cast<std::uint64_t>(plan.participant),
                      fmt::format("specimens/{}", plan.session),
                      static_cast<std::uint64_t>(trial) * kAttempts + static_cast<std::uint64_t>(attempt));
  std::vector<std::string> codes(values.size());
  for (const Specimen& specimen : protocol.rig.specimens) {
    std::vector<std::string> order = specimen.codes;
    stream.shuffle(order);  // also of a value that does not come: what others draw does not depend on it
    std::size_t next = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i] == specimen.value && !order.empty()) codes[i] = order[next++ % order.size()];
  }
  return codes;
}

std::optional<ToldByCodes> told_by_codes(const Protocol& protocol, int codes) {
  Protocol watched = protocol;
  if (codes > 0)
    for (std::size_t value = 0; value < watched.rig.specimens.size(); ++value) {
      watched.rig.specimens[value].codes.clear();
      for (int i = 0; i < codes; ++i) watched.rig.specimens[value].codes.push_back(fmt::format("{}-{}", value, i));
    }
  Guesses guesses;
  const int first = first_of(protocol, largest_plan(protocol), kAnySeed);
  for (int onlooker = 0; onlooker < kOnlookers; ++onlooker)
    watch(watched, make_plan(protocol, first, kAnySeed + static_cast<std::uint64_t>(onlooker)), guesses);
  if (guesses.alike == 0 || guesses.alike == guesses.all) return std::nullopt;
  const double all = guesses.all;
  return ToldByCodes{guesses.right / all, std::max(guesses.alike, guesses.all - guesses.alike) / all};
}

}  // namespace jnd
