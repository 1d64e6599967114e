#include "runner/power/exact_sum.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "tests/catch.h"

using namespace jnd;

namespace {

ExactSum sum_of(const std::vector<double>& values) {
  ExactSum sum;
  for (const double value : values) sum.add(value);
  return sum;
}

// Of every size and sign, subnormal ones too.
std::vector<double> all_sizes(std::uint64_t seed, int count) {
  std::mt19937_64 generator(seed);
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const auto exponent = static_cast<int>(generator() % 2000) - 1060;
    const double mantissa = 1 + static_cast<double>(generator() >> 12U) * 0x1p-52;
    values.push_back(std::ldexp((generator() & 1U) != 0 ? mantissa : -mantissa, exponent));
  }
  return values;
}

}  // namespace

TEST_CASE("an exact sum does not depend on its order or its parts", "[exact_sum]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<double> values = all_sizes(seed, 300);
    const std::string whole = sum_of(values).text();
    std::shuffle(values.begin(), values.end(), std::mt19937_64(seed));
    REQUIRE(sum_of(values).text() == whole);
    ExactSum parts;
    for (std::size_t begin = 0; begin < values.size(); begin += 7) {
      const std::size_t end = std::min(values.size(), begin + 7);
      parts += sum_of(
          {values.begin() + static_cast<std::ptrdiff_t>(begin), values.begin() + static_cast<std::ptrdiff_t>(end)});
    }
    REQUIRE(parts.text() == whole);
    REQUIRE(ExactSum::from_text(whole).text() == whole);
    REQUIRE(ExactSum::from_text(whole).value() == sum_of(values).value());
    // What is taken away again leaves nothing at all.
    ExactSum rest = sum_of(values);
    for (const double value : values) rest.add(-value);
    REQUIRE(rest.text().empty());
    REQUIRE(rest.value() == 0);
  }
}

TEST_CASE("an exact sum is right where a plain one is not", "[exact_sum]") {
  CHECK(sum_of({1e100, 1, -1e100}).value() == 1);
  CHECK(sum_of({0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1}).value() ==
        1);  // ten times the double next to 0.1, rounded
  CHECK(sum_of({}).value() == 0);
  CHECK(sum_of({0.0, -0.0}).text().empty());
  CHECK(sum_of({std::numeric_limits<double>::max(), -std::numeric_limits<double>::max(), -3.5}).value() == -3.5);
  const double least = std::numeric_limits<double>::denorm_min();
  CHECK(sum_of({least, least, least}).value() == 3 * least);
  CHECK(sum_of({-least}).value() == -least);
  // Sums of one size and sign, where a sum of 80 bits errs by less than the last bit of 53.
  std::mt19937_64 generator(5);
  for (int round = 0; round < 50; ++round) {
    long double plain = 0;
    ExactSum sum;
    for (int i = 0; i < 100; ++i) {
      const double value = std::ldexp(static_cast<double>(generator() >> 11U), -53) + 0.5;
      plain += value;
      sum.add(value);
    }
    REQUIRE(std::abs(sum.value() - static_cast<double>(plain)) <= 0x1p-45);
    REQUIRE(ExactSum::from_text(sum.text()).value() == sum.value());
  }
}

TEST_CASE("what is no exact sum is refused", "[exact_sum]") {
  for (const char* const text : {"x", "+", "+3", "+3:123", "+3:1234567g", "+70:00000001", "+-1:00000001", "3:00000001"})
    CHECK_THROWS_AS(ExactSum::from_text(text), std::invalid_argument);
}
