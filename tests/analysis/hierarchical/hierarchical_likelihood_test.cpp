// The marginal likelihood against glmer and two other implementations, against its own derivatives, and against an
// integral by brute force.
#include "analysis/hierarchical/hierarchical_likelihood.h"

#include <cmath>
#include <functional>

#include "analysis/numerics/normal.h"
#include "analysis/selftest/model_quantities.h"
#include "analysis/selftest/reference_numbers.h"
#include "tests/analysis/hierarchical/hierarchical_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;
using nlohmann::json;

HierarchicalPlace reference_place(const json& expected) {
  HierarchicalPlace place;
  for (const json& mu : expected.at("mu")) place.mu.push_back(mu);
  for (const json& kappa : expected.at("kappa")) place.kappa.push_back(kappa);
  place.tu = expected.at("tu");
  place.tv = expected.at("tv");
  place.tw = expected.at("tw");
  return place;
}

TEST_CASE("the likelihood at every reference maximum, and with twice the nodes", "[hierarchical]") {
  for (const json& one : reference_numbers("hierarchical").at("same_different")) {
    const std::vector<HierarchicalCell> cells = reference_answers(one);
    for (const json& fit : one.at("expected")) {
      CAPTURE(one.at("name").get<std::string>(), fit.at("model").dump());
      const json& expected = fit.at("expected");
      const double lapse = fit.at("model").at("lapse");
      const HierarchicalPlace place = reference_place(expected);
      HierarchicalLikelihood usual(cells, ResponseModel::yes_no, {.lapse = lapse}),
          fine(cells, ResponseModel::yes_no, {.lapse = lapse}, 2);
      const double value = usual.at(place).log_likelihood, finer = fine.at(place).log_likelihood;
      CHECK(std::abs(value - expected.at("loglik").get<double>()) < 1e-6);
      CHECK(std::abs(finer - expected.at("loglik").get<double>()) < 2e-8);
      CHECK(std::abs(finer - value) < 1e-6);
    }
  }
}

// By the midpoint rule over u, w and v of one participant in one condition.
double by_brute_force(const std::vector<HierarchicalCell>& cells, ResponseModel model, double lapse,
                      const HierarchicalPlace& place) {
  constexpr int kSteps = 60;
  constexpr double kReach = 7, kWidth = 2 * kReach / kSteps;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j)
      for (int l = 0; l < kSteps; ++l) {
        const double a = -kReach + (i + 0.5) * kWidth, b = -kReach + (j + 0.5) * kWidth,
                     d = -kReach + (l + 0.5) * kWidth;
        const double w = place.tw * (place.rho * a + std::sqrt(1 - place.rho * place.rho) * b);
        double log_value = log_normal_density(a) + log_normal_density(b) + log_normal_density(d);
        for (const HierarchicalCell& cell : cells) {
          const LogRates rates =
              log_rates(model, cell.level, place.mu[0] + place.tu * a + place.tv * d, place.kappa[0] + w, lapse);
          log_value += cell.positive * rates.positive + cell.negative * rates.negative;
        }
        sum += std::exp(log_value) * kWidth * kWidth * kWidth;
      }
  return std::log(sum);
}

TEST_CASE("the likelihood of one person by brute force, for every model of the answer, correlated too",
          "[hierarchical]") {
  const std::vector<HierarchicalCell> judged = {{0, 0, 0, 4, 14}, {0, 0, 200, 3, 3}, {0, 0, 400, 5, 1}};
  const std::vector<HierarchicalCell> chosen = {{0, 0, -200, 1, 7}, {0, 0, 0, 3, 5}, {0, 0, 200, 8, 0}};
  HierarchicalPlace place;
  place.mu = {std::log(240)};
  place.tu = 0.4;
  place.tv = 0.25;
  for (const double rho : {0.0, 0.6, -0.8})
    for (const double lapse : {0.0, 0.04}) {
      CAPTURE(rho, lapse);
      place.rho = rho;
      place.kappa = {0.7};
      place.tw = 0.35;
      for (const ResponseModel model : {ResponseModel::yes_no, ResponseModel::differencing}) {
        HierarchicalLikelihood likelihood(judged, model, {.lapse = lapse});
        CHECK(std::abs(likelihood.at(place).log_likelihood - by_brute_force(judged, model, lapse, place)) < 1e-6);
      }
      place.kappa = {20};
      place.tw = 60;
      HierarchicalLikelihood likelihood(chosen, ResponseModel::choice, {.lapse = lapse});
      CHECK(std::abs(likelihood.at(place).log_likelihood -
                     by_brute_force(chosen, ResponseModel::choice, lapse, place)) < 1e-6);
    }
}

TEST_CASE("derivatives are those of the value", "[hierarchical]") {
  const std::vector<HierarchicalCell> cells = published_study(6, 3);
  HierarchicalPlace place = published_truth();
  place.rho = 0.3;
  HierarchicalLikelihood likelihood(cells, ResponseModel::yes_no, {.lapse = 0.01}, 1.5);
  const HierarchicalPlace slope = likelihood.at(place).slope;
  const auto by = [&](const std::function<double&(HierarchicalPlace&)>& parameter) {
    constexpr double kStep = 1e-4;
    HierarchicalPlace above = place, below = place;
    parameter(above) += kStep;
    parameter(below) -= kStep;
    return (likelihood.at(above).log_likelihood - likelihood.at(below).log_likelihood) / (2 * kStep);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(std::abs(by([c](HierarchicalPlace& at) -> double& { return at.mu[c]; }) - slope.mu[c]) < 1e-4);
    CHECK(std::abs(by([c](HierarchicalPlace& at) -> double& { return at.kappa[c]; }) - slope.kappa[c]) < 1e-4);
  }
  CHECK(std::abs(by([](HierarchicalPlace& at) -> double& { return at.tu; }) - slope.tu) < 1e-4);
  CHECK(std::abs(by([](HierarchicalPlace& at) -> double& { return at.tv; }) - slope.tv) < 1e-4);
  CHECK(std::abs(by([](HierarchicalPlace& at) -> double& { return at.tw; }) - slope.tw) < 1e-4);
  CHECK(std::abs(by([](HierarchicalPlace& at) -> double& { return at.rho; }) - slope.rho) < 1e-4);
  const double common = likelihood.at(place).log_likelihood;
  place.own_tv.assign(3, place.tv);
  CHECK(likelihood.at(place).log_likelihood == common);
  place.own_tv = {0.1, 0.4, 0.25};
  const std::vector<double> by_own_tv = likelihood.at(place).slope.own_tv;
  for (std::size_t c = 0; c < 3; ++c)
    CHECK(std::abs(by([c](HierarchicalPlace& at) -> double& { return at.own_tv[c]; }) - by_own_tv[c]) < 1e-4);
}

TEST_CASE("who answered little beside who answered much takes few nodes", "[hierarchical]") {
  std::vector<HierarchicalCell> much, little;
  for (const auto& [level, positive] : {std::pair{0.0, 1059.0}, {200.0, 3515.0}, {300.0, 4425.0}, {400.0, 4845.0}}) {
    much.push_back({0, 0, level, positive, 5000 - positive});
    little.push_back({0, 0, level, 3, 3});
  }
  std::vector<HierarchicalCell> both = much;
  for (HierarchicalCell cell : little) {
    cell.participant = 1;
    both.push_back(cell);
  }
  HierarchicalPlace place;
  place.mu = {std::log(150)};
  place.kappa = {0.8};
  place.tu = 1;
  place.tv = 0.5;
  place.tw = 1;
  double apart = 0, work = 0;
  for (const auto& cells : {much, little}) {
    HierarchicalLikelihood alone(cells, ResponseModel::yes_no, {});
    apart += alone.at(place).log_likelihood;
    work += alone.work();
  }
  HierarchicalLikelihood together(both, ResponseModel::yes_no, {});
  CHECK(together.at(place).log_likelihood == Approx(apart).margin(1e-6));
  CHECK(together.work() < 6 * work);
}

TEST_CASE("who has one answer on all same trials and the other on all different ones takes few rows",
          "[hierarchical]") {
  const std::vector<HierarchicalCell> cells = {{0, 0, 0, 15, 21},  {0, 0, 200, 11, 1}, {0, 0, 300, 11, 1},
                                               {0, 0, 400, 12, 0}, {1, 0, 0, 19, 17},  {1, 0, 200, 12, 0},
                                               {1, 0, 300, 12, 0}, {1, 0, 400, 12, 0}, {2, 0, 0, 0, 36},
                                               {2, 0, 200, 11, 1}, {2, 0, 300, 12, 0}, {2, 0, 400, 12, 0}};
  HierarchicalPlace place;
  place.mu = {2.6};
  place.kappa = {0.66};
  place.tu = place.tw = 1;
  place.tv = 0.1;
  HierarchicalLikelihood usual(cells, ResponseModel::differencing, {}), fine(cells, ResponseModel::differencing, {}, 2);
  const HierarchicalLikelihood::Value value = usual.at(place);
  CHECK(usual.work() < 1e8);
  CHECK(std::abs(value.log_likelihood - fine.at(place).log_likelihood) < 1e-5);
  constexpr double kStep = 1e-3;
  for (const auto& [parameter, slope] : {std::pair{&place.mu[0], value.slope.mu[0]},
                                         {&place.kappa[0], value.slope.kappa[0]},
                                         {&place.tw, value.slope.tw}}) {
    *parameter += kStep;
    const double above = usual.at(place).log_likelihood;
    *parameter -= 2 * kStep;
    CHECK(std::abs((above - usual.at(place).log_likelihood) / (2 * kStep) - slope) < 1e-4);
    *parameter += kStep;
  }
}

TEST_CASE("people whose answers say nothing, or all the same, have a likelihood too", "[hierarchical]") {
  std::vector<HierarchicalCell> cells = published_study(4, 1);
  const double before = HierarchicalLikelihood(cells, ResponseModel::yes_no, {}).at(published_truth()).log_likelihood;
  cells.push_back({4, 0, 0, 0, 0});
  CHECK(std::abs(HierarchicalLikelihood(cells, ResponseModel::yes_no, {}).at(published_truth()).log_likelihood -
                 before) < 1e-6);
  for (const double level : {0.0, 200.0, 300.0, 400.0}) cells.push_back({5, 0, level, 12, 0});
  for (const double level : {0.0, 200.0, 300.0, 400.0})
    cells.push_back({6, 0, level, level > 0 ? 12.0 : 0.0, level > 0 ? 0.0 : 12.0});
  HierarchicalLikelihood usual(cells, ResponseModel::yes_no, {}), fine(cells, ResponseModel::yes_no, {}, 2);
  const double value = usual.at(published_truth()).log_likelihood;
  CHECK(value < before);
  CHECK(std::abs(value - fine.at(published_truth()).log_likelihood) < 1e-6);
}

}  // namespace
}  // namespace jnd
