// The long sums against loops that say what they are, to the last bit where their order is told.
#include "analysis/lattice/lattice_sums.h"

#include <cmath>
#include <vector>

#include "analysis/lattice/lattice_kernel.h"
#include "tests/catch.h"

namespace jnd {
namespace {

std::vector<double> wavy_numbers(std::size_t n, double phase) {
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(std::sin(phase + 1.7 * static_cast<double>(i)));
  return out;
}

TEST_CASE("rows of a table are read between, with their derivatives by the place", "[hierarchical]") {
  constexpr double kStep = 0.3, kNudge = 1e-6;
  constexpr std::size_t kWide = 7;
  std::vector<double> table;  // sin(k) times a number of the column
  for (int k = -20; k <= 20; ++k)
    for (std::size_t s = 0; s < kWide; ++s) table.push_back(std::sin(k * kStep) * (1 + static_cast<double>(s)));
  const auto read = [&](double at) {
    const LatticeKernel kernel(at, 1, 0, 0, 0, kStep, 0);
    std::vector<double> out(kWide), slope(kWide);
    interpolate_rows(&table[static_cast<std::size_t>(kernel.start(0) + 20) * kWide], kWide, kernel.weights(0),
                     kernel.by_centre(0), kWide, out.data(), slope.data());
    return std::pair{out, slope};
  };
  for (const double at : {-2.71, 0.0, 0.149, 1.5}) {
    const auto [out, slope] = read(at);
    for (std::size_t s = 0; s < kWide; ++s) {
      CAPTURE(at, s);
      CHECK(out[s] == Approx(std::sin(at) * (1 + static_cast<double>(s))).margin(1e-8));
      CHECK(slope[s] == Approx(std::cos(at) * (1 + static_cast<double>(s))).margin(1e-6));
      CHECK((read(at + kNudge).first[s] - read(at - kNudge).first[s]) / (2 * kNudge) == Approx(slope[s]).margin(1e-6));
    }
  }
}

TEST_CASE("weighted sums along a row, and back to the weights and the row", "[hierarchical]") {
  constexpr std::size_t kTaps = 11, kPlaces = 5;
  const std::vector<int> starts = {3, 4, 6, 9, 9};
  const std::vector<double> weights = wavy_numbers(kTaps * kPlaces, 0), row = wavy_numbers(18, 1),
                            by_sum = wavy_numbers(kPlaces, 2);
  const LatticeRow along{starts.data(), weights.data(), kTaps, kPlaces, 3};
  std::vector<double> sums(kPlaces), by_weights(kTaps * kPlaces, 0.5), by_row(row.size(), 0.25);
  weighted_sums(along, row.data(), sums.data());
  add_slopes(along, row.data(), by_sum.data(), by_weights.data(), by_row.data());
  std::vector<double> expected_by_row(row.size(), 0.25);
  for (std::size_t place = 0; place < kPlaces; ++place) {
    double lanes[4] = {0, 0, 0, 0};  // the order of the sum: every fourth, then what is left over with the first
    for (std::size_t tap = 0; tap < kTaps; ++tap) {
      const std::size_t node = static_cast<std::size_t>(starts[place] - 3) + tap, weight = place * kTaps + tap;
      lanes[tap < 8 ? tap % 4 : 0] += weights[weight] * row[node];
      CHECK(by_weights[weight] == 0.5 + by_sum[place] * row[node]);
      expected_by_row[node] += by_sum[place] * weights[weight];
    }
    CHECK(sums[place] == (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]));
  }
  CHECK(by_row == expected_by_row);
}

TEST_CASE("products, and answers added to a row", "[hierarchical]") {
  const std::vector<double> a = wavy_numbers(10, 0), b = wavy_numbers(10, 1), c = wavy_numbers(10, 2);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  CHECK(dot(a.data(), b.data(), a.size()) == Approx(sum).margin(1e-15));
  std::vector<double> row = c;
  add_answers(3, a.data(), 5, b.data(), row.size(), row.data());
  for (std::size_t i = 0; i < row.size(); ++i) CHECK(row[i] == c[i] + (3 * a[i] + 5 * b[i]));
}

}  // namespace
}  // namespace jnd
