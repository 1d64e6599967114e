// Two factors within subjects against cell means in arbitrary precision, and the one-way cases inside.
#include <cmath>
#include <string>

#include <rapidcheck.h>

#include "analysis/group/repeated_measures.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("two-way within agrees with sums of squares of cell means", "[analysis]") {
  const auto& reference = group_reference().at("two_way");
  TwoWayTable table{reference["data"].size(), reference["data"][0].size(), reference["data"][0][0].size(), {}};
  for (const auto& participant : reference["data"])
    for (const auto& row : participant)
      for (const auto& value : row) table.values.push_back(value);
  const TwoWayWithin found = two_way_within(table);
  CHECK(found.status == StatisticStatus::ok);
  CHECK(relative(found.ss_subjects, reference["ss_subjects"]) <= 1e-11);
  const auto check = [&](const TwoWayEffect& one, const char* name) {
    CAPTURE(name);
    const auto& expected = reference[name];
    const WithinEffect& effect = one.effect;
    CHECK(effect.status == StatisticStatus::ok);
    CHECK(effect.df1 == expected["df1"].get<double>());
    CHECK(effect.df2 == expected["df2"].get<double>());
    CHECK(relative(effect.ss, expected["ss"]) <= 1e-11);
    CHECK(relative(effect.ss_error, expected["ss_error"]) <= 1e-11);
    CHECK(relative(effect.f, expected["f"]) <= 1e-11);
    CHECK(relative(effect.p, expected["p"]) <= 1e-10);
    CHECK(relative(effect.epsilon_gg, expected["eps_gg"]) <= 1e-11);
    CHECK(relative(effect.epsilon_hf, expected["eps_hf"]) <= 1e-11);
    CHECK(relative(effect.p_gg, expected["p_gg"]) <= 1e-10);
    CHECK(relative(effect.p_hf, expected["p_hf"]) <= 1e-10);
    CHECK(relative(effect.mauchly.w, expected["mauchly_w"]) <= 1e-9);
    CHECK(relative(effect.eta2_partial, expected["eta2_partial"]) <= 1e-11);
    CHECK(relative(one.eta2_generalised, expected["eta2_generalised"]) <= 1e-11);
  };
  check(found.a, "a");
  check(found.b, "b");
  check(found.ab, "ab");
}

TEST_CASE("a main effect is the one-way analysis of the means over the other factor", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const std::size_t n = *rc::gen::inRange<std::size_t>(2, 9), a = *rc::gen::inRange<std::size_t>(2, 5);
    const std::size_t b = *rc::gen::inRange<std::size_t>(2, 4);
    TwoWayTable table{n, a, b, {}}, swapped{n, b, a, {}};
    for (std::size_t i = 0; i < n * a * b; ++i) table.values.push_back(*rc::gen::inRange(0, 50));
    WithinTable means{n, a, {}};
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < a; ++j) {
        double sum = 0;
        for (std::size_t l = 0; l < b; ++l) sum += table.values[(i * a + j) * b + l];
        means.values.push_back(sum / static_cast<double>(b));
      }
      for (std::size_t l = 0; l < b; ++l)
        for (std::size_t j = 0; j < a; ++j) swapped.values.push_back(table.values[(i * a + j) * b + l]);
    }
    const TwoWayWithin found = two_way_within(table), mirrored = two_way_within(swapped);
    const WithinEffect one_way = repeated_measures(means).effect;
    RC_PRE(one_way.status == StatisticStatus::ok && found.ab.effect.status == StatisticStatus::ok);
    RC_ASSERT(std::abs(found.a.effect.f - one_way.f) <= 1e-9 * (1 + one_way.f));
    RC_ASSERT(std::abs(found.a.effect.epsilon_gg - one_way.epsilon_gg) < 1e-9);
    RC_ASSERT(std::abs(found.a.effect.ss - static_cast<double>(b) * one_way.ss) <= 1e-9 * (1 + found.a.effect.ss));
    RC_ASSERT(std::abs(mirrored.b.effect.f - found.a.effect.f) <= 1e-9 * (1 + one_way.f));
    RC_ASSERT(std::abs(mirrored.ab.effect.f - found.ab.effect.f) <= 1e-9 * (1 + found.ab.effect.f));
    // The sums of squares are all there is.
    double mean = 0, total = 0;
    for (const double value : table.values) mean += value / static_cast<double>(table.values.size());
    for (const double value : table.values) total += (value - mean) * (value - mean);
    double parts = found.ss_subjects;
    for (const TwoWayEffect* one : {&found.a, &found.b, &found.ab}) parts += one->effect.ss + one->effect.ss_error;
    RC_ASSERT(std::abs(parts - total) <= 1e-10 * total);
  }));
}

TEST_CASE("two-way within: too few, and no variance", "[analysis]") {
  CHECK(two_way_within({1, 2, 2, {1, 2, 3, 4}}).status == StatisticStatus::too_few);
  CHECK(two_way_within({2, 1, 2, {1, 2, 3, 4}}).status == StatisticStatus::too_few);
  CHECK(std::isnan(two_way_within({1, 2, 2, {1, 2, 3, 4}}).ab.effect.f));
  const TwoWayWithin additive = two_way_within({3, 2, 2, {1, 2, 3, 4, 3, 4, 5, 6, 9, 10, 11, 12}});
  CHECK(additive.status == StatisticStatus::ok);
  CHECK(additive.a.effect.status == StatisticStatus::no_variance);
  CHECK(additive.ab.effect.status == StatisticStatus::no_variance);
  CHECK(std::isnan(additive.ab.effect.p));
}

}  // namespace
}  // namespace jnd
