// Long sums and long tables against loops and exact functions.
#include "analysis/lattice/lattice_sums.h"

#include <cmath>
#include <vector>

#include "analysis/lattice/fast_functions.h"
#include "analysis/lattice/lattice_kernel.h"
#include "analysis/numerics/normal.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// The long sums against loops that say what they are, to the last bit where their order is told.

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

TEST_CASE("weighted sums along rows, and back to the weights and the rows", "[hierarchical]") {
  constexpr std::size_t kPlaces = 5, kRows = 6, kNodes = 22;
  for (const std::size_t taps : {11UL, 16UL}) {
    const std::vector<int> starts = {3, 4, 6, 9, 9};
    const std::vector<double> weights = wavy_numbers(taps * kPlaces, 0), rows = wavy_numbers(kRows * kNodes, 1),
                              by_sum = wavy_numbers(kRows * kPlaces, 2), by_variable = wavy_numbers(kRows * kNodes, 3);
    const LatticeRows along{starts.data(), weights.data(), taps, kPlaces, 3, kRows, kNodes};
    std::vector<double> sums(kRows * kPlaces), by_weights(taps * kPlaces, 0.5), by_row(kNodes, 0.25);
    weighted_sums(along, rows.data(), sums.data());
    const double changes = slopes_by_weights(along, rows.data(), by_variable.data(), by_sum.data(), by_weights.data());
    add_slopes(along, by_sum.data(), by_row.data());
    std::vector<double> expected_by_row(kNodes, 0.25);
    double expected_changes = 0;
    for (std::size_t place = 0; place < kPlaces; ++place) {
      double lanes[kRows][5] = {};  // the order of the sums: every fourth, and what is left over
      for (std::size_t tap = 0; tap < taps; ++tap) {
        const std::size_t node = static_cast<std::size_t>(starts[place] - 3) + tap, weight = place * taps + tap;
        double by_weight = 0;
        for (std::size_t row = 0; row < kRows; ++row) {
          lanes[row][tap < taps - taps % 4 ? tap % 4 : 4] += weights[weight] * rows[row * kNodes + node];
          by_weight += by_sum[row * kPlaces + place] * rows[row * kNodes + node];
          expected_changes += by_sum[row * kPlaces + place] * weights[weight] * by_variable[row * kNodes + node];
        }
        CHECK(by_weights[weight] == by_weight);
        expected_by_row[node] += by_sum[place] * weights[weight];
      }
      for (std::size_t row = 0; row < kRows; ++row)
        CHECK(sums[row * kPlaces + place] ==
              (lanes[row][0] + lanes[row][1]) + (lanes[row][2] + lanes[row][3]) + lanes[row][4]);
    }
    CHECK(by_row == expected_by_row);
    CHECK(changes == Approx(expected_changes).margin(1e-14));
  }
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

// The functions for long tables against the exact ones.

TEST_CASE("the tabled logarithm of the normal distribution is the exact one", "[hierarchical]") {
  for (double z = -45; z < 12; z += 0.00137) {
    const double exact = log_normal_cdf(z).log_cdf, ours = tabled_log_normal_cdf(z);
    if (std::abs(ours - exact) <= 1e-14 + 1e-13 * std::abs(exact)) continue;
    CAPTURE(z, exact, ours);
    CHECK(false);
  }
  CHECK(tabled_log_normal_cdf(-1000) == log_normal_cdf(-1000).log_cdf);
  CHECK(tabled_log_normal_cdf(40) == log_normal_cdf(40).log_cdf);
}

TEST_CASE("exponentials of a row are those of its members, and nothing below e^-700", "[hierarchical]") {
  std::vector<double> values;
  for (double x = -699; x < 1; x += 0.0317) values.push_back(x);
  const std::vector<double> exponents = values;
  exponentiate(values, 0.25);
  for (std::size_t i = 0; i < values.size(); ++i) {
    CAPTURE(exponents[i]);
    REQUIRE(std::abs(values[i] / std::exp(exponents[i] - 0.25) - 1) < 1e-14);
  }
  std::vector<double> tiny = {-701, -1e6, 0};
  exponentiate(tiny, 0);
  CHECK(tiny == std::vector<double>{0, 0, 1});
}

TEST_CASE("logarithms of a row are those of its members", "[hierarchical]") {
  std::vector<double> values = {1, 0.5, 2, 1e-300, 1e300};
  for (double x = -700; x < 5; x += 0.0137) values.push_back(std::exp(x));
  for (double x = 0.7; x < 1.42; x += 1e-4) values.push_back(x);
  const std::vector<double> numbers = values;
  take_logarithms(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    CAPTURE(numbers[i]);
    const double exact = std::log(numbers[i]);
    REQUIRE(std::abs(values[i] - exact) <= 1e-15 * std::abs(exact));
  }
}

}  // namespace
}  // namespace jnd
