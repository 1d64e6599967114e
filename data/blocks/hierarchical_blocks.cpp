// One model of everybody's answers.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "data/blocks/common_fields.h"
#include "data/blocks/result_blocks.h"
#include "data/fields/number_text.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

constexpr const char* kSlopeStatuses = "ok no_sensitivity ceiling missing one_answer one_level perfect";
constexpr const char* kSlopeMeanings =
    "no_sensitivity: positive answers do not become more frequent as the level grows; ceiling: a step fits; missing: no "
    "trials; one_answer: every answer is the same; one_level: every trial has the same level; perfect: all answers are "
    "negative up to some level and positive above it";
constexpr const char* kCriterionMeaning =
    "criterion of the model: z of the rate of \"no\" to the noise, or of \"same\" to equal stimuli (yes_no); ln of the size "
    "from which \"different\" is said, in JNDs (differencing); z of the rate of \"same\" halfway between equal and "
    "different stimuli (independent)";
constexpr const char* kEndsStatuses = "ok not_computed not_converged by_curvature out_of_work";

// What the blocks are made of.
struct Model {
  const StudyHierarchical& of;
  const Protocol& protocol;
  SessionKind kind;

  bool choice() const { return of.response == ResponseModel::choice; }
  bool several() const { return judged_standard_count(protocol) > 1; }
  std::string unit() const { return std::string(to_string(protocol.stimulus.unit)); }
  std::string jnd() const { return jnd_title(protocol); }
  // JNDs beyond it cannot be told from any other.
  std::pair<double, std::string> limit() const {
    const double largest = largest_difference(protocol);
    return {12 * largest, fmt::format("12 x {:g} {}", largest, unit())};
  }
};

FieldTraits jnd_traits(const std::pair<double, std::string>& limit, std::string_view title) {
  return {.title = title, .limit = limit.first, .limit_text = limit.second};
}

template <typename Row, typename Get>
void add_place(Fields<Row>& fields, const Model& model, Get place) {
  fields.push_back(condition_field<Row>(model.protocol, [place](const Row& r) { return place(r).condition; }));
  add_standard_fields(fields, model.protocol, [place](const Row& r) { return place(r).standard; });
  fields.push_back(kind_field<Row>(model.kind));
}

template <typename Row, typename Get>
Field<Row> ends_field(std::string_view key, const std::string& of, Get get) {
  return Field<Row>(key, "whether the interval of " + of + " was found; as ci_status",
                    [get](const Row& r) { return word_of(kEndsStatusWords, get(r)); }, {.levels = kEndsStatuses});
}

void with_standard(std::vector<TableColumn>& columns, const Model& model) {
  const auto condition =
      std::find_if(columns.begin(), columns.end(), [](const TableColumn& one) { return one.key == "condition"; });
  if (model.several()) columns.insert(condition == columns.end() ? columns.begin() + 1 : condition + 1, {"standard"});
}

// --- The group.

struct GroupRow {
  const StudyHierarchical* of;
  const HierarchicalCondition* one;
};

void add_spread(Fields<GroupRow>& fields, const std::string& key, const std::string& of,
                HierarchicalSpread StudyHierarchical::*of_model) {
  using R = GroupRow;
  const auto spread = [of_model](const R& r) {
    const HierarchicalSpread& one = r.of->*of_model;
    return one.status == SpreadStatus::by_condition ? r.one->spread : one;
  };
  fields.push_back(Field<R>(key, "standard deviation between people of " + of + "; empty where its status says why",
                            [spread](const R& r) { return spread(r).sd; }));
  fields.push_back(Field<R>(
      key + "_status",
      "what " + key +
          " is; zero: the likelihood is largest at 0; at_limit: as large as is searched, the answers set no upper "
          "bound; not_identified: it takes several participants, or several conditions of one; not_asked: left out "
          "of the model, as where the PSE is taken as the standard; empty without a model",
      [spread](const R& r) {
        return r.of->fitted() ? std::optional(word_of(kSpreadStatusWords, spread(r).status)) : std::nullopt;
      },
      {.levels = "ok zero at_limit not_identified not_asked"}));
}

// "0.24 between persons (ln JND)", or why there is no number.
std::string spread_text(const HierarchicalSpread& spread, const std::string& of) {
  if (std::isnan(spread.sd)) return fmt::format("not identified {}", of);
  return fmt::format("{}{} {}", spread.status == SpreadStatus::at_limit ? "at_limit " : "", number_text(spread.sd, 2),
                     of);
}

std::string spreads_by_condition_text(const Model& model) {
  if (model.of.by_condition.status != SpreadStatus::by_condition)
    return spread_text(model.of.by_condition, "of ln JND by condition");
  std::vector<std::string> each;
  for (const HierarchicalCondition& one : model.of.conditions)
    each.push_back(spread_text(one.spread, "of ln JND in " + condition_of(model.protocol, one.condition)));
  return fmt::format("{}", fmt::join(each, ", "));
}

std::string criteria_text(const Model& model) {
  if (model.of.pse_at_standard) return "; the PSE is taken as the standard, as all comparisons lie on one side of it";
  if (!model.choice()) return "; " + spread_text(model.of.criteria, "of the criterion");
  return "; " + spread_text(model.of.criteria,
                            fmt::format("of the PSE, {}", model.of.several_standards ? "as a share of the standard"
                                                                                     : "in " + model.unit()));
}

// What an answer is taken to go by.
std::string observer_words(const Model& model) {
  if (!model.of.response) return "";
  switch (*model.of.response) {
    case ResponseModel::yes_no:
      return !task_of(model.protocol.task.kind).has_pairs() ? ", decided on the distance of the signal from the noise"
                                                            : ", decided on the difference";
    case ResponseModel::differencing:
      return ", decided on the size of the difference";
    case ResponseModel::independent:
      return ", decided on each interval by itself";
    case ResponseModel::choice:
      break;
  }
  return fmt::format(", without an effect of the order{}",
                     model.of.lapse > 0 ? fmt::format(", with a lapse rate of {:g}", model.of.lapse) : "");
}

std::optional<std::int64_t> pooled_count(const PooledLevels& levels, std::size_t count) {
  return levels ? std::optional(static_cast<std::int64_t>(count)) : std::nullopt;
}

Fields<GroupRow> group_fields(const Model& model) {
  using R = GroupRow;
  using F = Field<R>;
  const std::string unit = model.unit();
  const auto limit = model.limit();
  const auto of = [](auto member) { return [member](const R& r) { return r.one->*member; }; };
  const auto all = [](auto member) { return [member](const R& r) { return r.of->*member; }; };
  Fields<R> fields;
  add_place(fields, model, [](const R& r) -> const HierarchicalCondition& { return *r.one; });
  const std::string title = fmt::format("{} {}", model.jnd(), unit);
  FieldTraits jnd = jnd_traits(limit, title);
  jnd.unit = unit;
  fields.insert(
      fields.end(),
      {F("observer",
         "response model: how \"different\" or \"yes\" is decided, on the difference (yes_no), on its size (differencing), on "
         "each interval by itself (independent), or which comparison is chosen (choice); empty where there is none",
         [](const R& r) {
           return r.of->response ? std::optional(word_of(kResponseModelWords, *r.of->response)) : std::nullopt;
         },
         {.levels = "yes_no differencing independent choice"}),
       common<R>("participants", all(&StudyHierarchical::participants)),
       common<R>("n", of(&HierarchicalCondition::participants)), common<R>("jnd", of(&HierarchicalCondition::jnd), jnd),
       common<R>("ci_low", of(&HierarchicalCondition::ci_low), jnd),
       common<R>("ci_high", of(&HierarchicalCondition::ci_high), jnd),
       common<R>("ci_status", [](const R& r) { return word_of(kEndsStatusWords, r.one->ci_status); },
                 {.levels = kEndsStatuses}),
       common<R>("weber", of(&HierarchicalCondition::weber), {.title = "Weber", .shown = Shown::percent})});
  if (model.choice()) {
    fields.insert(
        fields.end(),
        {F("pse",
           "point of subjective equality: the standard plus the mean bias; empty without a JND, and where it is taken as the "
           "standard",
           of(&HierarchicalCondition::pse), {.unit = unit, .title = "PSE " + unit}),
         F("pse_ci_low", "lower end of the 95 % interval of pse; empty where it has none",
           of(&HierarchicalCondition::pse_low), {.unit = unit}),
         F("pse_ci_high", "upper end of that of pse; Inf where the answers leave it open",
           of(&HierarchicalCondition::pse_high), {.unit = unit}),
         ends_field<R>("pse_ci_status", "pse", of(&HierarchicalCondition::pse_status)),
         F("bias", "PSE less the standard", of(&HierarchicalCondition::criterion),
           {.unit = unit, .title = "bias " + unit}),
         F("lapse", "registered lapse rate l in P(comparison) = l/2 + (1 - l) Phi((level - PSE)/s)",
           all(&StudyHierarchical::lapse)),
         F("jnd_of_s", "JND / s, as registered", all(&StudyHierarchical::jnd_of_s))});
  } else {
    fields.push_back(F("model_criterion", kCriterionMeaning, of(&HierarchicalCondition::criterion),
                       {.title = model.of.response == ResponseModel::differencing ? "ln tau" : "criterion"}));
  }
  fields.insert(
      fields.end(),
      {common<R>("status", [](const R& r) { return status_word(*r.of, *r.one); },
                 {.levels = std::string(kSlopeStatuses) + " no_answers not_offered too_many_people not_converged"}),
       F("exact",
         "1; 0 if the log-likelihood still changes by more than 1e-6 when it is integrated more finely; empty without a model",
         [](const R& r) { return r.of->fitted() ? std::optional(r.of->exact) : std::nullopt; }, {.levels = "0 1"}),
       common<R>("log_likelihood", all(&StudyHierarchical::log_likelihood)),
       F("levels_found", "different levels before those within 5 % of each other were pooled; empty if none were",
         [](const R& r) { return pooled_count(r.of->gathered, r.of->gathered.from); }),
       F("levels_pooled", "different levels after that",
         [](const R& r) { return pooled_count(r.of->gathered, r.of->gathered.to); })});
  add_spread(fields, "sd_persons", "ln JND over persons", &StudyHierarchical::persons);
  add_spread(fields, "sd_persons_by_condition",
             "ln JND over conditions of a person, or of each condition where that is registered",
             &StudyHierarchical::by_condition);
  if (model.choice())
    add_spread(fields, "sd_pse",
               model.several() ? std::string("the PSE over persons, as a share of the standard")
                               : fmt::format("the PSE over persons, in {}", unit),
               &StudyHierarchical::criteria);
  else
    add_spread(fields, "sd_criterion", "the criterion over persons", &StudyHierarchical::criteria);
  fields.insert(
      fields.end(),
      {F("equal_lr",
         "likelihood-ratio chi-square of one JND for all conditions; empty of one condition, and of several standards",
         all(&StudyHierarchical::equal_lr)),
       F("equal_df", "degrees of freedom of equal_lr",
         [](const R& r) { return r.of->equal_df > 0 ? std::optional(r.of->equal_df) : std::nullopt; }),
       F("equal_p", "p of equal_lr", all(&StudyHierarchical::equal_p), {.shown = Shown::p_value}),
       protocol_field<R>(model.protocol),
       F("remarks", "",
         [](const R& r) {
           const EndsStatus interval = r.one->ci_status == EndsStatus::ok ? r.one->pse_status : r.one->ci_status;
           return status_with_interval(status_word(*r.of, *r.one), interval);
         },
         {.title = "status", .place = Place::table})});
  return fields;
}

Block group_block(const Model& model, const StudyResults& results) {
  Block block;
  block.id = "hierarchical";
  block.section = Section::tests;
  block.title = "The group by the hierarchical model";
  block.note =
      fmt::format("one model of everybody's answers{}; {}: of the median person, with 95 % profile likelihood; {}",
                  observer_words(model), model.jnd(),
                  model.protocol.analysis.hierarchical ? "registered for the contrasts" : "not registered");
  block.columns = {{"condition"}, {"n"}, {"jnd"}, range("ci_low", "ci_high"), {"weber"}};
  if (!model.choice())
    block.columns.push_back({"model_criterion"});
  else if (!model.of.pse_at_standard)
    block.columns.insert(block.columns.end(), {{"pse"}, range("pse_ci_low", "pse_ci_high")});
  block.columns.push_back({"remarks"});
  with_standard(block.columns, model);
  if (!model.of.fitted()) {
    block.footnotes.push_back("no model: " + model.of.reason);
  } else {
    if (model.of.equal_df > 0)
      block.footnotes.push_back(fmt::format("one JND for all conditions: chi-square {} with {} df, {}",
                                            number_text(model.of.equal_lr, 2), model.of.equal_df,
                                            p_text(model.of.equal_p)));
    block.footnotes.push_back(fmt::format("standard deviation between people: {}; {}{}",
                                          spread_text(model.of.persons, "of ln JND"), spreads_by_condition_text(model),
                                          criteria_text(model)));
    for (const std::string& one : model.of.cautions)  // those of a registered model are said of the study
      if (std::find(results.cautions.begin(), results.cautions.end(), one) == results.cautions.end())
        block.footnotes.push_back(one);
    block.footnotes.push_back(hierarchical_assumptions(model.of));
  }
  std::vector<GroupRow> rows;
  for (const HierarchicalCondition& one : model.of.conditions) rows.push_back({&model.of, &one});
  return std::move(block.with(group_fields(model), std::move(rows)));
}

// --- Ratios of conditions.

Block ratios_block(const Model& model) {
  using R = HierarchicalRatio;
  using F = Field<R>;
  Fields<R> fields = {condition_field<R>(
                          model.protocol, [](const R& r) { return r.a; }, "a"),
                      condition_field<R>(
                          model.protocol, [](const R& r) { return r.b; }, "b")};
  add_standard_fields(fields, model.protocol, [](const R& r) { return r.standard; });
  fields.insert(
      fields.end(),
      {kind_field<R>(model.kind), common<R>("n", &R::participants),
       F("ratio", "JND of a / JND of b, of the median person; empty where status says why", &R::ratio,
         {.title = "ratio of JNDs"}),
       common<R>("ci_low", &R::ci_low), common<R>("ci_high", &R::ci_high),
       common<R>("ci_status", [](const R& r) { return word_of(kEndsStatusWords, r.ci_status); },
                 {.levels = kEndsStatuses}),
       common<R>("lr", &R::lr, {.title = "chi-square"}), common<R>("p", &R::p, {.shown = Shown::p_value}),
       common<R>("status", [](const R& r) { return r.defined ? "ok" : "no_jnd"; }, {.levels = "ok no_jnd"}),
       F("remarks", "", [](const R& r) { return status_with_interval(r.defined ? "ok" : "no_jnd", r.ci_status); },
         {.title = "status", .place = Place::table})});
  Block block;
  block.id = "hierarchical_ratios";
  block.section = Section::tests;
  block.title = "Ratios of conditions by the hierarchical model";
  block.note = fmt::format("{0} of the first / {0} of the second; p: likelihood ratio, each alone", model.jnd());
  block.columns = {
      share("a", "b", "conditions", " : "), {"n"}, {"ratio"}, range("ci_low", "ci_high"), {"lr"}, {"p"}, {"remarks"}};
  with_standard(block.columns, model);
  return std::move(block.with(fields, model.of.ratios));
}

// --- The posterior predictive check.

struct CheckRow {
  const PredictiveCheck* of;
  const PredictiveRow* one;
};

Block check_block(const Model& model) {
  using R = CheckRow;
  using F = Field<R>;
  constexpr const char* kBandStatuses = "inside below above one_person";
  const auto band = [](PredictiveBand PredictiveRow::*which, double PredictiveBand::*member) {
    return [which, member](const R& r) { return r.one->*which.*member; };
  };
  const auto lies = [](PredictiveBand PredictiveRow::*which) {
    return [which](const R& r) { return word_of(kBandStatusWords, (r.one->*which).status); };
  };
  const Fields<R> fields = {
      condition_field<R>(model.protocol, [](const R& r) { return static_cast<int>(r.one->condition); }),
      kind_field<R>(model.kind),
      F("check_level",
        "difference of the two stimuli; 0: they were equal; below 0: so too, and the others of their series differ by as much",
        [](const R& r) { return r.one->level; }, {.unit = model.unit(), .title = "difference", .shown = Shown::given}),
      common<R>("n", [](const R& r) { return r.one->participants; }),
      common<R>("trials", [](const R& r) { return static_cast<std::int64_t>(std::llround(r.one->trials)); }),
      F("said_different", "share of \"different\" answers", band(&PredictiveRow::share, &PredictiveBand::observed),
        {.title = "\"different\"", .shown = Shown::percent}),
      F("drawn_low", "lower end of what 95 % of the answers have that the model draws for the same people",
        band(&PredictiveRow::share, &PredictiveBand::low), {.shown = Shown::percent}),
      F("drawn_high", "upper end of that of drawn answers", band(&PredictiveRow::share, &PredictiveBand::high),
        {.shown = Shown::percent}),
      F("drawn_status", "whether the share lies there, below or above", lies(&PredictiveRow::share),
        {.levels = kBandStatuses}),
      F("sd_between", "standard deviation between people of their shares; empty of one person",
        band(&PredictiveRow::between, &PredictiveBand::observed), {.title = "sd of people"}),
      F("sd_between_drawn_low", "lower end of what 95 % of the drawn answers have",
        band(&PredictiveRow::between, &PredictiveBand::low)),
      F("sd_between_drawn_high", "upper end of that", band(&PredictiveRow::between, &PredictiveBand::high)),
      F("sd_between_status", "whether sd_between lies there, below or above; one_person: there is none",
        lies(&PredictiveRow::between), {.levels = kBandStatuses}),
      F("draws", "draws of the check", [](const R& r) { return r.of->draws; }),
      F("discrepancy",
        "of all answers: sum of (k - n p)^2/(n p (1 - p)) over participants, conditions and differences, at drawn rates p; "
        "median over the draws",
        [](const R& r) { return r.of->observed; }),
      F("discrepancy_drawn", "the same of the drawn answers", [](const R& r) { return r.of->drawn; }),
      F("discrepancy_p", "share of draws whose own answers have as large a discrepancy (Gelman, Meng and Stern 1996)",
        [](const R& r) { return r.of->p; }, {.shown = Shown::p_value}),
      F("outside", "",
        [](const R& r) {
          std::string text;
          for (const auto& [name, one] : {std::pair{"share", &r.one->share}, {"sd", &r.one->between}})
            if (one->status == BandStatus::below || one->status == BandStatus::above)
              text = joined(text, fmt::format("{} {}", name, word_of(kBandStatusWords, one->status)));
          return text;
        },
        {.place = Place::table})};
  Block block;
  block.id = "hierarchical_check";
  block.section = Section::tests;
  block.title = "Posterior predictive check of the hierarchical model";
  block.note = fmt::format(
      "answers beside those that the model draws for the same people; sd of people: of their shares{}",
      model.of.response == ResponseModel::independent ? "; below 0: equal stimuli, of the series with that difference"
                                                      : "");
  block.columns = {{"condition"},
                   {"check_level"},
                   {"trials"},
                   {"said_different"},
                   range("drawn_low", "drawn_high", "95 % of drawn")};
  if (model.of.participants > 1)
    block.columns.insert(block.columns.end(),
                         {{"sd_between"}, range("sd_between_drawn_low", "sd_between_drawn_high", "95 % of drawn")});
  if (model.of.check->outside() > 0) block.columns.push_back({"outside"});
  block.footnotes.push_back(predictive_verdict(*model.of.check));
  block.footnotes.emplace_back(kPredictiveMeaning);
  std::vector<R> rows;
  for (const PredictiveRow& one : model.of.check->rows) rows.push_back({&*model.of.check, &one});
  return std::move(block.with(fields, std::move(rows)));
}

// --- What the model leaves out: each estimated in a model of its own.

struct VariantRow {
  const HierarchicalVariant* of;
  const SharedEstimate* shared;
};

Block variants_block(const Model& model) {
  using R = VariantRow;
  using F = Field<R>;
  const bool choice = model.choice();
  const auto of = [](auto member) { return [member](const R& r) { return r.shared->*member; }; };
  const Fields<R> fields = {
      kind_field<R>(model.kind),
      F("variant", "what is estimated besides, the same for everybody",
        [](const R& r) { return word_of(kVariantKindWords, r.of->kind); },
        {.levels = "overdispersion drift lapse sureness", .title = "with"}),
      F("parameter",
        "overdispersion: intra-class correlation of the answers of one participant, condition and level; drift_ln_jnd, "
        "drift_criterion: second half of a cell's trials less the first (of choices: of the PSE); lapse: share of trials "
        "answered by chance; sure_below, sure_above: how far beyond the criterion sure answers begin",
        [](const R& r) { return word_of(kSharedParameterWords, r.shared->parameter); },
        {.levels = "overdispersion drift_ln_jnd drift_criterion lapse sure_below sure_above"}),
      F("estimate", "estimate of the parameter; empty where status says why", of(&SharedEstimate::value)),
      common<R>("ci_low", [](const R& r) { return r.shared->ends.low; }),
      common<R>("ci_high", [](const R& r) { return r.shared->ends.high; }),
      common<R>("ci_status", [](const R& r) { return word_of(kEndsStatusWords, r.shared->ends.status); },
                {.levels = kEndsStatuses}),
      common<R>("lr", of(&SharedEstimate::lr), {.title = "chi-square"}),
      common<R>("p", of(&SharedEstimate::p), {.shown = Shown::p_value}),
      common<R>("status", [](const R& r) { return word_of(kSharedStatusWords, r.shared->status); },
                {.levels = "ok zero at_limit not_identified not_converged out_of_work"}),
      F("shown", "", [choice](const R& r) { return std::string(title_of(r.shared->parameter, choice)); },
        {.title = "left out", .place = Place::table}),
      F("remarks", "",
        [](const R& r) {
          return status_with_interval(word_of(kSharedStatusWords, r.shared->status), r.shared->ends.status);
        },
        {.title = "status", .place = Place::table})};
  Block block;
  block.id = "hierarchical_variants";
  block.section = Section::tests;
  block.title = "What the hierarchical model leaves out";
  block.note =
      "each estimated in a model of its own, the same for everybody; p: likelihood ratio of none, half of it where the "
      "parameter cannot be below 0";
  block.columns = {{"shown"}, {"estimate"}, range("ci_low", "ci_high"), {"lr"}, {"p"}, {"remarks"}};
  std::vector<R> rows;
  for (const HierarchicalVariant& one : model.of.variants)
    for (const SharedEstimate& shared : one.shared) rows.push_back({&one, &shared});
  if (std::any_of(rows.begin(), rows.end(), [](const R& r) { return r.shared->status == SharedStatus::out_of_work; }))
    block.note += "; out_of_work: it takes too long here, jnd calc hierarchical estimates it";
  return std::move(block.with(fields, std::move(rows)));
}

struct VariantJndRow {
  const HierarchicalVariant* of;
  const HierarchicalCondition *with, *without;  // that in the model

  // How many times as wide the interval of ln JND is. NaN: one of the two has an open end, or there is none.
  double width_ratio() const {
    const double ratio = std::log(with->ci_high / with->ci_low) / std::log(without->ci_high / without->ci_low);
    return std::isfinite(ratio) && ratio > 0 ? ratio : kNaN;
  }
};

Block variant_jnds_block(const Model& model) {
  using R = VariantJndRow;
  using F = Field<R>;
  const auto limit = model.limit();
  const std::string title = model.jnd();
  FieldTraits jnd = jnd_traits(limit, title);
  const std::string unit = model.unit();
  jnd.unit = unit;
  const auto with = [](auto member) { return [member](const R& r) { return r.with->*member; }; };
  Fields<R> fields = {F("variant", "what is estimated besides, the same for everybody",
                        [](const R& r) { return word_of(kVariantKindWords, r.of->kind); },
                        {.levels = "overdispersion drift lapse sureness", .title = "with"})};
  add_place(fields, model, [](const R& r) -> const HierarchicalCondition& { return *r.with; });
  fields.insert(
      fields.end(),
      {common<R>("jnd", with(&HierarchicalCondition::jnd), jnd),
       common<R>("ci_low", with(&HierarchicalCondition::ci_low), jnd),
       common<R>("ci_high", with(&HierarchicalCondition::ci_high), jnd),
       common<R>("ci_status", [](const R& r) { return word_of(kEndsStatusWords, r.with->ci_status); },
                 {.levels = kEndsStatuses}),
       F("width_ratio", "how many times as wide the interval of ln JND is as without this; empty where one is open",
         [](const R& r) { return r.width_ratio(); }, {.title = "times as wide"}),
       common<R>("status", [](const R& r) { return word_of(kSlopeStatusWords, r.with->status); },
                 {.levels = kSlopeStatuses}),
       F("remarks", "",
         [](const R& r) { return status_with_interval(word_of(kSlopeStatusWords, r.with->status), r.with->ci_status); },
         {.title = "status", .place = Place::table})});
  Block block;
  block.id = "hierarchical_variant_jnds";
  block.section = Section::tests;
  block.title = "The group with that in the model";
  block.note =
      "times as wide: the interval of ln JND, compared with the one above; beside lapses only jnd calc hierarchical has one";
  block.columns = {{"variant"}, {"condition"}, {"jnd"}, range("ci_low", "ci_high"), {"width_ratio"}, {"remarks"}};
  with_standard(block.columns, model);
  std::vector<R> rows;
  for (const HierarchicalVariant& one : model.of.variants)
    for (std::size_t i = 0; i < one.conditions.size(); ++i)
      if (one.conditions[i].status != SlopeStatus::missing)
        rows.push_back({&one, &one.conditions[i], &model.of.conditions[i]});
  return std::move(block.with(fields, std::move(rows)));
}

// --- People.

Block people_block(const Model& model) {
  using R = HierarchicalPerson;
  using F = Field<R>;
  const std::string unit = model.unit(), name = model.jnd();
  const auto limit = model.limit();
  const std::string separate = "separate " + name, shrunken = "shrunken " + name;
  const auto traits = [&](std::string_view title) {
    FieldTraits of = jnd_traits(limit, title);
    of.unit = unit;
    return of;
  };
  Fields<R> fields = {common<R>("participant", &R::participant)};
  add_place(fields, model, [](const R& r) -> const R& { return r; });
  fields.insert(
      fields.end(),
      {F("jnd_separate",
         "the participant's JND from these answers alone: the registered estimate, or where that is no JND the one by the "
         "observer of the hierarchical model; empty where its status says why",
         &R::separate, traits(separate)),
       F("jnd_separate_status", "what jnd_separate is", &R::separate_status,
         {.levels = "ok no_sensitivity ceiling no_information"}),
       F("jnd_alone",
         "the JND from these answers alone by the observer of the hierarchical model; empty where its status says why",
         &R::alone, traits("by its observer")),
       F("jnd_alone_status", std::string("what jnd_alone is; ") + kSlopeMeanings,
         [](const R& r) { return word_of(kSlopeStatusWords, r.alone_status); }, {.levels = kSlopeStatuses}),
       F("jnd_shrunken",
         "the JND given everybody's answers, drawn towards the group's: exp of the mean of ln JND; empty where status says "
         "why",
         &R::jnd, traits(shrunken)),
       F("ln_jnd_sd",
         "standard deviation of ln JND given the same, which takes the group's estimates as certain: JND / exp(1.96 sd) to "
         "JND exp(1.96 sd) holds the truth of 84 to 88 % of simulated participants, not of 95 %; empty where the answers show "
         "no difference between people",
         &R::ln_sd, {.title = "sd of its ln"}),
       model.choice() ? F("bias", "PSE less the standard", &R::criterion, {.unit = unit})
                      : F("model_criterion", kCriterionMeaning, &R::criterion, {.title = "criterion"}),
       common<R>("status", [](const R& r) { return word_of(kShrunkenStatusWords, r.status); },
                 {.levels = "ok missing no_group_jnd"}),
       F("without", "",
         [](const R& r) {
           return r.separate_status == JndStatus::ok ? std::string() : std::string(to_string(r.separate_status));
         },
         {.place = Place::table}),
       F("remarks", "",
         [](const R& r) {
           return r.status == ShrunkenStatus::ok ? std::string_view() : word_of(kShrunkenStatusWords, r.status);
         },
         {.title = "status", .place = Place::table})});
  add_group_field(fields, model.protocol, [](const R& r) { return r.group; });
  const std::vector<R>& people = model.of.people;
  Block block;
  block.id = "hierarchical_people";
  block.section = Section::participants;
  block.title = "Participants by the hierarchical model";
  block.note = fmt::format(
      "separate: {}, of these answers alone; shrunken: given everybody's answers, drawn towards the group's {} as far as a "
      "participant's answers are few",
      model.of.separate, name);
  block.columns = {{"participant"}};
  if (!model.protocol.groups.empty()) block.columns.push_back({"group"});
  block.columns.insert(block.columns.end(), {{"condition"}, {"jnd_separate"}});
  // What is ok is said of nobody, and there is no column where all are.
  if (std::any_of(people.begin(), people.end(), [](const R& row) { return row.separate_status != JndStatus::ok; }))
    block.columns.push_back({"without"});
  block.columns.insert(block.columns.end(), {{"jnd_shrunken"}, {"ln_jnd_sd"}});
  if (!model.of.pse_at_standard) block.columns.push_back({model.choice() ? "bias" : "model_criterion"});
  if (std::any_of(people.begin(), people.end(), [](const R& row) { return row.status != ShrunkenStatus::ok; }))
    block.columns.push_back({"remarks"});
  with_standard(block.columns, model);
  if (model.of.participants > 1 &&
      std::any_of(people.begin(), people.end(), [](const R& row) { return row.status == ShrunkenStatus::ok; }))
    block.footnotes.emplace_back(model.of.alike() ? kPeopleAlike : kPersonRange);
  block.footnotes.push_back(hierarchical_assumptions(model.of));
  return std::move(block.with(fields, people));
}

}  // namespace

// Where the model was not fitted, the rows of conditions say why.
Blocks hierarchical_blocks(const StudyResults& results, const Protocol& protocol) {
  Blocks blocks;
  if (!results.hierarchical || results.hierarchical->people.empty()) return blocks;
  const Model model{*results.hierarchical, protocol, results.attendance.kind};
  if (model.of.fitted()) blocks.push_back(people_block(model));
  blocks.push_back(group_block(model, results));
  blocks.push_back(ratios_block(model));
  if (model.of.check) blocks.push_back(check_block(model));
  blocks.push_back(variants_block(model));
  blocks.push_back(variant_jnds_block(model));
  return blocks;
}

}  // namespace jnd
