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

constexpr double kShort = 1e15;     // mantissas of at most 15 digits are smaller
constexpr int kMostPlaces = 37;     // from the first digit of the largest number to the last of the finest
constexpr double kError = 0x1p-51;  // relative to the number: two roundings of the largest kind

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
    if (++digits > 15) return std::nullopt;
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

// The values of all lists as whole multiples of one power of ten; none where they are no such decimals.
template <std::size_t N>
std::optional<std::array<std::vector<Wide>, N>> whole_multiples(const std::array<std::span<const double>, N>& lists) {
  std::array<std::vector<Decimal>, N> decimals;
  int finest = std::numeric_limits<int>::max(), first_place = std::numeric_limits<int>::min();
  for (std::size_t list = 0; list < N; ++list) {
    decimals[list].reserve(lists[list].size());
    for (const double value : lists[list]) {
      const std::optional<Decimal> decimal = short_decimal(value);
      if (!decimal) return std::nullopt;
      decimals[list].push_back(*decimal);
      if (decimal->mantissa == 0) continue;
      finest = std::min(finest, decimal->exponent);
      first_place = std::max(first_place, decimal->exponent + digits_of(decimal->mantissa));
    }
  }
  if (first_place > std::numeric_limits<int>::min() && first_place - finest > kMostPlaces) return std::nullopt;
  std::array<std::vector<Wide>, N> result;
  for (std::size_t list = 0; list < N; ++list) {
    result[list].reserve(decimals[list].size());
    for (const Decimal& decimal : decimals[list]) {
      Wide multiple = decimal.mantissa;
      if (multiple != 0)
        for (int place = finest; place < decimal.exponent; ++place) multiple *= 10;
      result[list].push_back(multiple);
    }
  }
  return result;
}

// Places 0, 1, ... of the keys; neighbours in their order share a place where same(smaller, larger) says so.
template <typename Key, typename Same>
std::vector<int> places_of(const std::vector<Key>& keys, Same same) {
  std::vector<std::size_t> order(keys.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return keys[a] < keys[b]; });
  std::vector<int> places(keys.size(), 0);
  for (std::size_t i = 1; i < order.size(); ++i)
    places[order[i]] = places[order[i - 1]] + (same(keys[order[i - 1]], keys[order[i]]) ? 0 : 1);
  return places;
}

std::vector<int> exact_places(const std::vector<Wide>& keys) {
  return places_of(keys, [](Wide a, Wide b) { return a == b; });
}

struct Rounded {
  double value = 0, error = 0;
  bool operator<(const Rounded& other) const noexcept { return value < other.value; }
};

std::vector<int> rounded_places(const std::vector<Rounded>& keys) {
  return places_of(keys, [](const Rounded& a, const Rounded& b) { return b.value - a.value <= a.error + b.error; });
}

// sizes: of the differences that are not 0, of which signs holds the signs and, for the others, 0.
template <typename Key, typename PlacesOf>
std::vector<int> signed_places(std::vector<int> signs, const std::vector<Key>& sizes, PlacesOf of) {
  const std::vector<int> places = of(sizes);
  std::size_t used = 0;
  for (int& sign : signs)
    if (sign != 0) sign *= places[used++] + 1;
  return signs;
}

}  // namespace

std::vector<int> decimal_places(std::span<const double> values) {
  if (const auto exact = whole_multiples<1>({values})) return exact_places((*exact)[0]);
  std::vector<Rounded> keys;
  keys.reserve(values.size());
  for (const double value : values) keys.push_back({value, kError * std::abs(value)});
  return rounded_places(keys);
}

std::vector<int> decimal_difference_places(std::span<const double> x, std::span<const double> y) {
  std::vector<int> signs(x.size(), 0);
  if (const auto exact = whole_multiples<2>({x, y})) {
    std::vector<Wide> sizes;
    for (std::size_t i = 0; i < signs.size(); ++i) {
      const Wide difference = (*exact)[0][i] - (*exact)[1][i];
      if (difference == 0) continue;
      signs[i] = difference > 0 ? 1 : -1;
      sizes.push_back(difference > 0 ? difference : -difference);
    }
    return signed_places(std::move(signs), sizes, exact_places);
  }
  std::vector<Rounded> sizes;
  for (std::size_t i = 0; i < signs.size(); ++i) {
    const double size = std::abs(x[i] - y[i]), error = kError * std::max(std::abs(x[i]), std::abs(y[i]));
    if (size <= error) continue;
    signs[i] = x[i] > y[i] ? 1 : -1;
    sizes.push_back({size, error});
  }
  return signed_places(std::move(signs), sizes, rounded_places);
}

}  // namespace jnd
