#include "data/blocks/comparison_blocks.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "analysis/numerics/moments.h"
#include "data/blocks/common_fields.h"
#include "data/blocks/statistic_fields.h"

namespace jnd {

namespace {

// One outcome under one condition, over all who have a value there.
struct ConditionRow {
  const OutcomeComparison* outcome;
  std::size_t condition;
  int participants;
  MeanEstimate mean;
  double median;
  ShapiroWilk shapiro;
  const ConditionSummary* within;  // of those who have one under every condition; null without
};

std::vector<ConditionRow> condition_rows(const std::vector<OutcomeComparison>& comparisons) {
  std::vector<ConditionRow> rows;
  for (const OutcomeComparison& outcome : comparisons)
    for (std::size_t condition = 0; condition < outcome.table.k; ++condition) {
      std::vector<double> values;
      int participants = 0;
      for (const ParticipantValues& one : outcome.everyone) {
        participants += one.gets.empty() || one.gets[condition] ? 1 : 0;
        if (std::isfinite(one.values[condition])) values.push_back(one.values[condition]);
      }
      MeanEstimate mean = mean_with_ci(values);
      if (outcome.share) keep_within_0_and_1(mean.ci_low, mean.ci_high);
      const std::vector<ConditionSummary>& within = outcome.within;
      rows.push_back({&outcome, condition, participants, mean, values.empty() ? kNaN : median_of(values),
                      shapiro_wilk(values), condition < within.size() ? &within[condition] : nullptr});
    }
  return rows;
}

Block conditions_block(const std::vector<OutcomeComparison>& comparisons, const std::vector<std::string>& names) {
  using R = ConditionRow;
  const auto within = [](auto member) {
    return [member](const R& r) { return r.within == nullptr ? std::nullopt : std::optional(r.within->*member); };
  };
  Fields<R> fields = {common<R>("outcome", [](const R& r) { return r.outcome->outcome; }),
                      common<R>("standard", [](const R& r) { return r.outcome->standard; }),
                      common<R>("title", [](const R& r) { return r.outcome->title; }),
                      common<R>("unit", [](const R& r) { return r.outcome->unit; }),
                      common<R>("condition", [names](const R& r) { return names[r.condition]; }),
                      common<R>("participants", &R::participants)};
  add_mean_fields(fields, [](const R& r) -> const MeanEstimate& { return r.mean; });
  fields.push_back(common<R>("median", &R::median));
  fields.push_back(common<R>("ci_within_low", within(&ConditionSummary::ci_within_low)));
  fields.push_back(common<R>("ci_within_high", within(&ConditionSummary::ci_within_high)));
  fields.push_back(Field<R>("n_within", "participants in that interval: with a value under every condition",
                            [](const R& r) { return r.within == nullptr ? 0 : r.within->n; }));
  add_w_test(fields, "shapiro", "W of Shapiro and Wilk's test of normality", "Shapiro",
             [](const R& r) -> const ShapiroWilk& { return r.shapiro; });
  fields.push_back(
      common<R>("status", [](const R& r) { return r.mean.n < 2 ? "too_few" : "ok"; }, {.levels = "ok too_few"}));
  Block block;
  block.id = "conditions";
  block.section = Section::tests;
  block.title = "Outcomes by condition";
  block.note = "over all who have a value; the within-subject interval (Cousineau-Morey) over those who have every one";
  block.columns = {{"outcome"},
                   {"condition"},
                   share("n", "participants", "n"),
                   {"mean"},
                   range("ci_low", "ci_high"),
                   range("ci_within_low", "ci_within_high", "within-subject CI"),
                   {"sd"},
                   {"median"},
                   {"shapiro.p"}};
  return std::move(block.with(fields, condition_rows(comparisons)));
}

struct TestRow {
  const OutcomeComparison* outcome;
  const RepeatedMeasures& anova() const { return outcome->comparison.anova; }
  const WithinEffect& effect() const { return anova().effect; }
  const Friedman& friedman() const { return outcome->comparison.friedman; }
};

void add_anova_fields(Fields<TestRow>& fields) {
  using R = TestRow;
  using F = Field<R>;
  // Undefined without a test.
  const auto tested = [](const R& r) { return r.outcome->refused.empty(); };
  const auto effect = [tested](double WithinEffect::*member) {
    return [tested, member](const R& r) { return tested(r) ? r.effect().*member : kNaN; };
  };
  const auto of = [tested](double RepeatedMeasures::*member) {
    return [tested, member](const R& r) { return tested(r) ? r.anova().*member : kNaN; };
  };
  const auto friedman = [tested](double Friedman::*member) {
    return [tested, member](const R& r) { return tested(r) ? r.friedman().*member : kNaN; };
  };
  const auto status = [tested](auto get) {
    return [tested, get](const R& r) { return tested(r) ? status_text(get(r)) : std::string("refused"); };
  };
  fields.push_back(F("anova.f", "F of the one-way repeated-measures analysis of variance", effect(&WithinEffect::f),
                     {.title = "F"}));
  fields.push_back(F("anova.df1", "its degrees of freedom", effect(&WithinEffect::df1)));
  fields.push_back(F("anova.df2", "those of its error", effect(&WithinEffect::df2)));
  fields.push_back(p_field<R>("anova.p", "p of that F, assuming sphericity", effect(&WithinEffect::p)));
  fields.push_back(
      p_field<R>("anova.p_gg", "p with Greenhouse and Geisser's correction", effect(&WithinEffect::p_gg), "p(GG)"));
  fields.push_back(p_field<R>("anova.p_hf", "p with Huynh and Feldt's correction, epsilon capped at 1",
                              effect(&WithinEffect::p_hf), "p(HF)"));
  fields.push_back(
      p_field<R>("anova.p_lower_bound", "p with the least epsilon there can be", effect(&WithinEffect::p_lower_bound)));
  fields.push_back(F("anova.ss", "its sum of squares", effect(&WithinEffect::ss)));
  fields.push_back(F("anova.ss_error", "that of its error", effect(&WithinEffect::ss_error)));
  fields.push_back(F("anova.ss_subjects", "that of the participants", of(&RepeatedMeasures::ss_subjects)));
  fields.push_back(F("anova.status", "ok, or why F is undefined", status([](const R& r) { return r.anova().status; })));
  fields.push_back(F("epsilons.gg", "Greenhouse and Geisser's epsilon", effect(&WithinEffect::epsilon_gg)));
  fields.push_back(F("epsilons.hf", "Huynh and Feldt's epsilon, uncapped", effect(&WithinEffect::epsilon_hf)));
  fields.push_back(F("effect.eta2_generalised", "generalised eta squared", of(&RepeatedMeasures::eta2_generalised),
                     {.title = "eta2 g"}));
  fields.push_back(
      F("effect.eta2_partial", "partial eta squared", effect(&WithinEffect::eta2_partial), {.title = "eta2 p"}));
  fields.push_back(F("effect.omega2_partial", "partial omega squared", of(&RepeatedMeasures::omega2_partial)));
  fields.push_back(F("effect.cohen_f", "Cohen's f", of(&RepeatedMeasures::cohen_f)));
  add_w_test(fields, "mauchly", "Mauchly's W: is the analysis of variance spherical?", "Mauchly", [tested](const R& r) {
    return tested(r) ? r.effect().mauchly : Mauchly{kNaN, kNaN, StatisticStatus::too_few};
  });
  add_w_test(
      fields, "residuals.shapiro", "Shapiro and Wilk's W of the residuals of that analysis", "Shapiro",
      [tested](const R& r) {
        return tested(r) ? r.outcome->comparison.residuals : ShapiroWilk{0, kNaN, kNaN, StatisticStatus::too_few};
      });
  fields.push_back(
      F("multivariate.t2", "Hotelling's T2, which needs no sphericity", effect(&WithinEffect::hotelling_t2)));
  fields.push_back(F("multivariate.f", "its F", effect(&WithinEffect::hotelling_f)));
  fields.push_back(F("multivariate.df1", "degrees of freedom of that F", effect(&WithinEffect::hotelling_df1)));
  fields.push_back(F("multivariate.df2", "those of the error of that F", effect(&WithinEffect::hotelling_df2)));
  fields.push_back(p_field<R>("multivariate.p", "p of that F", effect(&WithinEffect::hotelling_p)));
  fields.push_back(F("multivariate.status", "ok, or why T2 is undefined",
                     status([](const R& r) { return r.effect().hotelling_status; })));
  fields.push_back(F("friedman.chi2", "Friedman's chi-square", friedman(&Friedman::chi2), {.title = "Friedman chi2"}));
  fields.push_back(F("friedman.df", "degrees of freedom of that chi-square",
                     [tested](const R& r) { return tested(r) ? std::optional(r.friedman().df) : std::nullopt; }));
  fields.push_back(p_field<R>("friedman.p", "p of that chi-square", friedman(&Friedman::p)));
  fields.push_back(F("friedman.kendall_w", "Kendall's W", friedman(&Friedman::kendall_w), {.title = "Kendall W"}));
  fields.push_back(F("friedman.f_iman_davenport", "F of Iman and Davenport", friedman(&Friedman::f_iman_davenport)));
  fields.push_back(
      p_field<R>("friedman.p_iman_davenport", "p of that F of ranks", friedman(&Friedman::p_iman_davenport)));
  fields.push_back(F("friedman.status", "ok, or why chi-square is undefined",
                     status([](const R& r) { return r.friedman().status; })));
}

std::string who_and_why(const std::vector<LeftOut>& left_out) {
  std::string text;
  for (const LeftOut& one : left_out)
    text += fmt::format("{}{} ({})", text.empty() ? "" : "; ", one.participant, one.reason);
  return text;
}

// Which of the tests say nothing of these values, and why.
std::vector<std::string> undefined_tests(const Comparison& comparison) {
  std::vector<std::string> why;
  const RepeatedMeasures& anova = comparison.anova;
  if (anova.status == StatisticStatus::too_few)
    why.emplace_back("one participant: nothing can be tested");
  else if (anova.status == StatisticStatus::no_variance)
    why.emplace_back("the participants differ alike in every condition: F, Tukey's q and the epsilons are undefined");
  if (anova.effect.mauchly.status == StatisticStatus::singular)
    why.emplace_back(
        "the covariance is singular (a condition follows from the others): no Mauchly and no Hotelling test");
  else if (anova.effect.mauchly.status == StatisticStatus::too_few && anova.status == StatisticStatus::ok)
    why.emplace_back("fewer participants than conditions: no Mauchly and no Hotelling test");
  return why;
}

Block tests_block(const std::vector<OutcomeComparison>& comparisons) {
  using R = TestRow;
  using F = Field<R>;
  Fields<R> fields = {
      common<R>("outcome", [](const R& r) { return r.outcome->outcome; }),
      common<R>("standard", [](const R& r) { return r.outcome->standard; }),
      common<R>("title", [](const R& r) { return r.outcome->title; }),
      common<R>("unit", [](const R& r) { return r.outcome->unit; }),
      common<R>("registered", [](const R& r) { return r.outcome->registered; }, {.levels = "0 1"}),
      common<R>("n", [](const R& r) { return r.outcome->table.n; }),
      common<R>("participants", [](const R& r) { return r.outcome->table.n + r.outcome->left_out.size(); }),
      F("left_out", "those without a value in a condition, whom the tests leave out",
        [](const R& r) { return r.outcome->left_out.size(); }, {.title = "left out"}),
      F("left_out_why", "who they are, and why", [](const R& r) { return who_and_why(r.outcome->left_out); }),
      common<R>("refused", [](const R& r) { return r.outcome->refused; }),
      common<R>("status", [](const R& r) {
        return r.outcome->refused.empty() ? status_text(r.outcome->comparison.status) : "refused";
      })};
  add_anova_fields(fields);
  fields.push_back(F("shown", "", [](const R& r) { return r.outcome->outcome + (r.outcome->registered ? " *" : ""); },
                     {.title = "outcome", .place = Place::table}));
  std::vector<R> rows;
  Block block;
  bool tested = false;
  for (const OutcomeComparison& outcome : comparisons) {
    rows.push_back({&outcome});
    tested = tested || outcome.refused.empty();
    if (outcome.refused.empty())
      for (const std::string& why : undefined_tests(outcome.comparison))
        block.footnotes.push_back(fmt::format("{}: {}", outcome.outcome, why));
    if (!outcome.left_out.empty())
      block.footnotes.push_back(fmt::format("{}: left out: {}", outcome.outcome, who_and_why(outcome.left_out)));
  }
  block.id = "tests";
  block.section = Section::tests;
  block.title = "Conditions compared";
  block.note = "one-way repeated measures; p(GG): Greenhouse-Geisser; eta2: generalised, partial; Friedman by ranks";
  if (std::any_of(comparisons.begin(), comparisons.end(), [](const auto& one) { return one.registered; }))
    block.note += "; * registered";
  if (comparisons.front().table.k < 2) return std::move(block.with(fields, std::move(rows)));  // nothing to show
  block.columns = {{"shown"}, share("n", "participants", "n")};
  if (tested)
    block.columns.insert(block.columns.end(), {{"anova.f"},
                                               share("anova.df1", "anova.df2", "df", ", "),
                                               {"anova.p"},
                                               {"anova.p_gg"},
                                               {"effect.eta2_generalised"},
                                               {"effect.eta2_partial"},
                                               {"mauchly.p"},
                                               {"residuals.shapiro.p"},
                                               {"friedman.chi2"},
                                               {"friedman.p"},
                                               {"friedman.kendall_w"}});
  block.columns.push_back({"refused", {}, {}, "no test"});
  return std::move(block.with(fields, std::move(rows)));
}

struct PairRow {
  const OutcomeComparison* outcome;
  const PairComparison* pair;
  double games_howell_half;  // of its interval
};

Block pairs_block(const std::vector<OutcomeComparison>& comparisons, const std::vector<std::string>& names) {
  using R = PairRow;
  using F = Field<R>;
  const auto t = [](auto member) { return [member](const R& r) { return r.pair->t.*member; }; };
  const auto gh = [](auto member) { return [member](const R& r) { return r.pair->games_howell.*member; }; };
  const auto ranks = [](auto member) { return [member](const R& r) { return r.pair->wilcoxon.*member; }; };
  const auto of = [](double PairComparison::*member) { return [member](const R& r) { return r.pair->*member; }; };
  const Fields<R> fields = {
      common<R>("outcome", [](const R& r) { return r.outcome->outcome; }),
      common<R>("standard", [](const R& r) { return r.outcome->standard; }),
      common<R>("unit", [](const R& r) { return r.outcome->unit; }),
      common<R>("a", [names](const R& r) { return names[r.pair->a]; }),
      common<R>("b", [names](const R& r) { return names[r.pair->b]; }),
      common<R>("n", t(&PairedT::n)),
      common<R>("mean_difference", of(&PairComparison::mean_difference), {.title = "difference"}),
      F("t.t", "paired t", t(&PairedT::t), {.title = "t"}),
      F("t.df", "its degrees of freedom", t(&PairedT::df)),
      p_field<R>("t.p", "its two-sided p", t(&PairedT::p)),
      p_field<R>("t.p_holm", "t_p with Holm's correction over the pairs of the outcome", of(&PairComparison::t_p_holm),
                 "p(Holm)"),
      p_field<R>("t.p_bh", "t_p with Benjamini and Hochberg's", of(&PairComparison::t_p_bh)),
      p_field<R>("t.p_bonferroni", "t_p with Bonferroni's", of(&PairComparison::t_p_bonferroni)),
      F("t.ci_low", "lower end of the 95 % interval of mean_difference that belongs to t_p (Student)",
        t(&PairedT::ci_low)),
      F("t.ci_high", "upper end of that of t_p", t(&PairedT::ci_high)),
      F("t.dz", "mean difference / SD of the differences", t(&PairedT::dz), {.title = "dz"}),
      F("t.d_av", "mean difference / root mean square of the two SDs", t(&PairedT::d_av)),
      F("t.status", "ok, or why t is undefined", [](const R& r) { return status_text(r.pair->t.status); }),
      F("games_howell.q", "Games and Howell's q, which ignores the pairing", gh(&GamesHowell::q)),
      F("games_howell.df", "degrees of freedom of games_howell_q", gh(&GamesHowell::df)),
      p_field<R>("games_howell.p", "p of games_howell_q, over all conditions", gh(&GamesHowell::p), "Games-Howell p"),
      F("games_howell.se", "standard error of the difference", gh(&GamesHowell::se)),
      F("games_howell.ci_low", "lower end of its simultaneous 95 % interval",
        [](const R& r) { return r.pair->mean_difference - r.games_howell_half; }),
      F("games_howell.ci_high", "upper end of the simultaneous one",
        [](const R& r) { return r.pair->mean_difference + r.games_howell_half; }),
      F("games_howell.status", "ok, or why games_howell_q is undefined",
        [](const R& r) { return status_text(r.pair->games_howell.status); }),
      F("tukey.q", "Tukey's q, with the repeated-measures error term", [](const R& r) { return r.pair->tukey.q; }),
      p_field<R>(
          "tukey.p", "p of tukey_q, over all conditions", [](const R& r) { return r.pair->tukey.p; }, "Tukey p"),
      F("tukey.status", "ok, or why tukey_q is undefined",
        [](const R& r) { return status_text(r.pair->tukey.status); }),
      F("wilcoxon.v", "Wilcoxon's V", ranks(&SignedRank::v), {.title = "Wilcoxon V"}),
      p_field<R>("wilcoxon.p", "p of wilcoxon_v as R computes it", ranks(&SignedRank::p)),
      p_field<R>("wilcoxon.p_holm", "wilcoxon_p with Holm's correction over the pairs of the outcome",
                 of(&PairComparison::wilcoxon_p_holm), "p(Holm)"),
      p_field<R>("wilcoxon.p_bh", "wilcoxon_p with Benjamini and Hochberg's", of(&PairComparison::wilcoxon_p_bh)),
      F("wilcoxon.method", "exact or normal: what wilcoxon_p is",
        [](const R& r) { return method_of(r.pair->wilcoxon.status, r.pair->wilcoxon.exact); },
        {.levels = "exact normal"}),
      p_field<R>("wilcoxon.p_exact_permutation", "exact permutation p with midranks",
                 ranks(&SignedRank::p_exact_permutation), "p(exact)"),
      F("wilcoxon.rank_biserial", "effect size, -1 to 1", ranks(&SignedRank::rank_biserial)),
      F("wilcoxon.status", "ok, or why wilcoxon_v is undefined",
        [](const R& r) { return status_text(r.pair->wilcoxon.status); }),
      F("shown", "", [](const R& r) { return r.outcome->outcome + (r.outcome->registered ? " *" : ""); },
        {.title = "outcome", .place = Place::table})};
  std::vector<R> rows;
  for (const OutcomeComparison& outcome : comparisons)
    if (outcome.refused.empty())
      for (const PairComparison& pair : outcome.comparison.pairs)
        rows.push_back(
            {&outcome, &pair, games_howell_half_width(pair.games_howell, static_cast<int>(outcome.table.k))});
  Block block;
  block.id = "pairs";
  block.section = Section::tests;
  block.title = "Pairs of conditions";
  block.note =
      "Holm over the pairs of an outcome; Games-Howell and Tukey ignore the pairing; dz: mean difference / SD of the "
      "differences";
  block.columns = {{"shown"},
                   share("a", "b", "pair", " - "),
                   {"n"},
                   {"mean_difference"},
                   range("t.ci_low", "t.ci_high"),
                   {"t.t"},
                   {"t.p"},
                   {"t.p_holm"},
                   {"t.dz"},
                   {"games_howell.p"},
                   {"tukey.p"},
                   {"wilcoxon.v"},
                   {"wilcoxon.p"},
                   {"wilcoxon.p_holm"},
                   {"wilcoxon.p_exact_permutation"}};
  return std::move(block.with(fields, std::move(rows)));
}

struct ValueRow {
  const OutcomeComparison* outcome;
  const ParticipantValues* of;
  std::size_t condition;
};

// A row for everyone who gets the condition.
Block values_block(const std::vector<OutcomeComparison>& comparisons, const std::vector<std::string>& names,
                   const std::vector<std::string>& groups) {
  using R = ValueRow;
  using F = Field<R>;
  Fields<R> fields = {common<R>("outcome", [](const R& r) { return r.outcome->outcome; }),
                      common<R>("standard", [](const R& r) { return r.outcome->standard; }),
                      common<R>("participant", [](const R& r) { return r.of->participant; }),
                      common<R>("condition", [names](const R& r) { return names[r.condition]; }),
                      F("value", "what is compared, in the unit that conditions.csv names; empty where there is none",
                        [](const R& r) { return r.of->values[r.condition]; }),
                      F("tested", "1 for who has a value under every condition of theirs",
                        [](const R& r) { return r.of->missing.empty(); }, {.levels = "0 1"})};
  if (!groups.empty())
    fields.insert(fields.begin() + 3, common<R>("group", [groups](const R& r) {
                    return r.of->group ? groups[static_cast<std::size_t>(*r.of->group)] : std::string();
                  }));
  std::vector<R> rows;
  for (const OutcomeComparison& outcome : comparisons)
    for (const ParticipantValues& one : outcome.everyone)
      for (std::size_t condition = 0; condition < one.values.size(); ++condition)
        if (one.gets.empty() || one.gets[condition]) rows.push_back({&outcome, &one, condition});
  Block block;
  block.id = "values";
  block.section = Section::tests;
  return std::move(block.with(fields, std::move(rows)));
}

}  // namespace

std::vector<Block> comparison_blocks(const std::vector<OutcomeComparison>& comparisons,
                                     const std::vector<std::string>& names, const std::vector<std::string>& groups) {
  std::vector<Block> blocks;
  blocks.push_back(conditions_block(comparisons, names));
  blocks.push_back(tests_block(comparisons));
  blocks.push_back(pairs_block(comparisons, names));
  blocks.push_back(values_block(comparisons, names, groups));
  return blocks;
}

}  // namespace jnd
