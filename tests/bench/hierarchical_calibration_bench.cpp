// Coverage of the hierarchical model's profile intervals, size of its tests, and uniformity of ranks, on drawn studies
// of the published design (tests/analysis/hierarchical/hierarchical_calibration.h).
//
//   hierarchical_calibration_bench [STUDIES [REPLICATES [THREADS]]]    2000 studies of either kind for 12 and for 18
//                                                                     people, 19 replicates of the bootstrap, 2 threads
//
// Prints progress on standard error; Ctrl-C ends it with the table of what is done. A study is the same whatever the
// number of studies and threads. Aims: 93 to 97 % of intervals hold the truth, tests reject 4 to 6 %, nothing is
// undefined, ranks are uniform.
#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "tests/analysis/hierarchical/hierarchical_calibration.h"

namespace {

using namespace jnd;
using namespace jnd::testing;

using Tally = HierarchicalCalibration;

constexpr std::uint64_t kPublishedSeed = 2017, kEqualSeed = 2018;
constexpr std::array kSizes = {12, 18};
constexpr std::array kConditions = {"SV", "S", "V"}, kPairs = {"SV : S", "SV : V", "S : V"};

void request_stop(int /*signal*/) {
  stop_requested() = true;
}

std::string share_text(const CountedShare& share) {
  return share.of == 0 ? "-" : fmt::format("{:.2f} ± {:.2f} %", 100 * share.rate(), 100 * share.error());
}

std::string mean_text(const CountedMoments& moments) {
  return moments.of == 0 ? "-" : fmt::format("{:.3f} ± {:.3f}", moments.mean(), moments.error());
}

std::string ranks_text(const RankHistogram& ranks) {
  return ranks.of == 0 ? "-" : fmt::format("{:.1f}, p {:.2g} of {}", ranks.chi_square(), ranks.p(), ranks.of);
}

CountedShare all_of(const std::array<CountedShare, 3>& shares) {
  CountedShare sum;
  for (const CountedShare& one : shares) sum += one;
  return sum;
}

// Each row's name and what it says of the studies of one size.
std::vector<std::pair<std::string, std::string>> rows_of(const Tally& tally) {
  std::vector<std::pair<std::string, std::string>> rows;
  const auto add = [&rows](std::string name, std::string text) { rows.emplace_back(std::move(name), std::move(text)); };
  const auto add_three = [&](const char* what, const std::array<const char*, 3>& of,
                             const std::array<CountedShare, 3>& shares) {
    for (std::size_t i = 0; i < 3; ++i) add(fmt::format("{}, {}", what, of[i]), share_text(shares[i]));
    add(fmt::format("{}, all", what), share_text(all_of(shares)));
  };
  add("studies of the published JNDs", fmt::format("{}", tally.error_of_s.of + tally.undefined));
  add("undefined", fmt::format("{}", tally.undefined));
  add("intervals with an open end", fmt::format("{}", tally.open_ends));
  if (tally.error_of_s.of > 0) add("RMSE of ln JND, S", fmt::format("{:.4f}", tally.error_of_s.root_mean_square()));
  add("bias of ln JND, S", mean_text(tally.error_of_s));
  add_three("95 % interval of a JND", kConditions, tally.means);
  add("the same with t squared, all", share_text(tally.wider_means));
  for (std::size_t i = 0; i < 3; ++i)
    add(fmt::format("mean statistic at the truth, {}", kConditions[i]), mean_text(tally.lr_means[i]));
  add_three("95 % interval of a ratio", kPairs, tally.differences);
  add("the same with t squared, all", share_text(tally.wider_differences));
  for (std::size_t i = 0; i < 3; ++i)
    add(fmt::format("mean statistic at the truth, {}", kPairs[i]), mean_text(tally.lr_differences[i]));
  add("ranks of people at the truth, chi-square of 19", ranks_text(tally.people_at_truth));
  add("ranks of people at the estimates", ranks_text(tally.people_at_estimates));
  add("range of a person, mean ± 1.96 sd at the estimates", share_text(tally.people_inside));
  add("studies of equal JNDs", fmt::format("{}", tally.rejected.of));
  add("p of one JND below 5 %", share_text(tally.rejected));
  add("mean statistic of one JND, of 2", mean_text(tally.lr_equal));
  add_three("p of a ratio of 1 below 5 %", kPairs, tally.rejected_pairs);
  add("the same with t squared, all", share_text(tally.rejected_pairs_wider));
  add("rank of the statistic in the bootstrap", ranks_text(tally.statistic));
  add("p of the bootstrap at most 5 %", share_text(tally.rejected_by_bootstrap));
  return rows;
}

void print_table(const std::array<Tally, kSizes.size()>& tallies) {
  fmt::print("| |");
  for (const int people : kSizes) fmt::print(" {} people |", people);
  fmt::print("\n|---|");
  for (std::size_t i = 0; i < kSizes.size(); ++i) fmt::print("---:|");
  fmt::print("\n");
  const auto first = rows_of(tallies[0]);
  for (std::size_t row = 0; row < first.size(); ++row) {
    fmt::print("| {} |", first[row].first);
    for (const Tally& tally : tallies) fmt::print(" {} |", rows_of(tally)[row].second);
    fmt::print("\n");
  }
}

}  // namespace

int main(int count, char** arguments) {
  const auto number = [&](int place, int otherwise) { return place < count ? std::atoi(arguments[place]) : otherwise; };
  const int studies = number(1, 2000), replicates = number(2, 19), threads = number(3, 2);
  if (studies < 1 || replicates < 0 || threads < 1) {
    fmt::print(stderr, "usage: hierarchical_calibration_bench [STUDIES [REPLICATES [THREADS]]]\n");
    return 2;
  }
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  std::array<Tally, kSizes.size()> tallies;
  for (std::size_t i = 0; i < kSizes.size(); ++i) tallies[i].participants = kSizes[i];
  // Sizes take turns, so that what is interrupted has as many of each.
  const int steps = studies * static_cast<int>(kSizes.size());
  std::atomic<int> next{0};
  int done = 0;
  std::mutex mutex;
  const auto work = [&] {
    try {
      for (int step = next++; step < steps; step = next++) {
        stop_if_requested();
        const auto size = static_cast<std::size_t>(step) % kSizes.size();
        const auto study = static_cast<std::uint64_t>(step) / kSizes.size();
        Tally tally;
        tally.participants = kSizes[size];
        tally.add_published(kPublishedSeed, study);
        tally.add_equal(kEqualSeed, study, replicates);
        const std::lock_guard lock(mutex);
        tallies[size] += tally;
        if (++done % 20 == 0) fmt::print(stderr, "\r{} of {} studies of either kind", done, steps);
      }
    } catch (const Stopped&) {
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < threads; ++i) workers.emplace_back(work);
  }
  fmt::print(stderr, "\n");
  print_table(tallies);
  return stop_requested() ? 130 : 0;
}
