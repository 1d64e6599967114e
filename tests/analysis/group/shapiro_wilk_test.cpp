// Shapiro-Wilk against R, the exact p of three values, and invariances.
#include "analysis/group/shapiro_wilk.h"

#include <cmath>

#include <rapidcheck.h>

#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

void check_shapiro(const std::vector<double>& values, const nlohmann::json& reference) {
  CAPTURE(reference.dump());
  const ShapiroWilk found = shapiro_wilk(values);
  CHECK(found.status == StatisticStatus::ok);
  CHECK(found.n == static_cast<int>(values.size()));
  CHECK(std::abs(found.w - reference.at("W").get<double>()) <= 1e-12);
  CHECK(std::abs(found.p - reference.at("p").get<double>()) <= 1e-10);
}

TEST_CASE("Shapiro-Wilk agrees with R", "[analysis]") {
  for (const auto& one : group_reference().at("shapiro_extra")) check_shapiro(numbers_of(one["x"]), one);
  for (const auto& dataset : group_reference().at("datasets")) {
    const WithinTable table = table_of(dataset["data"]);
    for (std::size_t j = 0; j < table.k; ++j) check_shapiro(table.column(j), dataset["shapiro"][j]);
  }
}

TEST_CASE("Shapiro-Wilk of three values is exact, however small p", "[analysis]") {
  for (const auto& one : group_reference().at("shapiro_three")) {
    CAPTURE(one.dump());
    const ShapiroWilk found = shapiro_wilk(numbers_of(one["x"]));
    CHECK(relative(found.w, one["w"]) <= 1e-14);
    CHECK(relative(found.p, one["p"]) <= 1e-13);
  }
  const double equal_pair[] = {1, 1, 2}, even[] = {-1, 0, 1};
  CHECK(shapiro_wilk(equal_pair).w == Approx(0.75).epsilon(1e-15));
  CHECK(shapiro_wilk(equal_pair).p == 0);
  CHECK(shapiro_wilk(even).w == Approx(1).epsilon(1e-15));
  CHECK(shapiro_wilk(even).p == Approx(1).epsilon(1e-15));
}

TEST_CASE("Shapiro-Wilk says where it is undefined", "[analysis]") {
  const auto status = [](std::size_t n, bool constant) {
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(constant ? 0.1 : static_cast<double>(i % 17));
    const ShapiroWilk found = shapiro_wilk(values);
    CHECK((found.status == StatisticStatus::ok) == !std::isnan(found.w));
    CHECK((found.status == StatisticStatus::ok) == !std::isnan(found.p));
    return found.status;
  };
  CHECK(status(0, false) == StatisticStatus::too_few);
  CHECK(status(2, false) == StatisticStatus::too_few);
  CHECK(status(3, true) == StatisticStatus::no_variance);
  CHECK(status(5000, false) == StatisticStatus::ok);
  CHECK(status(5001, false) == StatisticStatus::too_many);
}

TEST_CASE("Shapiro-Wilk keeps digits far from zero and in the tail", "[analysis]") {
  // The same shape at 1e6 with a spread of 1e-6: only the rounding of the input is left.
  const std::vector<double> shape = {0, 1, 2, 3, 5, 8, 9, 14};
  std::vector<double> far;
  for (const double value : shape) far.push_back(1e6 + value * 0x1p-20);
  CHECK(shapiro_wilk(far).w == Approx(shapiro_wilk(shape).w).epsilon(1e-13));
  std::vector<double> outlier(2000, 0.0);
  for (std::size_t i = 0; i < outlier.size(); ++i) outlier[i] = 1e-6 * static_cast<double>(i % 7);
  outlier.back() = 1;
  const ShapiroWilk found = shapiro_wilk(outlier);
  CHECK(found.p > 0);
  CHECK(found.p < 1e-60);
}

TEST_CASE("Shapiro-Wilk does not see shift, scale, sign or order", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const WithinTable table = random_table(1, 4, 40);
    const ShapiroWilk found = shapiro_wilk(table.values);
    RC_PRE(found.status == StatisticStatus::ok);
    RC_ASSERT(found.w > 0);
    RC_ASSERT(found.w <= 1);
    RC_ASSERT(found.p >= 0);
    RC_ASSERT(found.p <= 1);
    std::vector<double> changed;
    for (const std::size_t i : random_order(table.values.size())) changed.push_back(100 - 0.3 * table.values[i]);
    const ShapiroWilk again = shapiro_wilk(changed);
    RC_ASSERT(std::abs(again.w - found.w) < 1e-12);
    RC_ASSERT(std::abs(again.p - found.p) < 1e-9);
  }));
}

}  // namespace
}  // namespace jnd
