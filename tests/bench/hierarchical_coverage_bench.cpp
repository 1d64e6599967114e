// Coverage of the hierarchical model's profile intervals, and size of its test of a ratio: with few people, with large
// spreads, and with spreads that differ between conditions: with one tv in the model, and with one of each condition's own.
//
//   hierarchical_coverage_bench [STUDIES [THREADS]]    400 studies of either kind per row, 2 threads
//
// Studies have two conditions of the published design. Intervals are counted in studies with true JNDs of 208.5 and
// 283.5, tests in studies where both are 283.5.
//
// Prints progress on standard error; Ctrl-C prints the table of the studies done so far. A study is the same whatever
// the number of studies and threads.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "tests/analysis/hierarchical/hierarchical_calibration.h"

namespace {

using namespace jnd;
using namespace jnd::testing;

// tu, and tv in either condition.
constexpr std::array<std::array<double, 3>, 3> kSpreads = {{{.25, .15, .15}, {.6, .3, .3}, {.25, .15, .45}}};
constexpr std::uint64_t kSeed = 2019, kEqualSeed = 3019;  // of the first row; the next rows count on

struct Row {
  std::uint64_t number;
  int people;
  double tu;
  std::array<double, 2> tv;  // by condition
  bool own_tv;               // in the model
  int studies = 0;
  int without_jnd = 0;                 // studies with a condition without a JND: none of their intervals is counted
  int without_test = 0;                // studies of equal JNDs with a condition that is left out of the model
  std::array<CountedShare, 2> jnds{};  // these three: of the other studies whose intervals have both ends
  CountedMoments both{};               // mean per study, because its intervals depend on each other
  CountedShare ratio{};
  CountedMoments open_ended{};  // of all intervals of a study with an open end
  CountedShare rejected{};

  void add(std::uint64_t study, std::mutex& mutex) {
    const std::array truth = {std::log(208.5), std::log(283.5), std::log(208.5 / 283.5)};
    HierarchicalAnalysis analysis(drawn({208.5, 283.5}, kSeed, study), {.own_tv = own_tv});
    const HierarchicalFit& fit = analysis.complete({.intervals = true, .pairs = {{0, 1}}});
    HierarchicalAnalysis equal(drawn({283.5, 283.5}, kEqualSeed, study), {.own_tv = own_tv});
    const double drop = equal.drop_of_difference(0, 1, 0);
    const std::array ends = {fit.conditions[0].ends, fit.conditions[1].ends, fit.differences[0].ends};
    const bool found = fit.maximum.converged && !std::isnan(fit.differences[0].difference);
    const bool closed = std::all_of(ends.begin(), ends.end(), [](const ProfileEnds& one) {
      return std::isfinite(one.low) && std::isfinite(one.high);
    });
    const auto held = [&](std::size_t i) { return ends[i].low <= truth[i] && truth[i] <= ends[i].high; };

    const std::lock_guard lock(mutex);
    ++studies;
    without_jnd += found ? 0 : 1;
    without_test += std::isnan(drop) ? 1 : 0;
    if (!std::isnan(drop)) rejected.add(chi2_upper(2 * drop, 1) < HierarchicalCalibration::kAlpha);
    if (found && !closed) open_ended.add((held(0) + held(1) + held(2)) / 3.0);
    if (!found || !closed) return;
    for (std::size_t c = 0; c < 2; ++c) jnds[c].add(held(c));
    both.add((held(0) + held(1)) / 2.0);
    ratio.add(held(2));
  }

 private:
  std::vector<HierarchicalCell> drawn(const std::vector<double>& true_jnds, std::uint64_t seed,
                                      std::uint64_t study) const {
    HierarchicalPlace truth = drawn_population(true_jnds);
    truth.tu = tu;
    return known_study(people, truth, seed + number, study, tv).cells;
  }
};

template <typename Counted>
std::string percent(const Counted& counted, double rate) {
  return counted.of == 0 ? "-" : fmt::format("{:.1f} ± {:.1f} %", 100 * rate, 100 * counted.error());
}

void print_table(const std::vector<Row>& rows) {
  fmt::print(
      "| people | tu | tv | JND | JND, first condition | second | ratio | test of a ratio of 1, p < .05 | "
      "studies | without a JND | with an open end | their intervals | without a test |\n|");
  for (int i = 0; i < 13; ++i) fmt::print("---:|");
  for (const Row& row : rows)
    fmt::print("\n| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |", row.people, row.tu,
               row.tv[0] == row.tv[1] ? fmt::format("{}", row.tv[0])
                                      : fmt::format("{}, {}{}", row.tv[0], row.tv[1], row.own_tv ? " (own)" : ""),
               percent(row.both, row.both.mean()), percent(row.jnds[0], row.jnds[0].rate()),
               percent(row.jnds[1], row.jnds[1].rate()), percent(row.ratio, row.ratio.rate()),
               percent(row.rejected, row.rejected.rate()), row.studies, row.without_jnd, row.open_ended.of,
               percent(row.open_ended, row.open_ended.mean()), row.without_test);
  fmt::print("\n");
}

}  // namespace

int main(int count, char** arguments) {
  const int studies = count > 1 ? std::atoi(arguments[1]) : 400, threads = count > 2 ? std::atoi(arguments[2]) : 2;
  if (studies < 1 || threads < 1) {
    fmt::print(stderr, "usage: hierarchical_coverage_bench [STUDIES [THREADS]]\n");
    return 2;
  }
  const auto stop = [](int /*signal*/) { stop_requested() = true; };
  std::signal(SIGINT, stop);
  std::signal(SIGTERM, stop);
  std::vector<Row> rows;
  for (const auto& [tu, first, second] : kSpreads)
    for (const int people : {3, 6, 12}) rows.push_back({rows.size(), people, tu, {first, second}, false});
  for (std::size_t i = 0; i < 3; ++i) {  // the same studies as the last three
    Row row = rows[rows.size() - 3];
    row.own_tv = true;
    rows.push_back(row);
  }
  // Rows take turns, so that what is interrupted has as many studies of each.
  const std::size_t steps = static_cast<std::size_t>(studies) * rows.size();
  std::atomic<std::size_t> next{0}, done{0};
  std::mutex mutex;
  const auto work = [&] {
    try {
      for (std::size_t step = next++; step < steps; step = next++) {
        stop_if_requested();
        rows[step % rows.size()].add(step / rows.size(), mutex);
        fmt::print(stderr, "\r{} of {} studies of either kind", ++done, steps);
      }
    } catch (const Stopped&) {
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < threads; ++i) workers.emplace_back(work);
  }
  fmt::print(stderr, "\n");
  print_table(rows);
  return stop_requested() ? 130 : 0;
}
