// The ordered probit itself: derivatives against differences, cells far out in the tails, and what recedes.
#include "analysis/ratings/ordinal_probit.h"

#include <random>

#include "analysis/numerics/normal.h"
#include "tests/analysis/ratings/ratings_fixtures.h"

namespace jnd {
namespace {

TEST_CASE("derivatives of the ordered probit are those of its value", "[analysis][ratings]") {
  const OrdinalProbit model({{5, 0, 3, 2}, {1, 4, 2, 6}, {0, 0, 7, 3}}, {{0, 0.5}, {1, -1}, {2, 0}},
                            {false, true, true});
  const std::vector<double> place = {-0.7, 0.2, 1.1, 0.4, -0.3, 0.25};
  NewtonDerivatives at, above, below;
  model.derivatives(place, at);
  CHECK(at.value == Approx(model.value(place)));
  for (std::size_t p = 0; p < place.size(); ++p) {
    const double h = 1e-5;
    std::vector<double> up = place, down = place;
    up[p] += h;
    down[p] -= h;
    model.derivatives(up, above);
    model.derivatives(down, below);
    CHECK(at.gradient[p] == Approx((above.value - below.value) / (2 * h)).epsilon(1e-7).margin(1e-7));
    for (std::size_t q = 0; q < place.size(); ++q)
      CHECK(at.curvature[p * place.size() + q] ==
            Approx(-(above.gradient[q] - below.gradient[q]) / (2 * h)).epsilon(1e-6).margin(1e-6));
  }
}

TEST_CASE("cells far out in a tail have a finite logarithm with the right slope", "[analysis][ratings]") {
  const OrdinalProbit model({{0, 1, 0}, {0, 0, 1}}, {{1}, {-1}});
  NewtonDerivatives at;
  for (const double eta : {31.0, 60.0, 400.0, 1e4}) {
    CAPTURE(eta);
    model.derivatives({0, 1, eta, 0}, at);
    const double cell = log_normal_cdf(1 - eta).log_cdf +
                        std::log1p(-std::exp(log_normal_cdf(-eta).log_cdf - log_normal_cdf(1 - eta).log_cdf));
    CHECK(at.value == Approx(cell + log_normal_cdf(-1 - eta).log_cdf).epsilon(1e-12));
    CHECK(std::isfinite(at.gradient[2]));
    // d ln Phi(x) / dx tends to -x: of the first row at 1 - eta, of the second at -1 - eta.
    CHECK(at.gradient[2] == Approx(-(eta - 1) - (eta + 1)).epsilon(3 / eta));
    CHECK(at.curvature[2 * 4 + 2] == Approx(2).epsilon(0.05));
  }
  // mpmath 1.3, 40 digits.
  CHECK(log_normal_cdf(-31).log_cdf == Approx(-484.85396362717928858).epsilon(1e-14));
  CHECK(log_normal_cdf(-60).log_cdf == Approx(-1805.0135606805671387).epsilon(1e-14));
  CHECK(log_normal_cdf(-400).log_cdf == Approx(-80006.910409330215001).epsilon(1e-14));
  // A narrow cell in the tail: its mass is density times width.
  const OrdinalProbit narrow({{0, 1, 0}}, {{0}});
  const double middle = 40 + 0.5e-7;
  CHECK(narrow.value({40, 40 + 1e-7, 0, 0}) == Approx(log_normal_density(middle) + std::log(1e-7)).epsilon(1e-9));
}

TEST_CASE("criteria out of order are impossible", "[analysis][ratings]") {
  const OrdinalProbit model({{1, 1, 1}}, {{0}});
  CHECK(model.value({1, 0, 0, 0}) == -kInf);
  CHECK(model.value({1, 1, 0, 0}) == -kInf);
  CHECK(std::isfinite(model.value({0, 1, 0, 0})));
}

// Whether the likelihood at the best criteria still rises, or stays, far along the direction.
bool rises_far_out(const CategoryCounts& counts, double per_row) {
  const OrdinalProbit model(counts, {{0}, {1}, {per_row}});
  const auto at = [&](double effect) {
    NewtonBox box = model.box();
    box.lower[model.criteria()] = box.upper[model.criteria()] = effect;
    std::vector<double> start = model.start();
    double value = 0;
    for (double e = 0; e <= effect; e += 0.5) {  // small steps: a warm start each
      box.lower[model.criteria()] = box.upper[model.criteria()] = e;
      const OrdinalFit fit = fit_ordinal(model, box, start);
      start = fit.place;
      value = fit.log_likelihood;
    }
    return value;
  };
  return at(14) >= at(10) - 1e-9;
}

TEST_CASE("what recedes is what keeps rising", "[analysis][ratings]") {
  std::mt19937 random(7);
  int receding = 0;
  for (int i = 0; i < 300; ++i) {
    CategoryCounts counts(3, std::vector<double>(4, 0));
    for (std::size_t row = 0; row < 3; ++row)
      for (int k = 0; k < 3; ++k) {
        const std::size_t centre = row + random() % 2;
        counts[row][std::min<std::size_t>(3, random() % 4 == 0 ? random() % 4 : centre)] += 1;
      }
    counts = used_categories(counts).counts;
    if (counts.front().size() < 2) continue;
    const bool found = recedes(counts, {0, 1, 2});
    receding += found;
    CHECK(found == rises_far_out(counts, 2));
  }
  CHECK(receding > 10);
}

TEST_CASE("unused categories go, and the saturated likelihood stays", "[analysis][ratings]") {
  const CategoryCounts counts = {{3, 0, 0, 1}, {2, 0, 5, 0}};
  const UsedCategories used = used_categories(counts);
  CHECK(used.used == std::vector<int>{0, 2, 3});
  CHECK(used.counts == CategoryCounts{{3, 0, 1}, {2, 5, 0}});
  CHECK(saturated_log_likelihood(used.counts) == saturated_log_likelihood(counts));
  CHECK(saturated_log_likelihood({{0, 0}}) == 0);
}

}  // namespace
}  // namespace jnd
