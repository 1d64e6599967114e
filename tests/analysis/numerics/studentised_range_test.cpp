// The studentised range against exact values, closed forms and itself.
#include "analysis/numerics/studentised_range.h"

#include <cmath>
#include <thread>
#include <vector>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST_CASE("studentised range: tail probabilities agree with the tables", "[analysis]") {
  for (const auto& one : group_reference().at("ptukey")) {
    CAPTURE(one.dump());
    const double found = studentised_range_upper(one["q"], one["k"], reference_number(one["df"]));
    CHECK(std::abs(found - one["upper_p"].get<double>()) <= 2e-12);
  }
}

TEST_CASE("studentised range: digits hold from the bulk to the deep tail", "[analysis]") {
  for (const auto& one : group_reference().at("ptukey_precise")) {
    CAPTURE(one.dump());
    const double df = reference_number(one["df"]), found = studentised_range_upper(one["q"], one["k"], df);
    CHECK(relative(found, one["upper_p"]) <= 1e-12);
  }
}

TEST_CASE("studentised range: quantiles agree with the tables", "[analysis]") {
  for (const auto& one : group_reference().at("qtukey")) {
    CAPTURE(one.dump());
    const double found = studentised_range_quantile(one["p"], one["k"], reference_number(one["df"]));
    CHECK(std::abs(found - one["q"].get<double>()) <= 1e-11);
  }
  // These are R's own, whose iteration stops early.
  for (const auto& dataset : group_reference().at("datasets"))
    for (const auto& pair : dataset["games_howell"])
      CHECK(relative(studentised_range_quantile(0.95, 3, pair["df"]), pair["qcrit"]) <= 1e-7);
}

TEST_CASE("studentised range: closed forms of few degrees of freedom", "[analysis]") {
  for (const double q : {1e-3, 0.1, 0.7, 2.0, 8.0, 30.0, 1e4, 1e9}) {
    CAPTURE(q);
    // Two groups, one degree of freedom: Cauchy.
    CHECK(relative(studentised_range_upper(q, 2, 1), 2 / kPi * std::atan(std::sqrt(2.0) / q)) <= 1e-13);
    // Three groups, two degrees: (6/pi) Int cos^2 / (cos^2 + c) over 0..pi/6, c = q^2/4.
    const double c = q * q / 4;
    const double exact = 1 - 6 / kPi * std::sqrt(c / (1 + c)) * std::atan(std::sqrt(c / (1 + c)) / std::sqrt(3.0));
    CHECK(std::abs(studentised_range_upper(q, 3, 2) - exact) <= 1e-14);
  }
}

TEST_CASE("studentised range: edges", "[analysis]") {
  for (const int groups : {2, 3, 7}) {
    for (const double df : {1.0, 2.5, 40.0, kInf}) {
      CAPTURE(groups, df);
      CHECK(studentised_range_upper(0, groups, df) == 1);
      CHECK(studentised_range_upper(-3, groups, df) == 1);
      CHECK(studentised_range_upper(kInf, groups, df) == 0);
      CHECK(studentised_range_upper(1e-9, groups, df) == Approx(1).margin(2e-9));
      CHECK(studentised_range_quantile(0, groups, df) == 0);
      CHECK(studentised_range_quantile(1, groups, df) == kInf);
      CHECK(std::isnan(studentised_range_quantile(1.5, groups, df)));
      CHECK(std::isnan(studentised_range_upper(std::nan(""), groups, df)));
    }
  }
  CHECK(std::isnan(studentised_range_upper(3, 1, 10)));
  CHECK(std::isnan(studentised_range_upper(3, 1001, 10)));
  CHECK(std::isnan(studentised_range_upper(3, 3, 0.5)));
  CHECK(std::isnan(studentised_range_upper(3, 3, std::nan(""))));
  // Neither q^2 nor the tail leaves the range of double before p does.
  CHECK(relative(studentised_range_upper(1e200, 3, 1), 1e-100 * studentised_range_upper(1e100, 3, 1)) <= 1e-12);
  CHECK(relative(studentised_range_upper(1e160, 5, 1), 1e-60 * studentised_range_upper(1e100, 5, 1)) <= 1e-12);
  CHECK(studentised_range_upper(52, 3, kInf) > 0);
  CHECK(studentised_range_upper(52, 3, kInf) < 1e-290);
}

TEST_CASE("studentised range: many degrees of freedom approach the normal range", "[analysis]") {
  for (const int groups : {2, 3, 4, 20, 150}) {
    CAPTURE(groups);
    const double normal = studentised_range_upper(4, groups, kInf);
    CHECK(std::abs(studentised_range_upper(4, groups, 1e9) - normal) <= 1e-8);
    CHECK(std::abs(studentised_range_upper(4, groups, 1e14) - normal) <= 1e-11);
    CHECK(std::abs(studentised_range_upper(4, groups, 1e16) - normal) <= 1e-13);
  }
}

TEST_CASE("studentised range: a value is the same whoever asked before, and from how many threads", "[analysis]") {
  const auto tail = [] {
    std::vector<double> values;
    for (int i = 1; i < 60; ++i) values.push_back(studentised_range_upper(0.2 * i, 13, 1 + 1.7 * i));
    return values;
  };
  std::vector<std::vector<double>> found(4);
  std::vector<std::thread> threads;
  for (std::vector<double>& values : found) threads.emplace_back([&values, &tail] { values = tail(); });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<double>& values : found) CHECK(values == tail());
}

TEST_CASE("studentised range: the quantile is the inverse of the tail", "[analysis]") {
  REQUIRE(rc::check("q -> p -> q", [] {
    const int groups = *rc::gen::inRange(2, 9);
    const double df = *rc::gen::inRange(100, 10'000) / 100.0, q = *rc::gen::inRange(5, 4000) / 100.0;
    const double p = studentised_range_upper(q, groups, df);
    RC_PRE(p < 0.999);
    RC_ASSERT(relative(studentised_range_quantile_upper(p, groups, df), q) < 1e-9);
  }));
  for (const double p : {1e-250, 1e-30, 1e-6})
    CHECK(relative(studentised_range_upper(studentised_range_quantile_upper(p, 5, 6), 5, 6), p) < 1e-11);
}

TEST_CASE("studentised range: monotone in q, groups and df", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const int groups = *rc::gen::inRange(2, 9);
    const double df = *rc::gen::inRange(100, 10'000) / 100.0, q = *rc::gen::inRange(10, 2000) / 100.0;
    const double p = studentised_range_upper(q, groups, df);
    RC_ASSERT(p > 0);
    RC_ASSERT(p <= 1);
    RC_ASSERT(studentised_range_upper(q * 1.01, groups, df) < p);
    RC_ASSERT(studentised_range_upper(q, groups + 1, df) >= p);
  }));
}

}  // namespace
}  // namespace jnd
