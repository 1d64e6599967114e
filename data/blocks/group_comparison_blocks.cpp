#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/blocks/common_fields.h"
#include "data/blocks/comparison_blocks.h"
#include "data/blocks/statistic_fields.h"

namespace jnd {

namespace {

struct GroupMeanRow {
  const GroupsCompared* of;
  const GroupMean* mean;
};

Block groups_block(const GroupsCompared& compared, const std::vector<std::string>& groups,
                   const std::vector<std::string>& conditions) {
  using R = GroupMeanRow;
  using F = Field<R>;
  Fields<R> fields = {
      common<R>("group", [groups](const R& r) { return groups[static_cast<std::size_t>(r.mean->group)]; }),
      common<R>("condition",
                [conditions](const R& r) {
                  return r.mean->condition < 0 ? std::string()
                                               : conditions[static_cast<std::size_t>(r.mean->condition)];
                }),
      common<R>("outcome", [](const R& r) { return r.of->outcome; }),
      common<R>("standard", [](const R& r) { return r.of->standard; }),
      common<R>("unit", [](const R& r) { return r.of->unit; }),
      common<R>("participants", [](const R& r) { return r.mean->participants; })};
  add_mean_fields(fields, [](const R& r) -> const MeanEstimate& { return r.mean->mean; });
  fields.push_back(common<R>("median", [](const R& r) { return r.mean->median; }));
  add_w_test(fields, "shapiro", "W of Shapiro and Wilk's test of normality", "Shapiro",
             [](const R& r) -> const ShapiroWilk& { return r.mean->shapiro; });
  fields.push_back(
      common<R>("status", [](const R& r) { return r.mean->mean.n < 2 ? "too_few" : "ok"; }, {.levels = "ok too_few"}));
  fields.push_back(F("shown", "",
                     [conditions](const R& r) {
                       return r.mean->condition < 0 ? std::string("mean of them")
                                                    : conditions[static_cast<std::size_t>(r.mean->condition)];
                     },
                     {.title = "condition", .place = Place::table}));
  Block block;
  block.id = "groups";
  block.section = Section::tests;
  block.title = "Groups of participants";
  block.note = fmt::format("{}{}{}; means with Student's 95 % interval", compared.title,
                           compared.unit.empty() ? "" : ", ", compared.unit);
  block.columns = {{"group"}, {"shown"}, share("n", "participants", "n used"), {"mean"}, range("ci_low", "ci_high"),
                   {"sd"},    {"median"}};
  if (compared.test != BetweenTest::none && !compared.refused.empty())
    block.footnotes.push_back("no test of the groups: " + compared.refused);
  block.answer = {block.title, block.note, block.columns, ""};
  std::vector<R> rows;
  for (const GroupMean& mean : compared.means) rows.push_back({&compared, &mean});
  return std::move(block.with(fields, std::move(rows)));
}

struct EffectRow {
  const GroupsCompared* of;
  std::string effect;
  const MixedEffect* tested;
};

Block effects_block(const GroupsCompared& compared) {
  using R = EffectRow;
  using F = Field<R>;
  const MixedAnova& anova = compared.comparison.anova;
  const auto number = [](double MixedEffect::*member) {
    return [member](const R& r) { return std::isnan(r.tested->f) ? kNaN : r.tested->*member; };
  };
  const Fields<R> fields = {
      common<R>("test", [](const R& r) { return r.of->test; }),
      common<R>("outcome", [](const R& r) { return r.of->outcome; }),
      common<R>("standard", [](const R& r) { return r.of->standard; }),
      common<R>("unit", [](const R& r) { return r.of->unit; }),
      common<R>("n", [](const R& r) { return r.of->participants.size(); }),
      F("effect", "what is tested: group, condition, series, or whether the effect of one depends on another",
        &R::effect, {.levels = "group condition \"group x condition\""}),
      F("f", "F of that effect", number(&MixedEffect::f), {.title = "F"}),
      F("df1", "degrees of freedom of f", number(&MixedEffect::df1)),
      F("df2", "those of the error of f", number(&MixedEffect::df2)),
      common<R>("p", number(&MixedEffect::p), {.shown = Shown::p_value}),
      p_field<R>("p_gg", "that p with Greenhouse and Geisser's correction; empty of the groups",
                 number(&MixedEffect::p_gg), "p(GG)"),
      p_field<R>("p_hf", "that p with Huynh and Feldt's; empty of the groups", number(&MixedEffect::p_hf), "p(HF)"),
      F("epsilon_gg", "Greenhouse and Geisser's epsilon of what is within participants",
        [](const R& r) { return r.of->comparison.anova.epsilon_gg; }),
      F("epsilon_hf", "Huynh and Feldt's, uncapped", [](const R& r) { return r.of->comparison.anova.epsilon_hf; }),
      F("ss", "sum of squares of the effect", number(&MixedEffect::ss)),
      F("ss_error", "sum of squares of its error", number(&MixedEffect::ss_error)),
      F("eta2_generalised", "generalised eta squared of the effect", number(&MixedEffect::eta2_generalised),
        {.title = "eta2 g"}),
      F("eta2_partial", "partial eta squared of the effect", number(&MixedEffect::eta2_partial), {.title = "eta2 p"}),
      common<R>("status", [](const R& r) { return status_text(r.tested->status); })};
  std::vector<R> rows = {{&compared, "group", &anova.group}};
  const bool mixed = compared.table.values.k > 1;
  if (mixed) {
    rows.push_back({&compared, "condition", &anova.condition});
    rows.push_back({&compared, "group x condition", &anova.interaction});
  }
  Block block;
  block.id = "between";
  block.section = Section::tests;
  block.title = "Groups compared";
  block.note =
      fmt::format("analysis of variance with groups between {}participants{}; outcome: {}; {} participants",
                  mixed ? "and conditions within " : "", mixed ? "; p(GG), p(HF): corrected for sphericity" : "",
                  compared.title, compared.participants.size());
  for (const LeftOut& one : compared.left_out)
    block.footnotes.push_back(fmt::format("left out: {} ({})", one.participant, one.reason));
  const auto one_has = [&rows](StatisticStatus status) {
    return std::any_of(rows.begin(), rows.end(), [status](const R& row) { return row.tested->status == status; });
  };
  if (one_has(StatisticStatus::no_variance))
    block.footnotes.emplace_back("an effect has no error beyond rounding: its F is undefined");
  if (one_has(StatisticStatus::too_few))
    block.footnotes.emplace_back("an effect has no degrees of freedom: too few participants in the groups");
  if (mixed && anova.unequal)
    block.footnotes.emplace_back(
        "the groups differ in size: sums of squares are of type I (group, condition, group x condition)");
  block.columns = {
      {"effect"},       {"f"},     share("df1", "df2", "df", ", "), {"p"}, {"p_gg"}, {"p_hf"}, {"eta2_generalised"},
      {"eta2_partial"}, {"status"}};
  if (compared.test == BetweenTest::mixed_anova) block.answer = {block.title, block.note, block.columns, ""};
  return std::move(block.with(fields, std::move(rows)));
}

struct GroupPairRow {
  const GroupsCompared* of;
  const GroupPair* pair;
};

Block group_pairs_block(const GroupsCompared& compared, const std::vector<std::string>& groups,
                        const std::vector<std::string>& conditions) {
  using R = GroupPairRow;
  using F = Field<R>;
  const auto t = [](auto member) { return [member](const R& r) { return r.pair->welch.*member; }; };
  const auto ranks = [](auto member) { return [member](const R& r) { return r.pair->ranks.*member; }; };
  const bool mixed = compared.table.values.k > 1;
  const Fields<R> fields = {
      common<R>("test", [](const R& r) { return r.of->test; }),
      common<R>("outcome", [](const R& r) { return r.of->outcome; }),
      common<R>("standard", [](const R& r) { return r.of->standard; }),
      common<R>("unit", [](const R& r) { return r.of->unit; }),
      common<R>("a", [groups](const R& r) { return groups[r.pair->a]; }),
      common<R>("b", [groups](const R& r) { return groups[r.pair->b]; }),
      common<R>("condition",
                [conditions, mixed](const R& r) { return mixed ? conditions[r.pair->condition] : std::string(); }),
      F("n_a", "participants of the first group", t(&WelchT::n_x)),
      F("n_b", "participants of the second", t(&WelchT::n_y)),
      common<R>("mean_difference", t(&WelchT::mean_difference), {.title = "difference"}),
      F("welch.t", "Welch's t", t(&WelchT::t), {.title = "Welch t"}),
      F("welch.df", "degrees of freedom of welch_t", t(&WelchT::df), {.title = "df"}),
      p_field<R>("welch.p", "two-sided p of welch_t", t(&WelchT::p)),
      p_field<R>(
          "welch.p_holm", "welch_p with Holm's correction over the pairs of groups",
          [](const R& r) { return r.pair->welch_p_holm; }, "p(Holm)"),
      F("welch.ci_low", "lower end of the 95 % interval of mean_difference that belongs to welch_p",
        t(&WelchT::ci_low)),
      F("welch.ci_high", "upper end of that of welch_p", t(&WelchT::ci_high)),
      F("welch.d", "Cohen's d: difference / pooled SD", t(&WelchT::d), {.title = "d"}),
      F("welch.status", "ok, or why welch_t is undefined",
        [](const R& r) { return status_text(r.pair->welch.status); }),
      F("mann_whitney.w", "Mann and Whitney's W: pairs of participants with a above b", ranks(&MannWhitney::w),
        {.title = "Mann-Whitney W"}),
      p_field<R>("mann_whitney.p", "two-sided p of mann_whitney_w", ranks(&MannWhitney::p)),
      p_field<R>(
          "mann_whitney.p_holm", "mann_whitney_p with Holm's correction over the pairs of groups",
          [](const R& r) { return r.pair->ranks_p_holm; }, "p(Holm)"),
      F("mann_whitney.method", "exact or normal: what mann_whitney_p is",
        [](const R& r) { return method_of(r.pair->ranks.status, r.pair->ranks.exact); }, {.levels = "exact normal"}),
      F("mann_whitney.ties", "1 where values of the two groups are equal", ranks(&MannWhitney::ties),
        {.levels = "0 1"}),
      F("mann_whitney.rank_biserial", "2 W / (n_a n_b) - 1", ranks(&MannWhitney::rank_biserial),
        {.title = "rank-biserial"}),
      F("mann_whitney.status", "ok, or why mann_whitney_w is undefined",
        [](const R& r) { return status_text(r.pair->ranks.status); })};
  std::vector<R> rows;
  for (const GroupPair& pair : compared.comparison.pairs) rows.push_back({&compared, &pair});
  Block block;
  block.id = "group_pairs";
  block.section = Section::tests;
  block.title = "Pairs of groups";
  block.note = fmt::format("{}; p(Holm): over the pairs; outcome: {}; {} participants",
                           mixed ? "under each condition" : "of participants' means over their conditions",
                           compared.title, compared.participants.size());
  for (const LeftOut& one : compared.left_out)
    block.footnotes.push_back(fmt::format("left out: {} ({})", one.participant, one.reason));
  block.columns = {share("a", "b", "pair", " - ")};
  if (mixed) block.columns.push_back({"condition"});
  block.columns.insert(block.columns.end(), {share("n_a", "n_b", "n", " and "),
                                             {"mean_difference"},
                                             range("welch.ci_low", "welch.ci_high"),
                                             {"welch.t"},
                                             {"welch.df"},
                                             {"welch.p"},
                                             {"welch.p_holm"},
                                             {"welch.d"},
                                             {"mann_whitney.w"},
                                             {"mann_whitney.p"},
                                             {"mann_whitney.p_holm"},
                                             {"mann_whitney.rank_biserial"}});
  if (compared.test == BetweenTest::welch)
    block.answer = {"Groups compared: Welch's t of each pair",
                    block.note,
                    {share("a", "b", "pair", " - "),
                     share("n_a", "n_b", "n", " and "),
                     {"mean_difference"},
                     range("welch.ci_low", "welch.ci_high"),
                     {"welch.t"},
                     {"welch.df"},
                     {"welch.p"},
                     {"welch.p_holm"},
                     {"welch.d"}},
                    ""};
  if (compared.test == BetweenTest::mann_whitney)
    block.answer = {"Groups compared: Mann-Whitney test of each pair",
                    block.note,
                    {share("a", "b", "pair", " - "),
                     share("n_a", "n_b", "n", " and "),
                     {"mean_difference"},
                     {"mann_whitney.w"},
                     {"mann_whitney.p"},
                     {"mann_whitney.p_holm"},
                     {"mann_whitney.rank_biserial"}},
                    ""};
  return std::move(block.with(fields, std::move(rows)));
}

}  // namespace

std::vector<Block> group_comparison_blocks(const GroupsCompared& compared, const std::vector<std::string>& groups,
                                           const std::vector<std::string>& conditions) {
  std::vector<Block> blocks;
  blocks.push_back(groups_block(compared, groups, conditions));
  if (!compared.tested()) return blocks;
  blocks.push_back(effects_block(compared));
  blocks.push_back(group_pairs_block(compared, groups, conditions));
  return blocks;
}

}  // namespace jnd
