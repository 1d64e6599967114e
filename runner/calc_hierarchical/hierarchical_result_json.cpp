#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "runner/calc_hierarchical/calc_hierarchical_check.h"
#include "runner/calc_hierarchical/hierarchical_result.h"
#include "runner/terminal/json_output.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;

ordered_json ends_json(const ProfileEnds& ends, bool as_ratio = false) {
  const auto number = [as_ratio](double end) { return json_number(as_ratio ? std::exp(end) : end); };
  return ordered_json::array({number(ends.low), number(ends.high)});
}

// By condition; with one JND for all conditions the first that has it.
std::vector<ConditionMean> means_of(const HierarchicalResult& result, const HierarchicalFit& fit) {
  if (!result.model.one_mean) return fit.conditions;
  const auto found = std::find_if(fit.conditions.begin(), fit.conditions.end(),
                                  [](const ConditionMean& one) { return !std::isnan(one.mu); });
  return {found == fit.conditions.end() ? fit.conditions.front() : *found};
}

std::string_view word(const ProfileEnds& ends) {
  return word_of(kEndsStatusWords, ends.status);
}

ordered_json people_json(const HierarchicalResult& result) {
  ordered_json people = ordered_json::array();
  const std::size_t conditions = result.answers.conditions.size();
  for (std::size_t i = 0; i < result.people.size(); ++i) {
    const PersonEstimate& one = result.people[i];
    ordered_json person;
    person["participant"] = result.answers.participants[i / conditions];
    person["condition"] = result.answers.conditions[i % conditions];
    person["jnd"] = json_number(std::exp(one.mean));
    person["mu"] = json_number(one.mean);
    person["mu_sd"] = json_number(one.sd);
    person["jnd_alone"] = json_number(std::exp(one.alone));
    person["status_alone"] = word_of(kSlopeStatusWords, one.status);
    people.push_back(std::move(person));
  }
  return people;
}

ordered_json sureness_json(const HierarchicalResult& result) {
  if (!result.answers.graded) return nullptr;
  ordered_json out;
  for (const auto& [name, one] : {std::pair("below", result.sureness.at(0)), {"above", result.sureness.at(1)}}) {
    out[name] = json_number(one.value);
    out[fmt::format("{}_ci", name)] = ends_json(one.ends);
    out[fmt::format("{}_ci_status", name)] = word(one.ends);
    out[fmt::format("{}_status", name)] = word_of(kSharedStatusWords, one.status);
  }
  ordered_json narrower = ordered_json::array();
  for (const double share : result.narrower) narrower.push_back(json_number(share));
  out["narrower"] = std::move(narrower);
  return out;
}

ordered_json shared_json(const HierarchicalResult& result) {
  ordered_json shared = ordered_json::array();
  for (const SharedEstimate& one : result.shared)
    shared.push_back({{"parameter", word_of(kSharedParameterWords, one.parameter)},
                      {"status", word_of(kSharedStatusWords, one.status)},
                      {"value", json_number(one.value)},
                      {"ci", ends_json(one.ends)},
                      {"ci_status", word(one.ends)},
                      {"lr", json_number(one.lr)},
                      {"p", json_number(one.p)}});
  return shared;
}

ordered_json without_json(const HierarchicalResult& result) {
  const HierarchicalFit& fit = *result.without;
  ordered_json mu = ordered_json::array(), jnd = mu, mu_ci = mu, jnd_ci = mu, ci_status = mu;
  for (const ConditionMean& one : means_of(result, fit)) {
    mu.push_back(json_number(one.mu));
    jnd.push_back(json_number(std::exp(one.mu)));
    mu_ci.push_back(ends_json(one.ends));
    jnd_ci.push_back(ends_json(one.ends, true));
    ci_status.push_back(word(one.ends));
  }
  return {{"converged", fit.maximum.converged},
          {"loglik", json_number(fit.maximum.log_likelihood)},
          {"mu", std::move(mu)},
          {"group_jnd", std::move(jnd)},
          {"mu_ci", std::move(mu_ci)},
          {"jnd_ci", std::move(jnd_ci)},
          {"ci_status", std::move(ci_status)}};
}

}  // namespace

ordered_json hierarchical_json(const HierarchicalResult& result) {
  const HierarchicalFit& fit = result.fit;
  const HierarchicalPlace& place = fit.maximum.place;
  ordered_json out;
  out["conditions"] = result.answers.conditions;
  out["participants"] = fit.participants;
  out["trials"] = std::llround(fit.trials);
  out["observer"] = word_of(kResponseModelWords, result.model.response);
  out["lapse"] = fit.maximum.shared.lapse;
  out["converged"] = fit.maximum.converged;
  out["exact"] = fit.exact;
  out["pooled_levels"] = result.answers.pooled
                             ? ordered_json::array({result.answers.pooled.from, result.answers.pooled.to})
                             : ordered_json(nullptr);
  out["cautions"] = result.cautions();
  out["loglik"] = json_number(fit.maximum.log_likelihood);
  if (result.without) {
    out["shared"] = shared_json(result);
    out["without"] = without_json(result);
  }
  ordered_json status = ordered_json::array(), mu = status, jnd = status, criteria = status, mu_ci = status,
               jnd_ci = status, ci_status = status, criteria_ci = status, falling = status;
  for (std::size_t c = 0; c < fit.conditions.size(); ++c) {
    const ConditionMean& one = fit.conditions[c];
    falling.push_back(static_cast<bool>(result.falling[c]));
    criteria_ci.push_back(ends_json(one.criterion_ends));
    criteria.push_back(json_number(one.criterion));
  }
  for (const ConditionMean& one : means_of(result, fit)) {
    status.push_back(word_of(kSlopeStatusWords, one.status));
    mu.push_back(json_number(one.mu));
    jnd.push_back(json_number(std::exp(one.mu)));
    mu_ci.push_back(ends_json(one.ends));
    jnd_ci.push_back(ends_json(one.ends, true));
    ci_status.push_back(word(one.ends));
  }
  out["status"] = std::move(status);
  out["falling"] = std::move(falling);
  out["mu"] = std::move(mu);
  out["group_jnd"] = std::move(jnd);
  out[result.choice() ? "alpha" : "kappa"] = std::move(criteria);
  if (result.choice()) out["alpha_ci"] = std::move(criteria_ci);
  out["tu"] = place.tu;
  out["tv"] = fit.tv == SpreadStatus::by_condition ? ordered_json(nullptr) : json_number(place.tv);
  ordered_json own_tv = ordered_json::array(), own_tv_status = own_tv;
  for (const ConditionMean& one : fit.conditions) {
    if (fit.tv != SpreadStatus::by_condition) break;
    own_tv.push_back(json_number(one.tv));
    own_tv_status.push_back(word_of(kSpreadStatusWords, one.tv_status));
  }
  out["own_tv"] = std::move(own_tv);
  out["own_tv_status"] = std::move(own_tv_status);
  out["tw"] = place.tw;
  out["rho"] = result.model.rho ? json_number(place.rho) : ordered_json(nullptr);
  for (const auto& [name, one] :
       {std::pair{"tu_status", fit.tu}, {"tv_status", fit.tv}, {"tw_status", fit.tw}, {"rho_status", fit.rho}})
    out[name] = word_of(kSpreadStatusWords, one);
  out["sureness"] = sureness_json(result);
  if (fit.df > 0) {
    out["converged_equal_mu"] = fit.common.converged;
    out["loglik_equal_mu"] = json_number(fit.common.log_likelihood);
    out["lr_equal_mu"] = json_number(fit.lr);
    out["df"] = fit.df;
    out["p_equal_mu"] = json_number(fit.p);
    out["mu_equal"] = json_number(fit.common.place.mu.front());
  }
  if (result.bootstrap)
    out["bootstrap"] = {{"replicates", result.bootstrap->replicates},
                        {"as_large", result.bootstrap->as_large},
                        {"p_equal_mu", result.bootstrap->p}};
  out["mu_ci"] = std::move(mu_ci);
  out["jnd_ci"] = std::move(jnd_ci);
  out["ci_status"] = std::move(ci_status);
  ordered_json differences = ordered_json::array();
  for (const ConditionDifference& one : fit.differences)
    differences.push_back({{"a", one.a + 1},
                           {"b", one.b + 1},
                           {"diff", json_number(one.difference)},
                           {"ci", ends_json(one.ends)},
                           {"ratio", json_number(std::exp(one.difference))},
                           {"ratio_ci", ends_json(one.ends, true)},
                           {"ci_status", word(one.ends)},
                           {"lr", json_number(one.lr)},
                           {"p", json_number(one.p)}});
  out["mu_diff"] = std::move(differences);
  out["people"] = people_json(result);
  out["people_note"] = kPersonRange;
  if (result.check) out["check"] = predictive_json(*result.check, result.answers.conditions, result.origin());
  return out;
}

}  // namespace jnd
