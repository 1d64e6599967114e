#include "analysis/numerics/decimal_order.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>

namespace jnd {

namespace {

__extension__ using Wide = __int128;  // every whole number below 1.7e38

constexpr int kMostDigits = 15;
constexpr double kShort = 1e15;   // mantissas of at most so many digits are smaller
constexpr int kMostPlaces = 37;   // from the first digit of the largest number to the last of the finest
constexpr int kExactDigits = 11;  // of a decimal with more of them the fifteenth digit may be rounded
constexpr int kTenths = 6;        // of a unit of the fifteenth digit: half of one, and the rounding of what was written
constexpr double kError = 6e-15;  // the same, relative to the number, at most

struct Decimal {
  std::int64_t mantissa = 0;
  int exponent = 0;  // of ten
};

// None where the shortest decimal has more than 15 digits, and for what is no number.
std::optional<Decimal> short_decimal(double value) {
  if (!std::isfinite(value)) return std::nullopt;
  // Most measured numbers have few decimals. A quotient of exact numbers is the double nearest to that decimal.
  constexpr std::array kPowers = {1.0, 10.0, 100.0, 1000.0, 10000.0};
  int places = 0;
  for (const double power : kPowers) {
    const double mantissa = std::nearbyint(value * power);
    if (!(std::abs(mantissa) < kShort)) break;
    if (mantissa / power == value) return Decimal{static_cast<std::int64_t>(mantissa), -places};
    ++places;
  }
  std::array<char, 32> text{};  // -d.ddde-ddd
  const char* const end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific).ptr;
  const char* const mark = std::find(static_cast<const char*>(text.data()), end, 'e');
  Decimal decimal;
  int digits = 0, fraction = 0;
  bool after_point = false;
  for (const char* at = text.data(); at != mark; ++at) {
    if (*at == '.') after_point = true;
    if (*at < '0' || *at > '9') continue;
    if (++digits > kMostDigits) return std::nullopt;
    fraction += after_point ? 1 : 0;
    decimal.mantissa = 10 * decimal.mantissa + (*at - '0');
  }
  if (value < 0) decimal.mantissa = -decimal.mantissa;
  std::from_chars(mark[1] == '+' ? mark + 2 : mark + 1, end, decimal.exponent);
  decimal.exponent -= fraction;
  return decimal;
}

int digits_of(std::int64_t mantissa) noexcept {
  int digits = 0;
  for (; mantissa != 0; mantissa /= 10) ++digits;
  return digits;
}

// The power of ten that is a tenth of a unit of the fifteenth digit; empty if the decimal is exact.
std::optional<int> rounding_of(const Decimal& decimal) noexcept {
  std::int64_t significant = decimal.mantissa;
  while (significant != 0 && significant % 10 == 0) significant /= 10;
  if (digits_of(significant) <= kExactDigits) return std::nullopt;
  return decimal.exponent + digits_of(decimal.mantissa) - kMostDigits - 1;
}

// A value and what it may be off by.
template <typename Number>
struct Known {
  Number value = 0, error = 0;
};
using Multiple = Known<Wide>;
using Rounded = Known<double>;

// The values of all lists as whole multiples of one power of ten; empty if they are no such decimals.
template <std::size_t N>
std::optional<std::array<std::vector<Multiple>, N>> whole_multiples(
    const std::array<std::span<const double>, N>& lists) {
  std::array<std::vector<Decimal>, N> decimals;
  int finest = std::numeric_limits<int>::max(), first_place = std::numeric_limits<int>::min();
  for (std::size_t list = 0; list < N; ++list) {
    decimals[list].reserve(lists[list].size());
    for (const double value : lists[list]) {
      const std::optional<Decimal> decimal = short_decimal(value);
      if (!decimal) return std::nullopt;
      decimals[list].push_back(*decimal);
      if (decimal->mantissa == 0) continue;
      finest = std::min(finest, rounding_of(*decimal).value_or(decimal->exponent));
      first_place = std::max(first_place, decimal->exponent + digits_of(decimal->mantissa));
    }
  }
  if (first_place > std::numeric_limits<int>::min() && first_place - finest > kMostPlaces) return std::nullopt;
  const auto in_finest = [finest](Wide multiple, int exponent) {
    for (int place = finest; multiple != 0 && place < exponent; ++place) multiple *= 10;
    return multiple;
  };
  std::array<std::vector<Multiple>, N> result;
  for (std::size_t list = 0; list < N; ++list) {
    result[list].reserve(decimals[list].size());
    for (const Decimal& decimal : decimals[list]) {
      const std::optional<int> rounding = rounding_of(decimal);
      result[list].push_back(
          {in_finest(decimal.mantissa, decimal.exponent), rounding ? in_finest(kTenths, *rounding) : Wide{0}});
    }
  }
  return result;
}

// Whether the numbers cannot be told apart.
template <typename Number>
bool same(const Known<Number>& smaller, const Known<Number>& larger) {
  return larger.value == smaller.value || larger.value - smaller.value < smaller.error + larger.error;
}

// Places 0, 1, ... of the keys; neighbours in their order share a place if they cannot be told apart.
template <typename Number>
std::vector<int> places_of(const std::vector<Known<Number>>& keys) {
  std::vector<std::size_t> order(keys.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return keys[a].value < keys[b].value; });
  std::vector<int> places(keys.size(), 0);
  for (std::size_t i = 1; i < order.size(); ++i)
    places[order[i]] = places[order[i - 1]] + (same(keys[order[i - 1]], keys[order[i]]) ? 0 : 1);
  return places;
}

template <typename Number>
std::vector<int> difference_places(const std::vector<Known<Number>>& x, const std::vector<Known<Number>>& y) {
  std::vector<int> signs(x.size(), 0);
  std::vector<Known<Number>> sizes;  // of the differences that are not 0
  for (std::size_t i = 0; i < signs.size(); ++i) {
    const bool more = x[i].value > y[i].value;
    if (more ? same(y[i], x[i]) : same(x[i], y[i])) continue;
    signs[i] = more ? 1 : -1;
    sizes.push_back({more ? x[i].value - y[i].value : y[i].value - x[i].value, x[i].error + y[i].error});
  }
  const std::vector<int> places = places_of(sizes);
  std::size_t used = 0;
  for (int& sign : signs)
    if (sign != 0) sign *= places[used++] + 1;
  return signs;
}

std::vector<Rounded> rounded(std::span<const double> values) {
  std::vector<Rounded> keys;
  keys.reserve(values.size());
  for (const double value : values) keys.push_back({value, kError * std::abs(value)});
  return keys;
}

// Of the first digit: 2 of 123.
int place_of(double value) {
  return value == 0 ? 0 : static_cast<int>(std::floor(std::log10(std::abs(value))));
}

double with_digits(double value, int digits) {
  std::array<char, 32> text{};  // -d.dddddddddddddde-ddd
  auto* const end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific,
                                  std::max(digits, 1) - 1)
                        .ptr;
  double rounded = value;
  std::from_chars(text.data(), end, rounded);
  return rounded;
}

}  // namespace

double plain_decimal(double value) {
  if (std::abs(value) < kShort && value == std::nearbyint(value)) return value;
  return with_digits(value, kMostDigits);
}

double plain_sum(double a, double b) {
  const double sum = a + b;
  const int digits = kMostDigits - place_of(std::max(std::abs(a), std::abs(b))) + place_of(sum);
  return digits < 1 ? 0 : digits >= kMostDigits ? plain_decimal(sum) : with_digits(sum, digits);
}

double plain_distance(double a, double b) {
  return std::abs(plain_sum(a, -b));
}

std::vector<int> decimal_places(std::span<const double> values) {
  auto exact = whole_multiples<1>({values});
  if (!exact) return places_of(rounded(values));
  for (Multiple& one : (*exact)[0]) one.error = 0;  // the same fraction is the same decimal
  return places_of((*exact)[0]);
}

std::vector<int> decimal_difference_places(std::span<const double> x, std::span<const double> y) {
  if (const auto exact = whole_multiples<2>({x, y})) return difference_places((*exact)[0], (*exact)[1]);
  return difference_places(rounded(x), rounded(y));
}

}  // namespace jnd
