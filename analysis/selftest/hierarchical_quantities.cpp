#include "analysis/selftest/hierarchical_quantities.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/selftest/reference_numbers.h"

namespace jnd {

namespace {

using nlohmann::json;

struct HierarchicalQuantities {
  SelftestQuantity likelihood{"hierarchical model, log-likelihood", 1e-6};
  SelftestQuantity means{"hierarchical model, ln JND and criteria", 1e-4};
  SelftestQuantity spreads{"hierarchical model, spreads", 1e-3};
  SelftestQuantity bounds{"hierarchical model, profile intervals", 3e-4};
  SelftestQuantity tests{"hierarchical model, likelihood-ratio tests", 1e-5};
};

void compare_ends(SelftestQuantity& quantity, const ProfileEnds& ours, const json& reference) {
  if (reference.is_null()) return;  // not computed there
  quantity.absolute(ours.low, reference_number(reference.at(0)));
  quantity.absolute(ours.high, reference_number(reference.at(1)));
}

// Criteria of choices and their spread have the unit of the levels; here they are shares of the JND.
void compare_hierarchical(HierarchicalQuantities& q, HierarchicalAnalysis& analysis, bool choice,
                          const json& expected) {
  const HierarchicalFit& fit = analysis.fit();
  const HierarchicalPlace& place = fit.maximum.place;
  const double unit = choice ? std::exp(place.mu.front()) : 1;
  q.likelihood.absolute(fit.maximum.log_likelihood, reference_number(expected.at("loglik")));
  const json& criteria = expected.at(choice ? "alpha" : "kappa");
  for (std::size_t c = 0; c < fit.conditions.size(); ++c)
    q.means.absolute(fit.conditions[c].criterion / unit, reference_number(criteria.at(c)) / unit);
  for (std::size_t c = 0; c < expected.at("mu").size(); ++c)
    q.means.absolute(fit.conditions[c].mu, reference_number(expected.at("mu").at(c)));
  q.spreads.absolute(place.tu, reference_number(expected.at("tu")));
  if (expected.contains("tv")) q.spreads.absolute(place.tv, reference_number(expected.at("tv")));
  q.spreads.absolute(place.tw / unit, reference_number(expected.at("tw")) / unit);
  if (expected.contains("lr_equal_mu")) {
    q.tests.absolute(fit.lr, reference_number(expected.at("lr_equal_mu")));
    q.tests.absolute(fit.p, reference_number(expected.at("p_equal_mu")));
  }
  if (expected.contains("mu_ci")) {
    analysis.add_intervals();
    for (std::size_t c = 0; c < fit.conditions.size(); ++c)
      compare_ends(q.bounds, fit.conditions[c].ends, expected.at("mu_ci").at(c));
  }
  if (!expected.contains("mu_diff")) return;
  const std::vector<ConditionDifference> differences = analysis.complete({.pairs = analysis.pairs()}).differences;
  for (const json& one : expected.at("mu_diff"))
    for (const ConditionDifference& ours : differences)
      if (ours.a + 1 == one.at("a") && ours.b + 1 == one.at("b")) {
        q.means.absolute(ours.difference, reference_number(one.at("diff")));
        compare_ends(q.bounds, ours.ends, one.at("ci"));
      }
}

}  // namespace

std::vector<HierarchicalCell> reference_answers(const json& one_case) {
  std::vector<HierarchicalCell> cells;
  for (const json& row : one_case.at("input").at("rows")) {
    const double n = row.at(3), positive = row.at(4);
    cells.push_back({row.at(0).get<int>() - 1, row.at(1).get<int>() - 1, row.at(2), positive, n - positive});
  }
  return cells;
}

HierarchicalModel reference_model(const json& fit, ResponseModel response) {
  const json& given = fit.at("model");
  const auto has = [&given](const char* name) {
    return std::any_of(given.at("random").begin(), given.at("random").end(),
                       [name](const json& one) { return one == name; });
  };
  HierarchicalModel model;
  model.response = response;
  model.shared.lapse = given.at("lapse");
  model.tu = has("tu");
  model.tv = has("tv");
  model.tw = has("tw");
  model.rho = has("rho");
  model.one_mean = given.at("label") == "a_common_slope";
  return model;
}

std::vector<SelftestQuantity> hierarchical_quantities() {
  HierarchicalQuantities q;
  for (const auto& [task, response] :
       {std::pair{"same_different", ResponseModel::yes_no}, {"which", ResponseModel::choice}})
    for (const json& one : reference_numbers("hierarchical").at(task))
      for (const json& fit : one.at("expected")) {
        HierarchicalAnalysis analysis(reference_answers(one), reference_model(fit, response));
        compare_hierarchical(q, analysis, response == ResponseModel::choice, fit.at("expected"));
      }
  return {q.likelihood, q.means, q.spreads, q.bounds, q.tests};
}

}  // namespace jnd
