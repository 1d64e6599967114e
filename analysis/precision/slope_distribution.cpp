#include "analysis/precision/slope_distribution.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/special_values.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

namespace {

constexpr double kMostSums = 3e7, kMostWrittenSums = 5e5;
constexpr double kSameSlope = 1e-12;  // relative; sums this close differ by rounding only

double mass(const CellDistribution& cell, bool informative) {
  double sum = 0;
  for (const CellState& state : cell.states)
    if (informative || !state.informative) sum += state.probability;
  return sum;
}

}  // namespace

double SlopeDistribution::combinations(std::span<const CellDistribution> cells) noexcept {
  double all = 1;
  for (const CellDistribution& cell : cells) all *= static_cast<double>(std::max<std::size_t>(cell.states.size(), 1));
  return all;
}

bool SlopeDistribution::feasible(std::span<const CellDistribution> cells) noexcept {
  double largest = 1;
  std::size_t may_miss = 0;
  for (const CellDistribution& cell : cells) {
    largest = std::max(largest, static_cast<double>(cell.states.size()));
    if (cell.missing > 0) ++may_miss;
  }
  const double all = combinations(cells);
  return all <= kMostSums && all / largest <= kMostWrittenSums && cells.size() <= (may_miss > 0 ? 8 : 63);
}

SlopeDistribution::SlopeDistribution(std::span<const CellDistribution> cells, std::span<const double> differences) {
  // Statuses by their definition (jnd.cpp): an undefined d' or opposite infinities leave no slope; +inf is the ceiling;
  // -inf no sensitivity; all series missing or without information: no information.
  double finite = 1, not_minus = 1, not_plus = 1, nothing = 1;
  for (const CellDistribution& cell : cells) {
    const double usable = mass(cell, true) + cell.missing;
    finite *= usable;
    not_minus *= usable + cell.plus_infinity;
    not_plus *= usable + cell.minus_infinity;
    nothing *= mass(cell, false) + cell.missing;
  }
  // Where no class can be empty, all series are present.
  const std::uint64_t all = (std::uint64_t{1} << cells.size()) - 1;
  const bool may_miss =
      std::any_of(cells.begin(), cells.end(), [](const CellDistribution& cell) { return cell.missing > 0; });
  for (std::uint64_t present = may_miss ? 1 : all; present <= all; ++present) {
    add_part(cells, differences, present, true);
    add_part(cells, differences, present, false);
  }
  status_.ceiling = not_minus - finite;
  status_.ok = slope_at_least(kLeastSlope);
  status_.no_sensitivity = std::max(finite - nothing - status_.ok, 0.0) + (not_plus - finite);
  status_.no_information = std::max(1 - status_.ceiling - status_.ok - status_.no_sensitivity, 0.0);
}

// The sums of the series in `present`, the others missing. informative: all of them; otherwise those of series without
// any information, which are no slopes and so are taken off again.
void SlopeDistribution::add_part(std::span<const CellDistribution> cells, std::span<const double> differences,
                                 std::uint64_t present, bool informative) {
  Part part;
  part.sign = informative ? 1 : -1;
  double squares = 0, others_missing = 1;
  std::vector<std::vector<Atom>> series;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if ((present >> i & 1U) == 0) {
      others_missing *= cells[i].missing;
      continue;
    }
    squares += differences[i] * differences[i];
    std::vector<Atom> atoms;
    for (const CellState& state : cells[i].states) {
      if (!informative && state.informative) continue;
      const double value = differences[i] * state.dprime;
      if (!atoms.empty() && value - atoms.back().value <= kSameSlope * differences[i])
        atoms.back().probability += state.probability;
      else
        atoms.push_back({value, state.probability});
    }
    series.push_back(std::move(atoms));
  }
  if (others_missing == 0) return;
  for (const std::vector<Atom>& atoms : series)
    if (atoms.empty()) return;
  part.scale = 1 / squares;

  // The largest series stays apart: its sums with the others are never written down.
  std::sort(series.begin(), series.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  part.last = std::move(series.back());
  series.pop_back();
  part.head = {{0, others_missing}};
  const double tolerance = kSameSlope * std::sqrt(squares);
  for (const std::vector<Atom>& atoms : series) {
    std::vector<Atom> sums;
    sums.reserve(part.head.size() * atoms.size());
    for (const Atom& a : part.head)
      for (const Atom& b : atoms) sums.push_back({a.value + b.value, a.probability * b.probability});
    std::sort(sums.begin(), sums.end(), [](const Atom& a, const Atom& b) { return a.value < b.value; });
    std::size_t size = 0;
    for (const Atom& sum : sums) {
      if (size > 0 && sum.value - sums[size - 1].value <= tolerance)
        sums[size - 1].probability += sum.probability;
      else
        sums[size++] = sum;
    }
    sums.resize(size);
    part.head = std::move(sums);
  }
  double tail = 0;
  for (std::size_t i = part.head.size(); i-- > 0;) {
    tail += part.head[i].probability;
    part.head[i].tail = tail;
  }
  parts_.push_back(std::move(part));
}

double SlopeDistribution::slope_at_least(double slope) const {
  double sum = 0;
  for (const Part& part : parts_) {
    const double least = slope / part.scale;
    const double tolerance = 4 * kSameSlope / std::sqrt(part.scale);
    double of_part = 0;
    for (const Atom& last : part.last) {
      const double wanted = least - last.value - (slope > kLeastSlope ? tolerance : 0);
      const auto from = std::lower_bound(part.head.begin(), part.head.end(), wanted,
                                         [](const Atom& atom, double value) { return atom.value < value; });
      if (from != part.head.end()) of_part += last.probability * from->tail;
    }
    sum += part.sign * of_part;
  }
  return std::max(sum, 0.0);
}

double SlopeDistribution::steepest() const noexcept {
  double steepest = 0;
  for (const Part& part : parts_)
    steepest = std::max(steepest, part.scale * (part.head.back().value + part.last.back().value));
  return steepest;
}

double SlopeDistribution::jnd_quantile(double share) const {
  const double with_information = 1 - status_.no_information;
  if (!(with_information > 0)) return kNaN;
  const double wanted = share * with_information - status_.ceiling;
  if (wanted <= 0) return 0;
  if (status_.ok < wanted) return kInf;
  // The largest slope that this share reaches; the estimates are steps, and the bisection ends at one of them.
  double low = kLeastSlope, high = 1.01 * steepest() + kLeastSlope;
  while (high - low > 1e-13 * high) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (slope_at_least(middle) >= wanted ? low : high) = middle;
  }
  return 1 / low;
}

double SlopeDistribution::jnd_within(double low, double high) const {
  // Slopes above 1/low are the smaller JNDs; a relative step beyond rounding keeps JND = low inside.
  const double step = 1 + 1e-9;
  return std::max(slope_at_least(1 / (high * step)) - slope_at_least(step / low), 0.0);
}

double SlopeDistribution::mean_jnd() const {
  double sum = 0;
  for (const Part& part : parts_) {
    double of_part = 0;
    for (const Atom& last : part.last) {
      const double least = kLeastSlope / part.scale - last.value;
      auto from = std::lower_bound(part.head.begin(), part.head.end(), least,
                                   [](const Atom& atom, double value) { return atom.value < value; });
      // Four sums at a time, for the processor's sake; their order is fixed.
      double sums[4] = {0, 0, 0, 0};
      for (; part.head.end() - from >= 4; from += 4)
        for (int i = 0; i < 4; ++i) sums[i] += from[i].probability / (from[i].value + last.value);
      for (; from != part.head.end(); ++from) sums[0] += from->probability / (from->value + last.value);
      of_part += last.probability * ((sums[0] + sums[1]) + (sums[2] + sums[3]));
    }
    sum += part.sign * of_part / part.scale;
  }
  return status_.ok > 0 ? sum / status_.ok : kNaN;
}

}  // namespace jnd
