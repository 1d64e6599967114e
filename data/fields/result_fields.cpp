#include "data/fields/result_fields.h"

#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/special_values.h"
#include "data/fields/between_fields.h"
#include "protocols/planning/track_threshold.h"

namespace jnd {

namespace {

constexpr const char* kSessionKinds = "real pilot simulated";
constexpr const char* kJndStatuses = "ok no_sensitivity ceiling no_information";
constexpr const char* kMedianStatus =
    "what stands in the middle: a JND (ok), no sensitivity, or a JND below what was tested (ceiling)";

std::string unit_name(const Protocol& protocol) {
  return std::string(to_string(protocol.stimulus.unit));
}

template <typename Row, typename Get>
Field<Row> p_field(std::string_view key, std::string_view meaning, Get get, FieldTraits traits = {}) {
  traits.shown = Shown::p_value;
  return {key, meaning, get, traits};
}

template <typename Row>
Field<Row> condition_field(const Protocol& protocol) {
  return {"condition", "condition", [&protocol](const Row& r) { return condition_of(protocol, r.condition); }};
}

std::string caution_names(const JndEstimate& estimate) {
  std::string names;
  for (const Caution caution : estimate.cautions) names.append(names.empty() ? "" : " ").append(to_string(caution));
  return names;
}

// The convention behind a number stands in every row that holds one.
template <typename Row>
void add_convention(Fields<Row>& fields, const Protocol& protocol, bool with_method) {
  using F = Field<Row>;
  fields.push_back(F("difference_source", "the stiffness differences behind the JND: as asked, or as delivered",
                     [](const Row& r) { return r.difference_source; },
                     {.levels = with_method ? "nominal delivered mixed" : "nominal delivered"}));
  // The d' of a cell is the yes-no model's whatever is registered: models.csv and the thresholds have the others.
  fields.push_back(F("model", "model of d'",
                     [m = with_method ? protocol.analysis.model : std::string("yes-no")](const Row&) { return m; },
                     {.levels = with_method ? "yes-no differencing independent-observation" : "yes-no"}));
  fields.push_back(F("correction", "correction of rates of 0 and 1",
                     [c = protocol.analysis.correction](const Row&) { return c; }, {.levels = "none loglinear half"}));
  if (with_method)
    fields.push_back(F("registered_method", "how the JND comes from d' at several differences",
                       [m = protocol.analysis.jnd_method](const Row&) { return m; },
                       {.column = "method", .levels = "least_squares ml weighted inverse_mean_slope mean_of_ratios"}));
  fields.push_back(
      F("protocol_sha256", "SHA-256 of the protocol's bytes", [sha = protocol.sha256](const Row&) { return sha; }));
}

// name.n, name.mean, ...: columns n_name, name_mean_n_per_m, ...
template <typename Row, typename Estimate>
void add_mean(Fields<Row>& fields, const std::string& name, const std::string& suffix, const std::string& meaning,
              const std::string& unit, Estimate estimate) {
  fields.push_back(Field<Row>(name + ".n", "participants in the mean of " + meaning,
                              [estimate](const Row& r) { return std::invoke(estimate, r).n; },
                              {.column = "n_" + name}));
  const auto add = [&](const char* part, const char* column, const std::string& text, double MeanEstimate::*member) {
    fields.push_back(Field<Row>(name + "." + part, text + meaning,
                                [estimate, member](const Row& r) { return std::invoke(estimate, r).*member; },
                                {.column = name + "_" + column + suffix, .unit = unit}));
  };
  add("mean", "mean", "mean of ", &MeanEstimate::mean);
  add("sd", "sd", "standard deviation (n - 1) of ", &MeanEstimate::sd);
  add("ci_low", "ci95_low", "lower end of the 95 % interval (Student t) of the mean of ", &MeanEstimate::ci_low);
  add("ci_high", "ci95_high", "upper end of the 95 % interval (Student t) of the mean of ", &MeanEstimate::ci_high);
}

// An effect within participants. effect, eta2: of a row.
template <typename Row, typename Effect, typename Eta>
void add_effect(Fields<Row>& fields, const std::string& meaning_of_f, Effect effect, Eta eta2) {
  const auto add = [&](const char* key, const std::string& meaning, double WithinEffect::*member,
                       const char* title = nullptr, Shown shown = Shown::number) {
    fields.push_back(Field<Row>(key, meaning, [effect, member](const Row& r) { return effect(r).*member; },
                                {.title = title == nullptr ? key : title, .shown = shown}));
  };
  add("f", meaning_of_f, &WithinEffect::f, "F");
  add("df1", "its degrees of freedom", &WithinEffect::df1);
  add("df2", "of its error", &WithinEffect::df2);
  add("p", "p assuming sphericity", &WithinEffect::p, "p", Shown::p_value);
  add("epsilon_gg", "Greenhouse and Geisser's epsilon", &WithinEffect::epsilon_gg);
  add("p_gg", "p with that correction", &WithinEffect::p_gg, "p(GG)", Shown::p_value);
  add("epsilon_hf", "Huynh and Feldt's epsilon, uncapped", &WithinEffect::epsilon_hf);
  add("p_hf", "p with that correction, capped at 1", &WithinEffect::p_hf);
  fields.push_back(Field<Row>("eta2_generalised", "generalised eta squared", eta2, {.title = "eta2 g"}));
  add("eta2_partial", "partial eta squared", &WithinEffect::eta2_partial, "eta2 p");
}

}  // namespace

int stiffness_decimals(const Protocol& protocol) noexcept {
  return protocol.stimulus.unit == Unit::n_per_m ? 1 : 2;
}

int slope_step(const Protocol& protocol) noexcept {
  return protocol.stimulus.unit == Unit::n_per_m ? 100 : 10;
}

std::string in_unit(const std::string& name, const Protocol& protocol) {
  return name + std::string(name_suffix(protocol.stimulus.unit));
}

Fields<CellResult> cell_fields(const Protocol& protocol) {
  using R = CellResult;
  using F = Field<R>;
  const std::string unit = unit_name(protocol);
  const auto series = [&protocol](const R& r) -> const Series& {
    return protocol.series.at(static_cast<std::size_t>(r.series));
  };
  const int digits = stiffness_decimals(protocol);
  Fields<R> fields = {
      F("participant", "code of the participant", &R::participant),
      F("kind", "kind of the sessions", &R::kind, {.levels = kSessionKinds}),
      condition_field<R>(protocol),
      F("series", "series", [series](const R& r) { return series(r).name; }),
      F(in_unit("difference_", protocol), "stiffness difference of the series, as asked",
        [series](const R& r) { return plain_distance(series(r).pair[0], series(r).pair[1]); },
        {.unit = unit, .title = "asked " + unit, .digits = digits}),
      F(in_unit("delivered_difference_", protocol),
        "mean delivered difference |k2 - k1| of the counted trials with different stimuli; empty without one",
        [](const R& r) { return r.delivered_difference.mean; }, {.unit = unit, .title = "delivered", .digits = digits}),
      F("n_delivered", "trials in that mean", [](const R& r) { return r.delivered_difference.n; }),
      F("n_without_fit", "trials left out of it: no stiffness could be fitted in one of their intervals",
        &R::without_fit),
      F(in_unit("delivered_softer_", protocol), "mean delivered stiffness where the softer one was asked",
        [](const R& r) { return r.delivered[0].mean; }, {.unit = unit}),
      F("n_softer", "intervals in that mean", [](const R& r) { return r.delivered[0].n; }),
      F(in_unit("delivered_stiffer_", protocol), "mean delivered stiffness where the stiffer one was asked",
        [](const R& r) { return r.delivered[1].mean; }, {.unit = unit}),
      F("n_stiffer", "intervals in that mean", [](const R& r) { return r.delivered[1].n; }),
      F("n_diff", "counted trials with different stimuli", [](const R& r) { return r.counts.n_diff; }),
      F("hits", "of them answered different", [](const R& r) { return r.counts.hits; }),
      F("n_same", "counted trials with equal stimuli", [](const R& r) { return r.counts.n_same; }),
      F("false_alarms", "of them answered different", [](const R& r) { return r.counts.false_alarms; }),
      F("excluded", "trials left out by registered rules", &R::excluded),
      F("missing", "planned trials without an answer", &R::missing),
      F("raw_hit_rate", "hits / n_diff", [](const R& r) { return r.yes_no.raw_hit_rate; }, {.title = "raw H"}),
      F("raw_false_alarm_rate", "false_alarms / n_same", [](const R& r) { return r.yes_no.raw_false_alarm_rate; },
        {.title = "raw F"}),
      F("hit_rate", "corrected hit rate", [](const R& r) { return r.yes_no.hit_rate; }, {.title = "H"}),
      F("false_alarm_rate", "corrected false-alarm rate", [](const R& r) { return r.yes_no.false_alarm_rate; },
        {.title = "F"}),
      F("z_hit", "normal quantile of hit_rate", [](const R& r) { return r.yes_no.z_hit; }, {.title = "z(H)"}),
      F("z_false_alarm", "normal quantile of false_alarm_rate", [](const R& r) { return r.yes_no.z_false_alarm; },
        {.title = "z(F)"}),
      F("dprime", "d' = z_hit - z_false_alarm", [](const R& r) { return r.yes_no.dprime; }, {.title = "d'"}),
      F("se", "standard error of dprime (Gourevitch and Galanter 1967)", [](const R& r) { return r.yes_no.se; },
        {.column = "dprime_se"}),
      F("ci_low", "lower end of its 95 % interval, dprime - 1.96 dprime_se", [](const R& r) { return r.yes_no.ci_low; },
        {.column = "dprime_ci95_low", .digits = 2}),
      F("ci_high", "upper end", [](const R& r) { return r.yes_no.ci_high; },
        {.column = "dprime_ci95_high", .digits = 2}),
      F("criterion", "c = -(z_hit + z_false_alarm) / 2; positive: tends to say same",
        [](const R& r) { return r.yes_no.criterion; }, {.title = "c"}),
      beside<R>("ln_beta", [](const R& r) { return r.yes_no.ln_beta; }),
      F("status", "whether the row holds information", [](const R& r) { return r.yes_no.status; },
        {.levels = "ok no_information missing"})};
  add_convention(fields, protocol, false);
  add_group_field(fields, protocol);
  return fields;
}

Fields<ThresholdResult> threshold_fields(const Protocol& protocol) {
  using R = ThresholdResult;
  using F = Field<R>;
  const std::string unit = unit_name(protocol);
  const int digits = stiffness_decimals(protocol);
  Fields<R> fields = {
      F("participant", "code of the participant", &R::participant),
      F("kind", "kind of the sessions", &R::kind, {.levels = kSessionKinds}),
      condition_field<R>(protocol),
      F("series_used", "series in the fit", [](const R& r) { return r.jnd.series_used; }),
      F("slope", "slope of d' on the stiffness difference, through the origin", [](const R& r) { return r.jnd.slope; },
        {.column = in_unit("slope_per_", protocol),
         .unit = protocol.stimulus.unit == Unit::n_per_m ? "m/N" : "rad/N",
         .title = fmt::format("d' per {} {}", slope_step(protocol), unit),
         .factor = static_cast<double>(slope_step(protocol))}),
      beside<R>("slope_ci_low", [](const R& r) { return r.jnd.slope_ci_low; }),
      beside<R>("slope_ci_high", [](const R& r) { return r.jnd.slope_ci_high; }),
      beside<R>("method", [](const R& r) { return r.jnd.method; }),
      F("jnd", "just-noticeable difference: 1 / slope; empty where status says why",
        [](const R& r) { return r.jnd.jnd; },
        {.column = in_unit("jnd_", protocol), .unit = unit, .title = "JND " + unit, .digits = digits}),
      F("ci_low",
        "lower end of its 95 % interval: bootstrap of least squares, profile likelihood of ml; empty for other methods",
        [](const R& r) { return r.jnd.ci_low; },
        {.column = in_unit("jnd_ci95_low_", protocol), .unit = unit, .digits = digits}),
      F("ci_high", "upper end; Inf where no sensitivity cannot be ruled out", [](const R& r) { return r.jnd.ci_high; },
        {.column = in_unit("jnd_ci95_high_", protocol), .unit = unit, .digits = digits}),
      F("weber", in_unit("jnd_", protocol) + " / " + in_unit("reference_", protocol),
        [](const R& r) { return r.jnd.weber; }, {.title = "Weber", .shown = Shown::percent}),
      F(in_unit("reference_", protocol), "base of the Weber fraction",
        [k = protocol.stimulus.reference](const R&) { return k; }, {.unit = unit}),
      F("status", "what the estimate is", [](const R& r) { return r.jnd.status; }, {.levels = kJndStatuses}),
      F("cautions", "names of cautions, separated by blanks; none of them excludes anything",
        [](const R& r) { return caution_names(r.jnd); },
        {.levels = "extrapolated floor few_trials series_missing", .several = true}),
      F("median_response_time_s", "median of the times that the participant entered; empty without one",
        &R::median_response_time_s, {.unit = "s"}),
      F("mean_trial_s", "mean time of a counted trial; empty without one", &R::mean_trial_s,
        {.unit = "s", .title = "s per trial", .digits = 1})};
  add_convention(fields, protocol, true);
  add_group_field(fields, protocol);
  return fields;
}

Fields<GroupResult> group_fields(const Protocol& protocol, SessionKind kind) {
  using R = GroupResult;
  using F = Field<R>;
  const std::string unit = unit_name(protocol);
  Fields<R> fields = {condition_field<R>(protocol),
                      F("kind", "kind of the sessions", [kind](const R&) { return kind; }, {.levels = kSessionKinds}),
                      F("n", "participants with a row in this condition (N)", [](const R& r) { return r.jnd.n; },
                        {.column = "participants"}),
                      F("n_used", "those whose JND is ok", [](const R& r) { return r.jnd.mean_jnd.n; })};
  add_mean(fields, "jnd", in_unit("_", protocol), "the JND over status ok", unit,
           [](const R& r) { return r.jnd.mean_jnd; });
  fields.push_back(
      F("median_n", "participants in the median", [](const R& r) { return r.jnd.median_n; }, {.column = "n_median"}));
  fields.push_back(F("median_jnd", "median JND; Inf or empty where its status says why",
                     [](const R& r) { return r.jnd.median_jnd; },
                     {.column = in_unit("jnd_median_", protocol), .unit = unit}));
  fields.push_back(F("median_status", kMedianStatus, [](const R& r) { return r.jnd.median_status; },
                     {.column = "jnd_median_status", .levels = kJndStatuses}));
  add_mean(fields, "log_jnd", "", "ln(JND / (" + unit + ")) over status ok", "",
           [](const R& r) { return r.jnd.mean_log_jnd; });
  fields.push_back(F("slope_n", "participants with a finite slope", [](const R& r) { return r.jnd.slope_n; },
                     {.column = "n_slope"}));
  fields.push_back(F("inverse_mean_slope", "1 / mean slope over all finite slopes; empty where that is not positive",
                     [](const R& r) { return r.jnd.inverse_mean_slope; },
                     {.column = in_unit("inverse_mean_slope_", protocol), .unit = unit, .title = "1/mean slope"}));
  add_mean(fields, "weber", "", "the Weber fraction over status ok", "", [](const R& r) { return r.jnd.mean_weber; });
  fields.push_back(beside<R>(
      "n_ok", [](const R& r) { return r.jnd.n - r.jnd.no_sensitivity - r.jnd.ceiling - r.jnd.no_information; }));
  fields.push_back(F("no_sensitivity", "participants with status no_sensitivity",
                     [](const R& r) { return r.jnd.no_sensitivity; }, {.column = "n_no_sensitivity"}));
  fields.push_back(F("ceiling", "participants with status ceiling", [](const R& r) { return r.jnd.ceiling; },
                     {.column = "n_ceiling"}));
  fields.push_back(F("no_information", "participants with status no_information",
                     [](const R& r) { return r.jnd.no_information; }, {.column = "n_no_information"}));
  add_convention(fields, protocol, true);
  // As a table shows them.
  for (F& field : fields) {
    if (field.key == "jnd.mean") field.title = "mean JND " + unit;
    if (field.key == "weber.mean") field.title = "mean Weber";
    if (field.key == "weber.mean") field.shown = Shown::percent;
    if (field.unit == unit) field.digits = stiffness_decimals(protocol);
  }
  return fields;
}

Fields<ContrastRow> contrast_fields(const Protocol& protocol, SessionKind kind) {
  using R = ContrastRow;
  using F = Field<R>;
  Fields<R> fields = {
      F("a", "first condition", [&protocol](const R& r) { return condition_of(protocol, r.a); },
        {.column = "condition_a"}),
      F("b", "second condition", [&protocol](const R& r) { return condition_of(protocol, r.b); },
        {.column = "condition_b"}),
      F("kind", "kind of the sessions", [kind](const R&) { return kind; }, {.levels = kSessionKinds}),
      F("outcome", "the scale of every number in the row", &R::outcome,
        {.levels =
             protocol.task.kind == TaskKind::same_different ? "slope jnd log_jnd threshold hierarchical_log_jnd" : ""}),
      F("unit", "unit of the differences in the row; empty where they have none", &R::unit),
      F("registered", "1 on the scale of the registered tests; 0 where the JND stands beside it", &R::registered,
        {.levels = "0 1"}),
      F("participants", "participants (N)", &R::participants)};
  add_mean(
      fields, "difference", "",
      protocol.analysis.hierarchical
          ? "a - b within the participants who have both; of hierarchical_log_jnd that of the median person by the "
            "hierarchical model, with its profile interval (Inf: open) and no standard deviation"
          : "a - b within the participants who have both",
      "", &R::difference);
  fields.push_back(p_field<R>(
      "p", "of the registered contrast, corrected as registered; empty where not registered or refused", &R::p));
  // Where there is a p, whose it is.
  const PostHoc test = protocol.analysis.tests.post_hoc;
  fields.push_back(F("test", "the test behind p; empty without p",
                     [test](const R& r) {
                       return std::isnan(r.p)                   ? std::string_view()
                              : r.outcome == kHierarchicalScale ? kHierarchicalTest
                                                                : to_string(test);
                     },
                     {.levels = "holm-t wilcoxon games-howell tukey hierarchical-lr-holm"}));
  fields.push_back(
      beside<R>("refused", [](const R& r) { return r.refused.empty() ? FieldValue() : FieldValue(r.refused); }));
  if (protocol.design.procedure)
    fields.push_back(beside<R>("difference_source", &R::difference_source));
  else
    add_convention(fields, protocol, true);
  return fields;
}

Fields<TestRow> test_fields() {
  using R = TestRow;
  using F = Field<R>;
  const auto size = [](std::size_t n) { return static_cast<std::int64_t>(n); };
  Fields<R> fields = {
      F("outcome", "what is compared over the conditions", [](const R& r) { return r.outcome->outcome; }),
      beside<R>("title", [](const R& r) { return r.outcome->title; }),
      F("unit", "unit of the outcome's values", [](const R& r) { return r.outcome->unit; }),
      F("registered", "1 for the registered test", [](const R& r) { return r.outcome->registered; }, {.levels = "0 1"}),
      F("n_used", "complete participants", [size](const R& r) { return size(r.outcome->table.n); }),
      F("n", "participants who get every condition",
        [size](const R& r) { return size(r.outcome->table.n + r.outcome->left_out.size()); },
        {.column = "participants"})};
  add_effect(
      fields, "F of the one-way repeated-measures analysis of variance",
      [](const R& r) -> const WithinEffect& { return r.outcome->comparison.anova.effect; },
      [](const R& r) { return r.outcome->comparison.anova.eta2_generalised; });
  const auto add = [&](F field) { fields.push_back(std::move(field)); };
  add({"mauchly_w", "Mauchly's W", [](const R& r) { return r.outcome->comparison.anova.effect.mauchly.w; }});
  add(p_field<R>("mauchly_p", "its p", [](const R& r) { return r.outcome->comparison.anova.effect.mauchly.p; },
                 {.title = "Mauchly p"}));
  add({"shapiro_w", "Shapiro-Wilk W of the residuals", [](const R& r) { return r.outcome->comparison.residuals.w; }});
  add(p_field<R>("shapiro_p", "its p", [](const R& r) { return r.outcome->comparison.residuals.p; },
                 {.title = "Shapiro p"}));
  add(F("friedman_chi2", "Friedman's chi-square", [](const R& r) { return r.outcome->comparison.friedman.chi2; },
        {.title = "Friedman chi2"}));
  add(p_field<R>("friedman_p", "its p", [](const R& r) { return r.outcome->comparison.friedman.p; }, {.title = "p"}));
  add(F("kendall_w", "Kendall's W", [](const R& r) { return r.outcome->comparison.friedman.kendall_w; },
        {.title = "Kendall W"}));
  return fields;
}

Fields<EffectRow> effect_fields() {
  using R = EffectRow;
  Fields<R> fields = {beside<R>("effect", &R::name), beside<R>("n_used", [](const R& r) { return r.of->n; }),
                      beside<R>("n", [](const R& r) { return r.of->n + static_cast<int>(r.of->left_out.size()); })};
  add_effect(
      fields, "F of the two-way repeated-measures analysis of variance",
      [](const R& r) -> const WithinEffect& { return r.effect->effect; },
      [](const R& r) { return r.effect->eta2_generalised; });
  fields.push_back(beside<R>("status", [](const R& r) { return to_text(r.effect->effect.status); }));
  return fields;
}

Fields<PairRow> pair_fields(const Protocol& protocol) {
  using R = PairRow;
  using F = Field<R>;
  return {
      F("outcome", "what is compared", [](const R& r) { return r.outcome->outcome; }),
      F("condition_a", "first condition", [&protocol](const R& r) { return protocol.conditions[r.pair->a].name; }),
      F("condition_b", "second condition", [&protocol](const R& r) { return protocol.conditions[r.pair->b].name; }),
      F("n", "complete participants", [](const R& r) { return r.pair->t.n; }, {.column = "n_used"}),
      F("mean_difference", "mean of a - b, in the outcome's unit", [](const R& r) { return r.pair->mean_difference; },
        {.title = "difference", .shown = Shown::compact}),
      F("ci95_low", "lower end of its 95 % interval (Student t)", [](const R& r) { return r.pair->t.ci_low; },
        {.shown = Shown::compact}),
      F("ci95_high", "upper end", [](const R& r) { return r.pair->t.ci_high; }, {.shown = Shown::compact}),
      F("t", "paired t", [](const R& r) { return r.pair->t.t; }),
      F("t_df", "its degrees of freedom", [](const R& r) { return r.pair->t.df; }),
      p_field<R>("t_p", "its two-sided p", [](const R& r) { return r.pair->t.p; }, {.title = "p"}),
      p_field<R>("t_p_holm", "that p with Holm's correction over the pairs of the outcome",
                 [](const R& r) { return r.pair->t_p_holm; }, {.title = "p(Holm)"}),
      F("dz", "mean difference / SD of the differences", [](const R& r) { return r.pair->t.dz; }, {.digits = 2}),
      p_field<R>("games_howell_p", "Games-Howell p (ignores the pairing)",
                 [](const R& r) { return r.pair->games_howell.p; }, {.title = "Games-Howell p"}),
      p_field<R>("tukey_p", "Tukey's p (assumes sphericity)", [](const R& r) { return r.pair->tukey.p; },
                 {.title = "Tukey p"}),
      F("wilcoxon_v", "Wilcoxon's V", [](const R& r) { return r.pair->wilcoxon.v; },
        {.title = "Wilcoxon V", .digits = 1}),
      p_field<R>("wilcoxon_p", "its p as R computes it", [](const R& r) { return r.pair->wilcoxon.p; }, {.title = "p"}),
      p_field<R>("wilcoxon_p_exact", "its exact permutation p with midranks",
                 [](const R& r) { return r.pair->wilcoxon.p_exact_permutation; }, {.title = "p(exact)"}),
      p_field<R>("wilcoxon_p_holm", "wilcoxon_p with Holm's correction over the pairs of the outcome",
                 [](const R& r) { return r.pair->wilcoxon_p_holm; }, {.title = "p(Holm)"})};
}

Fields<MethodRow> sensitivity_fields(const Protocol& protocol) {
  using R = MethodRow;
  using F = Field<R>;
  const std::string unit = unit_name(protocol);
  Fields<R> fields = {
      F("model", "model of d'", [](const R& r) { return r.row->method.model; },
        {.levels = "yes-no differencing independent-observation"}),
      F("correction", "of rates of 0 and 1; none for maximum likelihood",
        [](const R& r) { return r.row->method.correction; }, {.levels = "none loglinear half"}),
      F("method", "how the JND comes from the series", [](const R& r) { return r.row->method.method; }),
      F("registered", "1 for the registered method", [](const R& r) { return r.row->registered; }, {.levels = "0 1"}),
      F("condition", "condition", [&protocol](const R& r) { return protocol.conditions[r.condition].name; }),
      F("median_jnd", "median JND; Inf or empty where its status says why",
        [](const R& r) { return r.row->median_jnd[r.condition]; }, {.column = "jnd_median", .unit = unit}),
      F("median_status", kMedianStatus, [](const R& r) { return r.row->median_status[r.condition]; },
        {.column = "jnd_median_status", .levels = kJndStatuses}),
      F("mean_jnd", "mean JND over status ok", [](const R& r) { return r.row->mean_jnd[r.condition]; },
        {.column = "jnd_mean", .unit = unit}),
      F("n_ok", "participants with status ok", [](const R& r) { return r.row->n_ok[r.condition]; }),
      F("n", "participants in the tests", [](const R& r) { return r.row->n; }, {.column = "n_tested"}),
      beside<R>("participants", [](const R& r) { return r.row->participants; }),
      p_field<R>("omnibus_p", "p of the registered test over all conditions; empty where refused",
                 [](const R& r) { return r.row->omnibus_p; }, {.title = "omnibus p"}),
      F("same_conclusion", "1 where every registered test decides as under the registered method",
        [](const R& r) { return r.row->same_conclusion; }, {.levels = "0 1"}),
      beside<R>("refused",
                [](const R& r) { return r.row->refused.empty() ? FieldValue() : FieldValue(r.row->refused); })};
  for (std::size_t i = 0; i < protocol.analysis.contrasts.size(); ++i) {
    const Contrast& contrast = protocol.analysis.contrasts[i];
    const std::string a = condition_of(protocol, contrast.a), b = condition_of(protocol, contrast.b);
    fields.push_back(p_field<R>(fmt::format("p_{}_{}", a, b), "p of the registered contrast, adjusted as registered",
                                [i](const R& r) { return r.row->contrast_p[i]; },
                                {.title = fmt::format("p {} - {}", a, b)}));
  }
  return fields;
}

Fields<ThresholdModel> model_fields(const Protocol& protocol) {
  using R = ThresholdModel;
  using F = Field<R>;
  const std::string unit = unit_name(protocol);
  const int digits = stiffness_decimals(protocol);
  const auto quality = [](double FitQuality::*member) {
    return [member](const R& r) { return r.quality ? std::optional((*r.quality).*member) : std::nullopt; };
  };
  Fields<R> fields = {
      F("participant", "code of the participant", &R::participant),
      condition_field<R>(protocol),
      F("model", "model of d'", [](const R& r) { return r.method.model; },
        {.levels = "yes-no differencing independent-observation"}),
      F("correction", "of rates of 0 and 1; none for maximum likelihood",
        [](const R& r) { return r.method.correction; }, {.levels = "none loglinear half"}),
      F("method", "how the JND comes from the series", [](const R& r) { return r.method.method; }),
      F("slope", "slope of d' on the stiffness difference", [](const R& r) { return r.jnd.slope; },
        {.factor = static_cast<double>(slope_step(protocol))}),
      F("jnd", "1 / slope; empty where status says why", [](const R& r) { return r.jnd.jnd; },
        {.unit = unit, .title = "JND", .digits = digits}),
      F("ci_low", "lower end of its 95 % interval", [](const R& r) { return r.jnd.ci_low; },
        {.column = "jnd_ci95_low", .unit = unit, .digits = digits}),
      F("ci_high", "upper end", [](const R& r) { return r.jnd.ci_high; },
        {.column = "jnd_ci95_high", .unit = unit, .digits = digits}),
      F("weber", "JND / reference", [](const R& r) { return r.jnd.weber; },
        {.title = "Weber", .shown = Shown::percent}),
      F("status", "what the estimate is", [](const R& r) { return r.jnd.status; }, {.levels = kJndStatuses}),
      F("log_likelihood", "of maximum likelihood, without binomial constants",
        [](const R& r) { return r.jnd.log_likelihood; }),
      beside<R>("fit.status", [](const R& r) { return r.quality ? std::optional(r.quality->status) : std::nullopt; }),
      F("fit.deviance", "against a rate for each class of each series", quality(&FitQuality::deviance),
        {.column = "deviance"}),
      beside<R>("fit.df",
                [](const R& r) { return r.quality ? std::optional(r.quality->degrees_of_freedom) : std::nullopt; }),
      F("fit.p", "its chi-square p; empty unless fit.status is ok", quality(&FitQuality::deviance_p),
        {.column = "deviance_p", .title = "deviance p", .shown = Shown::p_value})};
  add_group_field(fields, protocol);
  return fields;
}

namespace {

int level_decimals(const Protocol& protocol) noexcept {
  return protocol.stimulus.unit == Unit::n_per_m ? 1 : 3;
}

}  // namespace

namespace {

// How a threshold is told, by what it rests on.
struct ThresholdWords {
  std::string threshold, sd_key, sd, n, statuses;
};
ThresholdWords threshold_words(ThresholdSource source) {
  switch (source) {
    case ThresholdSource::reversals:
      return {"difference at the procedure's target rate", "sd", "standard deviation of the averaged reversals",
              "reversals averaged", "ok too_few_reversals no_trials pinned_at_clamp"};
    case ThresholdSource::quest:
      return {"difference at the procedure's target rate", "sd_log10", "standard deviation of the posterior of log10",
              "trials behind the posterior", "ok too_few_reversals no_trials pinned_at_clamp"};
    case ThresholdSource::answers:
      break;
  }
  return {"JND, the difference at d' = 1: exp of the posterior mean of ln JND", "sd_ln",
          "standard deviation of the posterior of ln JND", "trials behind the posterior, catch trials among them",
          "ok no_trials too_few_answers pinned_at_grid"};
}

}  // namespace

Fields<AdaptiveRow> track_fields(const Protocol& protocol) {
  using R = AdaptiveRow;
  using F = Field<R>;
  const std::string unit = unit_name(protocol);
  const ThresholdSource source = threshold_source(protocol);
  const ThresholdWords told = threshold_words(source);
  const int digits = level_decimals(protocol);
  Fields<R> fields = {
      F("participant", "code of the participant", &R::participant),
      beside<R>("kind", &R::kind),
      condition_field<R>(protocol),
      F("track", "track of the condition, from 1; empty for all of them",
        [](const R& r) { return r.track == 0 ? std::nullopt : std::optional(r.track); }),
      F("finished", "1 where the stopping rule was met", &R::finished, {.levels = "0 1"}),
      F("trials", "answered trials with a difference", &R::trials),
      F("hits", "of them answered different", &R::hits),
      beside<R>("hit_rate", [](const R& r) { return r.trials > 0 ? static_cast<double>(r.hits) / r.trials : kNaN; }),
      F("catch_trials", "answered trials with equal stimuli", &R::catch_trials, {.title = "catch"}),
      F("false_alarms", "of them answered different", &R::false_alarms),
      beside<R>("false_alarm_rate", &R::false_alarm_rate, {.title = "false alarms", .shown = Shown::percent}),
      F("threshold", told.threshold, [](const R& r) { return r.threshold.threshold; },
        {.unit = unit, .title = "threshold " + unit, .digits = digits}),
      F(told.sd_key, told.sd, [](const R& r) { return r.threshold.sd; },
        {.column = "sd", .unit = source == ThresholdSource::reversals ? unit : "", .digits = digits})};
  if (source == ThresholdSource::answers) {
    fields.push_back(F("ci_low", "lower end of the middle 95 % of the posterior",
                       [](const R& r) { return r.threshold.low; },
                       {.column = "ci95_low", .unit = unit, .digits = digits}));
    fields.push_back(F("ci_high", "upper end of the middle 95 % of the posterior",
                       [](const R& r) { return r.threshold.high; },
                       {.column = "ci95_high", .unit = unit, .digits = digits}));
  }
  if (source != ThresholdSource::answers) add_track_fields(fields, [](const R& r) { return r.threshold.tracks; });
  fields.push_back(F("n", told.n, [](const R& r) { return r.threshold.n; }));
  fields.push_back(F("weber", "threshold / reference", &R::weber, {.title = "Weber", .shown = Shown::percent}));
  fields.push_back(
      F("status", "what the threshold is", [](const R& r) { return r.threshold.status; }, {.levels = told.statuses}));
  add_group_field(fields, protocol);
  return fields;
}

Fields<AdaptiveGroup> adaptive_group_fields(const Protocol& protocol) {
  using R = AdaptiveGroup;
  using F = Field<R>;
  const int digits = level_decimals(protocol);
  const std::string unit = unit_name(protocol);
  return {F("condition", "condition", [&protocol](const R& r) { return condition_of(protocol, r.condition); }),
          F("of", "participants who get the condition", &R::of, {.column = "participants"}),
          F("n", "those whose threshold is ok", &R::n, {.column = "n_used"}),
          F("threshold_mean", "mean threshold over them", &R::mean,
            {.unit = unit, .title = "mean threshold " + unit, .digits = digits}),
          F("threshold_sd", "standard deviation, n - 1", &R::sd, {.unit = unit, .title = "sd", .digits = digits}),
          F("false_alarm_rate", "mean rate of \"different\" to equal stimuli over the same participants",
            &R::false_alarms, {.title = "false alarms", .shown = Shown::percent})};
}

}  // namespace jnd
