#include "analysis/lattice/fast_functions.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "analysis/lattice/wide_registers.h"
#include "analysis/numerics/normal.h"

namespace jnd {

namespace {

// ln Phi about places 1/32 apart. With m = phi/Phi its derivative is m, and m' = -m (z + m): from these all others.
class LogNormalTable {
 public:
  LogNormalTable() {
    for (int place = 0; place <= (kHighest - kLowest) * kPlaces; ++place) {
      const double z = kLowest + static_cast<double>(place) / kPlaces;
      const LogNormalCdf at = log_normal_cdf(z);
      // Coefficients of m about z: (n + 1) m[n+1] = -(z m[n] + m[n-1] + sum over i of m[i] m[n-i]).
      std::array<double, kDegree> m{at.inverse_mills};
      for (std::size_t n = 0; n + 1 < kDegree; ++n) {
        double sum = z * m[n] + (n > 0 ? m[n - 1] : 0);
        for (std::size_t i = 0; i <= n; ++i) sum += m[i] * m[n - i];
        m[n + 1] = -sum / static_cast<double>(n + 1);
      }
      Polynomial& polynomial = polynomials_.emplace_back();
      polynomial[0] = at.log_cdf;
      for (std::size_t n = 0; n < kDegree; ++n) polynomial[n + 1] = m[n] / static_cast<double>(n + 1);
    }
  }

  static constexpr int kLowest = -38, kHighest = 9, kPlaces = 32;
  static constexpr double kHalfBefore = kLowest - 0.5 / kPlaces;  // the nearest place is the last one half before
  static constexpr std::size_t kDegree = 6;
  using Polynomial = std::array<double, kDegree + 1>;

  const double* numbers() const noexcept { return polynomials_.front().data(); }

 private:
  std::vector<Polynomial> polynomials_;
};

// Between the ends of the table.
inline double looked_up(double z, const double* numbers) noexcept {
  using T = LogNormalTable;
  const double inside = z < T::kLowest ? T::kLowest : z > T::kHighest ? T::kHighest : z;
  const int place = static_cast<int>((inside - T::kHalfBefore) * T::kPlaces);
  const double beside = inside - (T::kLowest + static_cast<double>(place) / T::kPlaces);
  const double* polynomial = numbers + static_cast<std::ptrdiff_t>(place) * static_cast<int>(T::kDegree + 1);
  double value = polynomial[T::kDegree];
  for (std::size_t n = T::kDegree; n-- > 0;) value = value * beside + polynomial[n];
  return value;
}

JND_WIDE_REGISTERS void look_up(const double* z, std::size_t count, const double* numbers, double* found) noexcept {
  for (std::size_t i = 0; i < count; ++i) found[i] = looked_up(z[i], numbers);
}

const double* log_normal_numbers() {
  static const LogNormalTable table;
  return table.numbers();
}

}  // namespace

double tabled_log_normal_cdf(double z) noexcept {
  if (z > LogNormalTable::kHighest) return 0;  // -1e-19 and less
  return z < LogNormalTable::kLowest ? log_normal_cdf(z).log_cdf : looked_up(z, log_normal_numbers());
}

void log_normal_cdfs(std::span<const double> z, double* found) noexcept {
  look_up(z.data(), z.size(), log_normal_numbers(), found);
  for (std::size_t i = 0; i < z.size(); ++i)
    if (z[i] > LogNormalTable::kHighest || z[i] < LogNormalTable::kLowest) found[i] = tabled_log_normal_cdf(z[i]);
}

// e^x = 2^n e^r with n whole and |r| <= ln 2 / 2: Taylor's polynomial of e^r, and n put into the exponent's bits.
JND_WIDE_REGISTERS void exponentiate(std::span<double> values, double less) noexcept {
  constexpr double kLog2E = 1.4426950408889634, kLn2High = 0.693147180369123816490,
                   kLn2Low = 1.90821492927058770002e-10;
  constexpr double kToWhole = 6755399441055744.0;  // 1.5 * 2^52: added, it leaves a whole number in the low bits
  constexpr double kLeast = -700;
  constexpr double kCoefficients[] = {1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040, 1.0 / 720,
                                      1.0 / 120,      1.0 / 24,      1.0 / 6,      1.0 / 2,     1.0,        1.0};
  for (double& one : values) {
    const double given = one - less;
    const double x = given < kLeast ? kLeast : given;
    const double shifted = x * kLog2E + kToWhole, n = shifted - kToWhole;
    const double r = (x - n * kLn2High) - n * kLn2Low;
    double power = kCoefficients[0];
    for (int i = 1; i < 12; ++i) power = power * r + kCoefficients[i];
    const auto bits = (std::bit_cast<std::uint64_t>(shifted) + 1023) << 52;
    one = power * std::bit_cast<double>(bits) * (given < kLeast ? 0 : 1);
  }
}

// x = 2^n m with m between sqrt(1/2) and sqrt(2): n ln 2 + 2 artanh t, t = (m - 1)/(m + 1), by its series.
JND_WIDE_REGISTERS void take_logarithms(std::span<double> values) noexcept {
  constexpr double kLn2High = 0.693147180369123816490, kLn2Low = 1.90821492927058770002e-10;
  constexpr double kTwoTo52 = 4503599627370496.0;
  constexpr std::uint64_t kMantissa = (std::uint64_t{1} << 52) - 1, kRootOfHalf = 0x3fe6a09e667f3bcd;
  for (double& one : values) {
    // Measured from sqrt(1/2), the exponent's bits are n + 1023 and the others those of m beyond it.
    const std::uint64_t beyond = std::bit_cast<std::uint64_t>(one) - kRootOfHalf + (std::uint64_t{1023} << 52);
    const double n = std::bit_cast<double>((beyond >> 52) | std::bit_cast<std::uint64_t>(kTwoTo52)) - (kTwoTo52 + 1023);
    const double m = std::bit_cast<double>((beyond & kMantissa) + kRootOfHalf);
    const double t = (m - 1) / (m + 1), square = t * t;
    double series = 1.0 / 21;
    for (int power = 19; power > 1; power -= 2) series = series * square + 1.0 / power;
    one = n * kLn2High + (2 * t + (2 * t * square * series + n * kLn2Low));
  }
}

}  // namespace jnd
