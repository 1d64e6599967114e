#include "data/fields/between_fields.h"

namespace jnd {

namespace {

constexpr const char* kKindsOfSessions = "real pilot simulated";

template <typename Get>
Field<BetweenRow> p_of(std::string_view key, std::string_view meaning, Get get, std::string_view title) {
  return {key, meaning, get, {.title = title, .shown = Shown::p_value}};
}

void add_effects(Fields<BetweenRow>& fields) {
  using R = BetweenRow;
  using F = Field<R>;
  const auto number = [&](const char* key, const char* meaning, double MixedEffect::*member, const char* title,
                          Shown shown = Shown::number) {
    fields.push_back(
        F(key, meaning, [member](const R& r) { return r.tested->*member; }, {.title = title, .shown = shown}));
  };
  fields.push_back(F("effect", "group, condition, or whether conditions differ between groups", &R::effect,
                     {.levels = "group condition \"group x condition\""}));
  number("f", "F of the mixed analysis of variance", &MixedEffect::f, "F");
  number("df1", "its degrees of freedom", &MixedEffect::df1, "df1");
  number("df2", "of its error", &MixedEffect::df2, "df2");
  number("p", "p; of what is within participants assuming sphericity", &MixedEffect::p, "p", Shown::p_value);
  number("p_gg", "p with Greenhouse and Geisser's correction; empty of the groups", &MixedEffect::p_gg, "p(GG)",
         Shown::p_value);
  number("p_hf", "p with Huynh and Feldt's; empty of the groups", &MixedEffect::p_hf, "p(HF)", Shown::p_value);
  number("eta2_generalised", "generalised eta squared", &MixedEffect::eta2_generalised, "eta2 g");
  number("eta2_partial", "partial eta squared", &MixedEffect::eta2_partial, "eta2 p");
  fields.push_back(F("status", "ok, or why the test is undefined",
                     [](const R& r) { return std::string(to_text(r.tested->status)); }));
}

void add_pair(Fields<BetweenRow>& fields, const Protocol& protocol) {
  using R = BetweenRow;
  using F = Field<R>;
  const auto name = [&protocol](std::size_t group) { return protocol.groups[group].name; };
  fields.push_back(
      F("group_a", "first group", [name](const R& r) { return name(r.pair->a); }, {.levels = group_levels(protocol)}));
  fields.push_back(
      F("group_b", "second group", [name](const R& r) { return name(r.pair->b); }, {.levels = group_levels(protocol)}));
  fields.push_back(F("n_a", "participants of the first", [](const R& r) { return r.pair->welch.n_x; }));
  fields.push_back(F("n_b", "of the second", [](const R& r) { return r.pair->welch.n_y; }));
  fields.push_back(F("mean_difference", "difference of the means, a - b, in the outcome's unit",
                     [](const R& r) { return r.pair->welch.mean_difference; },
                     {.title = "difference", .shown = Shown::compact}));
}

void add_welch(Fields<BetweenRow>& fields) {
  using R = BetweenRow;
  using F = Field<R>;
  fields.push_back(F("ci95_low", "lower end of its 95 % interval (Welch)",
                     [](const R& r) { return r.pair->welch.ci_low; }, {.shown = Shown::compact}));
  fields.push_back(
      F("ci95_high", "upper end", [](const R& r) { return r.pair->welch.ci_high; }, {.shown = Shown::compact}));
  fields.push_back(F("t", "Welch's t", [](const R& r) { return r.pair->welch.t; }));
  fields.push_back(F("df", "its degrees of freedom", [](const R& r) { return r.pair->welch.df; }, {.digits = 1}));
  fields.push_back(p_of(
      "p", "its two-sided p", [](const R& r) { return r.pair->welch.p; }, "p"));
  fields.push_back(p_of(
      "p_holm", "that p with Holm's correction over the pairs of groups",
      [](const R& r) { return r.pair->welch_p_holm; }, "p(Holm)"));
  fields.push_back(
      F("d", "Cohen's d: difference / pooled SD", [](const R& r) { return r.pair->welch.d; }, {.digits = 2}));
  fields.push_back(F("status", "ok, or why the test is undefined",
                     [](const R& r) { return std::string(to_text(r.pair->welch.status)); }));
}

void add_ranks(Fields<BetweenRow>& fields) {
  using R = BetweenRow;
  using F = Field<R>;
  fields.push_back(F("w", "Mann and Whitney's W: pairs of participants with a above b",
                     [](const R& r) { return r.pair->ranks.w; }, {.title = "W", .digits = 1}));
  fields.push_back(p_of(
      "p", "its two-sided p", [](const R& r) { return r.pair->ranks.p; }, "p"));
  fields.push_back(p_of(
      "p_holm", "that p with Holm's correction over the pairs of groups",
      [](const R& r) { return r.pair->ranks_p_holm; }, "p(Holm)"));
  fields.push_back(F("exact", "1 where p is exact, 0 where it is of the normal approximation",
                     [](const R& r) { return r.pair->ranks.exact; }, {.levels = "0 1"}));
  fields.push_back(F("rank_biserial", "2 W / (n_a n_b) - 1", [](const R& r) { return r.pair->ranks.rank_biserial; },
                     {.title = "rank-biserial", .digits = 2}));
  fields.push_back(F("status", "ok, or why the test is undefined",
                     [](const R& r) { return std::string(to_text(r.pair->ranks.status)); }));
}

}  // namespace

std::string group_levels(const Protocol& protocol) {
  std::string levels;
  for (const std::string& name : group_names(protocol)) levels.append(levels.empty() ? "" : " ").append(name);
  return levels;
}

std::vector<GroupMeanRow> group_mean_rows(const GroupsCompared& groups) {
  std::vector<GroupMeanRow> rows;
  for (const GroupMean& mean : groups.means) rows.push_back({&groups, &mean});
  return rows;
}

Fields<GroupMeanRow> group_mean_fields(const Protocol& protocol, SessionKind kind) {
  using R = GroupMeanRow;
  using F = Field<R>;
  const FieldTraits number{.shown = Shown::compact};
  return {F("group", "group of participants",
            [&protocol](const R& r) { return std::string(group_name(protocol, r.mean->group)); },
            {.levels = group_levels(protocol)}),
          F("condition", "condition; empty where each participant's mean over the group's conditions is meant",
            [&protocol](const R& r) { return condition_of(protocol, r.mean->condition); }),
          F("kind", "kind of the sessions", [kind](const R&) { return kind; }, {.levels = kKindsOfSessions}),
          F("outcome", "the registered outcome", [](const R& r) { return r.of->outcome; }),
          F("unit", "unit of the numbers; empty for none", [](const R& r) { return r.of->unit; }),
          F("participants", "participants of the group", [](const R& r) { return r.mean->participants; }),
          F("n_used", "those who have a value", [](const R& r) { return r.mean->mean.n; }),
          F(
              "mean", "mean over them", [](const R& r) { return r.mean->mean.mean; }, number),
          F(
              "sd", "standard deviation, n - 1", [](const R& r) { return r.mean->mean.sd; }, number),
          F(
              "ci95_low", "lower end of Student's 95 % interval of the mean",
              [](const R& r) { return r.mean->mean.ci_low; }, number),
          F(
              "ci95_high", "upper end", [](const R& r) { return r.mean->mean.ci_high; }, number),
          F(
              "median", "median over them", [](const R& r) { return r.mean->median; }, number)};
}

std::vector<BetweenRow> between_rows(const GroupsCompared& groups) {
  std::vector<BetweenRow> rows;
  if (!groups.tested()) return rows;
  if (groups.test == BetweenTest::mixed_anova) {
    const MixedAnova& anova = groups.comparison.anova;
    rows.push_back({&groups, "group", &anova.group, nullptr});
    rows.push_back({&groups, "condition", &anova.condition, nullptr});
    rows.push_back({&groups, "group x condition", &anova.interaction, nullptr});
    return rows;
  }
  for (const GroupPair& pair : groups.comparison.pairs) rows.push_back({&groups, "", nullptr, &pair});
  return rows;
}

Fields<BetweenRow> between_fields(const Protocol& protocol, SessionKind kind) {
  using R = BetweenRow;
  using F = Field<R>;
  Fields<R> fields = {
      F("test", "the registered test of the groups", [](const R& r) { return r.of->test; },
        {.levels = "welch mann-whitney mixed-anova"}),
      F("kind", "kind of the sessions", [kind](const R&) { return kind; }, {.levels = kKindsOfSessions}),
      F("outcome", "the registered outcome", [](const R& r) { return r.of->outcome; }),
      F("unit", "unit of the outcome; empty for none", [](const R& r) { return r.of->unit; }),
      F("n_used", "participants in the test", [](const R& r) { return r.of->participants.size(); })};
  if (protocol.analysis.tests.between == BetweenTest::mixed_anova) {
    add_effects(fields);
    return fields;
  }
  add_pair(fields, protocol);
  if (protocol.analysis.tests.between == BetweenTest::mann_whitney)
    add_ranks(fields);
  else
    add_welch(fields);
  return fields;
}

}  // namespace jnd
