#include "data/fields/hierarchical_fields.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "data/fields/between_fields.h"
#include "data/fields/result_fields.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

constexpr const char* kKindsCounted = "real pilot simulated";
constexpr const char* kSlopeStatuses = "ok no_sensitivity ceiling missing one_answer one_level perfect";
constexpr const char* kSlopeMeanings =
    "; no_sensitivity: positive answers do not become more frequent as the level grows; ceiling: a step fits; missing: no "
    "trials; one_answer: every answer is the same; one_level: every trial has the same level; perfect: all answers are "
    "negative up to some level and positive above it";

// Whether an interval was found: the ends are empty otherwise.
template <typename Row, typename Get>
Field<Row> ends_field(const char* key, const std::string& column, const Get& get) {
  return Field<Row>(
      key,
      "whether that interval was found; not_computed: nobody asked, or there is no estimate; not_converged: "
      "an end could not be confirmed; out_of_work: the search took too long",
      [get](const Row& row) { return word_of(kEndsStatusWords, get(row)); },
      {.column = column, .levels = "ok not_computed not_converged out_of_work"});
}

// "which": the criterion is where two stimuli feel alike.
bool has_choices(const Protocol& protocol) {
  const std::optional<AnswerModel> answers = task_of(protocol.task.kind).answer_model(protocol);
  return answers && answers->response == ResponseModel::choice;
}

// Rows have a standard of their own.
bool has_standards(const Protocol& protocol) {
  return !task_of(protocol.task.kind).has_own_results();
}

template <typename Row, typename Series>
void add_standard(Fields<Row>& fields, const Protocol& protocol, const Series& series) {
  if (has_standards(protocol))
    fields.push_back({"standard", "name of the standard", [&protocol, series](const Row& row) {
                        return protocol.series[static_cast<std::size_t>(series(row))].name;
                      }});
}

// Of quantities of any size, or of stiffnesses.
FieldTraits in_study_unit(const Protocol& protocol, std::string_view column,
                          std::optional<std::string_view> title = {}) {
  return {.column = column,
          .unit = to_string(protocol.stimulus.unit),
          .title = title,
          .digits = stiffness_decimals(protocol),
          .shown = has_standards(protocol) ? Shown::compact : Shown::number};
}

// What it means, of a study whose JND is not the usual one.
std::string jnd_meaning(const Protocol& protocol) {
  const std::optional<AnswerModel> answers = task_of(protocol.task.kind).answer_model(protocol);
  if (has_standards(protocol) && answers)
    for (const TaskOutcome& outcome : task_of(protocol.task.kind).outcomes(protocol))
      if (outcome.key == answers->jnd) return " (" + outcome.meaning + ")";
  return "";
}

std::optional<std::int64_t> pooled_count(const PooledLevels& levels, std::size_t count) {
  return levels ? std::optional(static_cast<std::int64_t>(count)) : std::nullopt;
}

void add_spread(Fields<HierarchicalConditionRow>& fields, const std::string& key, const std::string& of,
                HierarchicalSpread StudyHierarchical::*of_model) {
  using R = HierarchicalConditionRow;
  const auto spread = [of_model](const R& r) {
    const HierarchicalSpread& one = r.of->*of_model;
    return one.status == SpreadStatus::by_condition ? r.one->spread : one;
  };
  fields.push_back(Field<R>(key, "standard deviation between people of " + of + "; empty where its status says why",
                            [spread](const R& r) { return spread(r).sd; }));
  fields.push_back(
      Field<R>(key + "_status",
               "what that is; zero: the likelihood is largest at 0; at_limit: as large as is searched, the "
               "answers set no upper bound; not_identified: it takes several participants, or several "
               "conditions of one; not_asked: left out of the model, as where "
               "the PSE is taken as the standard; empty without a model",
               [spread](const R& r) {
                 return r.of->fitted() ? std::optional(word_of(kSpreadStatusWords, spread(r).status)) : std::nullopt;
               },
               {.levels = "ok zero at_limit not_identified not_asked"}));
}

}  // namespace

std::vector<HierarchicalConditionRow> hierarchical_rows(const StudyHierarchical& model) {
  std::vector<HierarchicalConditionRow> rows;
  for (const HierarchicalCondition& one : model.conditions) rows.push_back({&model, &one});
  return rows;
}

Fields<HierarchicalConditionRow> hierarchical_fields(const Protocol& protocol, SessionKind kind) {
  using R = HierarchicalConditionRow;
  using F = Field<R>;
  const std::string unit(to_string(protocol.stimulus.unit));
  Fields<R> fields = {
      F("condition", "condition", [&protocol](const R& r) { return condition_of(protocol, r.one->condition); })};
  add_standard(fields, protocol, [](const R& r) { return r.one->series; });
  fields.insert(
      fields.end(),
      {F("kind", "kind of the sessions", [kind](const R&) { return kind; }, {.levels = kKindsCounted}),
       F("observer",
         has_standards(protocol)
             ? "response model: yes by the distance of the signal (yes_no), or the comparison chosen (choice); empty "
               "where the task has none"
             : "how \"different\" is decided: on the difference (yes_no), on its size (differencing), or on each interval "
               "by itself (independent); empty where the model is not offered",
         [](const R& r) {
           return r.of->response ? std::optional(word_of(kResponseModelWords, *r.of->response)) : std::nullopt;
         },
         {.levels = has_standards(protocol) ? "yes_no choice" : "yes_no differencing independent"}),
       F("participants", "participants with counted trials in any condition",
         [](const R& r) { return r.of->participants; }),
       F("n", "those with counted trials in this one", [](const R& r) { return r.one->participants; },
         {.column = "n_used"}),
       F(
           "jnd",
           "JND of the median person, the geometric mean over people; empty where status says why" +
               jnd_meaning(protocol),
           [](const R& r) { return r.one->jnd; },
           in_study_unit(protocol, in_unit("jnd_", protocol), jnd_title(protocol) + " " + unit)),
       F(
           "ci_low", "lower end of its 95 % interval (profile likelihood); 0 where the answers leave it open",
           [](const R& r) { return r.one->ci_low; }, in_study_unit(protocol, in_unit("jnd_ci95_low_", protocol))),
       F(
           "ci_high", "upper end; Inf where the answers leave it open", [](const R& r) { return r.one->ci_high; },
           in_study_unit(protocol, in_unit("jnd_ci95_high_", protocol))),
       ends_field<R>("ci_status", "jnd_ci95_status", [](const R& r) { return r.one->ci_status; }),
       F("weber", has_standards(protocol) ? "that JND / standard" : "that JND / reference",
         [](const R& r) { return r.one->weber; }, {.title = "Weber", .shown = Shown::percent})});
  if (has_choices(protocol))
    fields.insert(
        fields.end(),
        {F(
             "pse",
             "point of subjective equality of the group: the standard plus the mean bias; empty without a JND, and where it "
             "is taken as the standard",
             [](const R& r) { return r.one->pse; }, in_study_unit(protocol, in_unit("pse_", protocol), "PSE " + unit)),
         F(
             "pse_low", "lower end of its 95 % interval (profile likelihood); -Inf where the answers leave it open",
             [](const R& r) { return r.one->pse_low; }, in_study_unit(protocol, in_unit("pse_ci95_low_", protocol))),
         F(
             "pse_high", "upper end; Inf where the answers leave it open", [](const R& r) { return r.one->pse_high; },
             in_study_unit(protocol, in_unit("pse_ci95_high_", protocol))),
         ends_field<R>("pse_status", "pse_ci95_status", [](const R& r) { return r.one->pse_status; }),
         F(
             "bias", "PSE less the standard", [](const R& r) { return r.one->criterion; },
             in_study_unit(protocol, in_unit("bias_", protocol), "bias " + unit)),
         F("lapse", "registered lapse rate l in P(comparison) = l/2 + (1 - l) Phi((level - PSE)/s)",
           [](const R& r) { return r.of->lapse; }),
         F("jnd_of_s", "JND / s, as registered", [](const R& r) { return r.of->jnd_of_s; })});
  else
    fields.push_back(F(
        "criterion",
        has_standards(protocol)
            ? "criterion of the group: z of the rate of \"no\" to the noise"
            : "criterion of the group: z of the rate of \"same\" to equal stimuli (yes_no), ln of the size from which "
              "\"different\" is said, in JNDs (differencing), z of the rate of \"same\" halfway between equal and different "
              "stimuli (independent)",
        [](const R& r) { return r.one->criterion; }));
  fields.push_back(
      F("status",
        std::string(
            "what the JND is; of all conditions why the model was not fitted, or not_converged: the search did not "
            "settle, take no number from here") +
            kSlopeMeanings,
        [](const R& r) { return status_word(*r.of, *r.one); },
        {.levels = std::string(kSlopeStatuses) + " no_answers not_offered too_many_people not_converged"}));
  fields.push_back(
      F("exact",
        "1; 0 if the log-likelihood still changes by more than 1e-6 when it is integrated more finely; empty "
        "without a model",
        [](const R& r) { return r.of->fitted() ? std::optional(r.of->exact) : std::nullopt; }, {.levels = "0 1"}));
  fields.push_back(F("log_likelihood", "marginal log-likelihood at the estimates, without binomial coefficients",
                     [](const R& r) { return r.of->log_likelihood; }));
  fields.push_back(F("levels", "different levels before those within 5 % of each other were pooled; empty if none were",
                     [](const R& r) { return pooled_count(r.of->gathered, r.of->gathered.from); }));
  fields.push_back(F("levels_pooled", "different levels after that",
                     [](const R& r) { return pooled_count(r.of->gathered, r.of->gathered.to); }));
  add_spread(fields, "sd_persons", "ln JND over persons", &StudyHierarchical::persons);
  add_spread(fields, "sd_persons_by_condition",
             "ln JND over conditions of a person, or of each condition where that is registered",
             &StudyHierarchical::by_condition);
  if (has_choices(protocol))
    add_spread(fields, "sd_pse",
               protocol.series.size() > 1 ? std::string("the PSE over persons, as a share of the standard")
                                          : fmt::format("the PSE over persons, in {}", unit),
               &StudyHierarchical::criteria);
  else
    add_spread(fields, "sd_criterion", "the criterion over persons", &StudyHierarchical::criteria);
  fields.push_back(
      F("equal_lr",
        "likelihood-ratio chi-square of one JND for all conditions; empty of one condition, and of several standards",
        [](const R& r) { return r.of->equal_lr; }, {.digits = 2}));
  fields.push_back(F("equal_df", "its degrees of freedom",
                     [](const R& r) { return r.of->equal_df > 0 ? std::optional(r.of->equal_df) : std::nullopt; }));
  fields.push_back(F("equal_p", "its p", [](const R& r) { return r.of->equal_p; }, {.shown = Shown::p_value}));
  fields.push_back(
      F("protocol_sha256", "SHA-256 of the protocol's bytes", [sha = protocol.sha256](const R&) { return sha; }));
  return fields;
}

Fields<HierarchicalRatio> hierarchical_ratio_fields(const Protocol& protocol, SessionKind kind) {
  using R = HierarchicalRatio;
  using F = Field<R>;
  Fields<R> fields = {F("a", "first condition", [&protocol](const R& r) { return condition_of(protocol, r.a); },
                        {.column = "condition_a"}),
                      F("b", "second condition", [&protocol](const R& r) { return condition_of(protocol, r.b); },
                        {.column = "condition_b"})};
  add_standard(fields, protocol, [](const R& r) { return r.series; });
  fields.insert(fields.end(),
                {F("kind", "kind of the sessions", [kind](const R&) { return kind; }, {.levels = kKindsCounted}),
                 F("participants", "participants with counted trials in both", &R::participants, {.title = "n"}),
                 F("ratio", "JND of a / JND of b, of the median person; empty where status says why", &R::ratio,
                   {.title = "ratio of JNDs"}),
                 F("ci_low", "lower end of its 95 % interval (profile likelihood); 0 where the answers leave it open",
                   &R::ci_low, {.column = "ci95_low"}),
                 F("ci_high", "upper end; Inf where the answers leave it open", &R::ci_high, {.column = "ci95_high"}),
                 ends_field<R>("ci_status", "ci95_status", [](const R& r) { return r.ci_status; }),
                 F("lr",
                   "likelihood-ratio chi-square of a ratio of 1, 1 degree of freedom; empty where the answers of a "
                   "condition tell no JND, or the search took too long",
                   &R::lr, {.title = "chi-square", .digits = 2}),
                 F("p", "its p, without correction for several ratios", &R::p, {.shown = Shown::p_value}),
                 F("status", "ok, or no_jnd where a condition has none",
                   [](const R& r) { return r.defined ? "ok" : "no_jnd"; }, {.levels = "ok no_jnd"})});
  return fields;
}

std::vector<HierarchicalCheckRow> hierarchical_check_rows(const StudyHierarchical& model) {
  std::vector<HierarchicalCheckRow> rows;
  if (model.check)
    for (const PredictiveRow& one : model.check->rows) rows.push_back({&*model.check, &one});
  return rows;
}

Fields<HierarchicalCheckRow> hierarchical_check_fields(const Protocol& protocol, SessionKind kind) {
  using R = HierarchicalCheckRow;
  using F = Field<R>;
  const std::string unit(to_string(protocol.stimulus.unit));
  constexpr const char* kBandStatuses = "inside below above one_person";
  return {
      F("condition", "condition",
        [&protocol](const R& r) { return condition_of(protocol, static_cast<int>(r.one->condition)); }),
      F("kind", "kind of the sessions", [kind](const R&) { return kind; }, {.levels = kKindsCounted}),
      F("difference",
        protocol.analysis.model == "independent-observation"
            ? "difference of the two stimuli; below 0: they were equal, and the others of their series differ by as much"
            : "difference of the two stimuli; 0: they were equal",
        [](const R& r) { return r.one->level; },
        {.column = in_unit("difference_", protocol), .unit = unit, .shown = Shown::compact}),
      F("participants", "participants with counted trials there", [](const R& r) { return r.one->participants; },
        {.title = "n"}),
      F("trials", "counted trials there",
        [](const R& r) { return static_cast<std::int64_t>(std::llround(r.one->trials)); }),
      F("share", "share of answers \"different\"", [](const R& r) { return r.one->share.observed; },
        {.title = "\"different\"", .shown = Shown::percent}),
      F("share_low", "lower end of what 95 % of the answers have that the model draws for the same people",
        [](const R& r) { return r.one->share.low; }, {.column = "share_drawn_low", .shown = Shown::percent}),
      F("share_high", "upper end", [](const R& r) { return r.one->share.high; },
        {.column = "share_drawn_high", .shown = Shown::percent}),
      F("share_status", "whether the share lies there, below or above",
        [](const R& r) { return word_of(kBandStatusWords, r.one->share.status); }, {.levels = kBandStatuses}),
      F("sd", "standard deviation between people of their shares; empty of one person",
        [](const R& r) { return r.one->between.observed; }, {.column = "sd_between", .title = "sd of people"}),
      F("sd_low", "lower end of what 95 % of the drawn answers have", [](const R& r) { return r.one->between.low; },
        {.column = "sd_between_drawn_low"}),
      F("sd_high", "upper end", [](const R& r) { return r.one->between.high; }, {.column = "sd_between_drawn_high"}),
      F("sd_status", "whether the standard deviation lies there, below or above; one_person: there is none",
        [](const R& r) { return word_of(kBandStatusWords, r.one->between.status); },
        {.column = "sd_between_status", .levels = kBandStatuses}),
      F("draws", "draws of the check", [](const R& r) { return r.of->draws; }),
      F("discrepancy",
        "of all answers: sum of (k - n p)^2/(n p (1 - p)) over participants, conditions and differences, at drawn rates "
        "p; median over the draws",
        [](const R& r) { return r.of->observed; }, {.digits = 1}),
      F("discrepancy_drawn", "the same of the drawn answers", [](const R& r) { return r.of->drawn; }, {.digits = 1}),
      F("p", "share of draws whose own answers have as large a discrepancy (Gelman, Meng and Stern 1996)",
        [](const R& r) { return r.of->p; }, {.column = "discrepancy_p", .shown = Shown::p_value})};
}

double HierarchicalVariantRow::width_ratio() const {
  const double ratio = std::log(with->ci_high / with->ci_low) / std::log(without->ci_high / without->ci_low);
  return std::isfinite(ratio) && ratio > 0 ? ratio : kNaN;
}

std::vector<HierarchicalVariantRow> hierarchical_variant_rows(const StudyHierarchical& model) {
  std::vector<HierarchicalVariantRow> rows;
  for (const HierarchicalVariant& one : model.variants)
    for (const SharedEstimate& shared : one.shared)
      for (std::size_t i = 0; i < one.conditions.size(); ++i)
        rows.push_back({&one, &shared, &one.conditions[i], &model.conditions[i]});
  return rows;
}

Fields<HierarchicalVariantRow> hierarchical_variant_fields(const Protocol& protocol, SessionKind kind) {
  using R = HierarchicalVariantRow;
  using F = Field<R>;
  Fields<R> fields = {
      F("variant", "what is estimated besides, the same for everybody",
        [](const R& r) { return word_of(kVariantKindWords, r.of->kind); },
        {.levels = "overdispersion drift lapse sureness", .title = "with"}),
      F("parameter",
        "overdispersion: intra-class correlation of the answers of one participant, condition and level; drift_ln_jnd, "
        "drift_criterion: second half of a cell's trials less the first" +
            std::string(has_choices(protocol) ? " (of the criterion: of the PSE)" : "") +
            "; lapse: share of trials answered by chance; sure_below, sure_above: how far beyond the criterion sure "
            "answers begin",
        [](const R& r) { return word_of(kSharedParameterWords, r.shared->parameter); },
        {.levels = "overdispersion drift_ln_jnd drift_criterion lapse sure_below sure_above"}),
      F("condition", "condition", [&protocol](const R& r) { return condition_of(protocol, r.with->condition); })};
  add_standard(fields, protocol, [](const R& r) { return r.with->series; });
  fields.insert(
      fields.end(),
      {F("kind", "kind of the sessions", [kind](const R&) { return kind; }, {.levels = kKindsCounted}),
       F("estimate", "estimate of the parameter; empty where its status says why",
         [](const R& r) { return r.shared->value; }),
       F("estimate_low", "lower end of its 95 % interval (profile likelihood); -Inf: beyond what is searched",
         [](const R& r) { return r.shared->ends.low; }, {.column = "estimate_ci95_low"}),
       F("estimate_high", "upper end; Inf: beyond what is searched", [](const R& r) { return r.shared->ends.high; },
         {.column = "estimate_ci95_high"}),
       ends_field<R>("estimate_ci_status", "estimate_ci95_status", [](const R& r) { return r.shared->ends.status; }),
       F("lr", "likelihood-ratio chi-square of 0, 1 degree of freedom; empty of sureness",
         [](const R& r) { return r.shared->lr; }, {.title = "chi-square", .digits = 2}),
       F("p", "its p; of overdispersion and lapse, which cannot be below 0, half of it",
         [](const R& r) { return r.shared->p; }, {.shown = Shown::p_value}),
       F("status",
         "ok; zero: the likelihood is largest at 0; at_limit: as large as is searched; not_identified: these answers "
         "cannot tell it; not_converged: the search did not settle",
         [](const R& r) { return word_of(kSharedStatusWords, r.shared->status); },
         {.levels = "ok zero at_limit not_identified not_converged"}),
       F(
           "jnd", "JND of the group with this in the model; empty where status or jnd_status says why",
           [](const R& r) { return r.with->jnd; },
           in_study_unit(protocol, in_unit("jnd_", protocol), jnd_title(protocol))),
       F(
           "ci_low",
           "lower end of its 95 % interval (profile likelihood); 0 where the answers leave it open; empty of lapse, and where a "
           "condition has no JND or the parameter no upper bound",
           [](const R& r) { return r.with->ci_low; }, in_study_unit(protocol, in_unit("jnd_ci95_low_", protocol))),
       F(
           "ci_high", "upper end; Inf where the answers leave it open", [](const R& r) { return r.with->ci_high; },
           in_study_unit(protocol, in_unit("jnd_ci95_high_", protocol))),
       ends_field<R>("ci_status", "jnd_ci95_status", [](const R& r) { return r.with->ci_status; }),
       F("width_ratio", "how many times as wide the interval of ln JND is as without this; empty where one is open",
         [](const R& r) { return r.width_ratio(); }, {.title = "times as wide", .digits = 2}),
       F("jnd_status", std::string("what that JND is") + kSlopeMeanings,
         [](const R& r) { return word_of(kSlopeStatusWords, r.with->status); }, {.levels = kSlopeStatuses})});
  return fields;
}

Fields<HierarchicalPerson> hierarchical_person_fields(const Protocol& protocol, SessionKind kind) {
  using R = HierarchicalPerson;
  using F = Field<R>;
  Fields<R> fields = {
      F("participant", "code of the participant", &R::participant),
      F("kind", "kind of the sessions", [kind](const R&) { return kind; }, {.levels = kKindsCounted}),
      F("condition", "condition", [&protocol](const R& r) { return condition_of(protocol, r.condition); })};
  add_standard(fields, protocol, [](const R& r) { return r.series; });
  const std::string jnd = jnd_title(protocol);
  fields.insert(
      fields.end(),
      {F("separate",
         protocol.design.procedure && !has_standards(protocol)
             ? "the JND of the participant, from these answers alone: that of the procedure's posterior, or by the observer "
               "of the hierarchical model where the registered threshold is no JND; empty where its status says why"
             : "the registered JND of the participant, from these answers alone; empty where its status says why" +
                   jnd_meaning(protocol),
         &R::separate, in_study_unit(protocol, in_unit("jnd_separate_", protocol), "separate " + jnd)),
       F("separate_status", "what that is", &R::separate_status,
         {.levels = "ok no_sensitivity ceiling no_information"}),
       F("alone",
         "the JND from these answers alone by the observer of the hierarchical model; empty where its status "
         "says why",
         &R::alone, in_study_unit(protocol, in_unit("jnd_alone_", protocol), "by its observer")),
       F("alone_status", std::string("what that is") + kSlopeMeanings,
         [](const R& r) { return word_of(kSlopeStatusWords, r.alone_status); }, {.levels = kSlopeStatuses}),
       F("jnd",
         "the JND given everybody's answers, drawn towards the group's: exp of the mean of ln JND; empty where status "
         "says why",
         &R::jnd, in_study_unit(protocol, in_unit("jnd_shrunken_", protocol), "shrunken " + jnd)),
       F("ln_sd",
         "standard deviation of ln JND given the same, which takes the group's estimates as certain: JND / exp(1.96 sd) to "
         "JND exp(1.96 sd) holds the truth of 84 to 88 % of simulated participants, not of 95 %; empty where the answers show "
         "no difference between people",
         &R::ln_sd, {.column = "ln_jnd_sd", .title = "sd of its ln"})});
  if (has_choices(protocol))
    fields.push_back(F("bias", "PSE less the standard, given the same; empty where that of the group is", &R::criterion,
                       in_study_unit(protocol, in_unit("bias_", protocol), "bias")));
  else
    fields.push_back(F("criterion", "criterion given the same, as in hierarchical.csv", &R::criterion));
  fields.push_back(F("status", "ok, missing (no counted trial), or no_group_jnd (nothing to be drawn towards)",
                     [](const R& r) { return word_of(kShrunkenStatusWords, r.status); },
                     {.levels = "ok missing no_group_jnd"}));
  add_group_field(fields, protocol);
  return fields;
}

}  // namespace jnd
