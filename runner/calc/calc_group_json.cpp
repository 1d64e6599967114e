#include <cmath>

#include "runner/calc/calc_group.h"
#include "runner/terminal/json_output.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

Json shapiro_json(const ShapiroWilk& test) {
  return {{"w", json_number(test.w)}, {"p", json_number(test.p)}, {"status", to_text(test.status)}};
}

Json condition_json(const std::string& name, const ConditionSummary& of) {
  return {{"condition", name},
          {"n", of.n},
          {"mean", json_number(of.mean)},
          {"sd", json_number(of.sd)},
          {"median", json_number(of.median)},
          {"ci_low", json_number(of.ci_low)},
          {"ci_high", json_number(of.ci_high)},
          {"ci_within_low", json_number(of.ci_within_low)},
          {"ci_within_high", json_number(of.ci_within_high)},
          {"shapiro", shapiro_json(of.shapiro)},
          {"status", to_text(of.status)}};
}

Json t_json(const PairComparison& pair) {
  const PairedT& t = pair.t;
  return {{"t", json_number(t.t)},
          {"df", json_number(t.df)},
          {"p", json_number(t.p)},
          {"p_holm", json_number(pair.t_p_holm)},
          {"p_bh", json_number(pair.t_p_bh)},
          {"p_bonferroni", json_number(pair.t_p_bonferroni)},
          {"ci_low", json_number(t.ci_low)},
          {"ci_high", json_number(t.ci_high)},
          {"dz", json_number(t.dz)},
          {"d_av", json_number(t.d_av)},
          {"status", to_text(t.status)}};
}

Json games_howell_json(const PairComparison& pair, int groups) {
  const GamesHowell& test = pair.games_howell;
  const double half_width = games_howell_half_width(test, groups);
  return {{"q", json_number(test.q)},
          {"df", json_number(test.df)},
          {"p", json_number(test.p)},
          {"se", json_number(test.se)},
          {"ci_low", json_number(pair.mean_difference - half_width)},
          {"ci_high", json_number(pair.mean_difference + half_width)},
          {"status", to_text(test.status)}};
}

// How p was had.
Json method_json(const SignedRank& test) {
  if (test.status != TestStatus::ok) return nullptr;
  return test.exact ? "exact" : "normal";
}

Json wilcoxon_of_pair(const PairComparison& pair) {
  const SignedRank& test = pair.wilcoxon;
  return {{"v", json_number(test.v)},
          {"p", json_number(test.p)},
          {"p_holm", json_number(pair.wilcoxon_p_holm)},
          {"p_bh", json_number(pair.wilcoxon_p_bh)},
          {"method", method_json(test)},
          {"p_exact_permutation", json_number(test.p_exact_permutation)},
          {"rank_biserial", json_number(test.rank_biserial)},
          {"status", to_text(test.status)}};
}

Json pair_json(const NamedComparison& named, const PairComparison& pair) {
  return {
      {"a", named.conditions[pair.a]},
      {"b", named.conditions[pair.b]},
      {"mean_difference", json_number(pair.mean_difference)},
      {"t", t_json(pair)},
      {"games_howell", games_howell_json(pair, static_cast<int>(named.comparison.k))},
      {"tukey",
       {{"q", json_number(pair.tukey.q)}, {"p", json_number(pair.tukey.p)}, {"status", to_text(pair.tukey.status)}}},
      {"wilcoxon", wilcoxon_of_pair(pair)}};
}

// The test over all conditions, its assumptions and its sizes.
void add_anova(Json& out, const RepeatedMeasures& anova) {
  const WithinEffect& effect = anova.effect;
  out["mauchly"] = {{"w", json_number(effect.mauchly.w)},
                    {"p", json_number(effect.mauchly.p)},
                    {"status", to_text(effect.mauchly.status)}};
  out["epsilons"] = {{"gg", json_number(effect.epsilon_gg)}, {"hf", json_number(effect.epsilon_hf)}};
  out["anova"] = {{"f", json_number(effect.f)},
                  {"df1", json_number(effect.df1)},
                  {"df2", json_number(effect.df2)},
                  {"p", json_number(effect.p)},
                  {"p_gg", json_number(effect.p_gg)},
                  {"p_hf", json_number(effect.p_hf)},
                  {"p_lower_bound", json_number(effect.p_lower_bound)},
                  {"ss", json_number(effect.ss)},
                  {"ss_error", json_number(effect.ss_error)},
                  {"ss_subjects", json_number(anova.ss_subjects)},
                  {"status", to_text(anova.status)}};
  out["effect"] = {{"eta2_generalised", json_number(anova.eta2_generalised)},
                   {"eta2_partial", json_number(effect.eta2_partial)},
                   {"omega2_partial", json_number(anova.omega2_partial)},
                   {"cohen_f", json_number(anova.cohen_f)}};
  out["multivariate"] = {{"t2", json_number(effect.hotelling_t2)},   {"f", json_number(effect.hotelling_f)},
                         {"df1", json_number(effect.hotelling_df1)}, {"df2", json_number(effect.hotelling_df2)},
                         {"p", json_number(effect.hotelling_p)},     {"status", to_text(effect.hotelling_status)}};
}

}  // namespace

Json comparison_json(const NamedComparison& named) {
  const Comparison& comparison = named.comparison;
  Json out = {{"n", comparison.n}, {"conditions", named.conditions}, {"status", to_text(comparison.status)}};
  out["descriptives"] = Json::array();
  for (std::size_t j = 0; j < comparison.conditions.size(); ++j)
    out["descriptives"].push_back(condition_json(named.conditions[j], comparison.conditions[j]));
  out["residuals"] = {{"shapiro", shapiro_json(comparison.residuals)}};
  add_anova(out, comparison.anova);
  const Friedman& friedman = comparison.friedman;
  out["friedman"] = {{"chi2", json_number(friedman.chi2)},
                     {"df", friedman.df},
                     {"p", json_number(friedman.p)},
                     {"kendall_w", json_number(friedman.kendall_w)},
                     {"f_iman_davenport", json_number(friedman.f_iman_davenport)},
                     {"p_iman_davenport", json_number(friedman.p_iman_davenport)},
                     {"status", to_text(friedman.status)}};
  out["pairs"] = Json::array();
  for (const PairComparison& pair : comparison.pairs) out["pairs"].push_back(pair_json(named, pair));
  return out;
}

Json wilcoxon_json(const WilcoxonRow& row) {
  const SignedRank& test = row.test;
  Json out;
  out["item"] = row.item.empty() ? Json(nullptr) : Json(row.item);
  out["n"] = test.n;
  out["zeros"] = test.zeros;
  out["ties"] = test.ties;
  out["v"] = json_number(test.v);
  out["p"] = json_number(test.p);
  out["method"] = method_json(test);
  out["p_exact_permutation"] = json_number(test.p_exact_permutation);
  out["rank_biserial"] = json_number(test.rank_biserial);
  out["p_holm"] = json_number(row.p_holm);
  out["p_bh"] = json_number(row.p_bh);
  out["p_normal"] = json_number(test.p_normal);
  out["pratt"] = {{"z", json_number(row.pratt.z)},
                  {"p", json_number(row.pratt.p)},
                  {"p_exact_permutation", json_number(row.pratt.p_exact_permutation)}};
  out["status"] = to_text(test.status);
  return out;
}

}  // namespace jnd
