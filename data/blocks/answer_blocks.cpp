// How the answers were given: order of the intervals, bias, drift, cues, sureness; and what was answered to questions.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/blocks/common_fields.h"
#include "data/blocks/result_blocks.h"

namespace jnd {

namespace {

// KEY.k, KEY.n and KEY.value: how often "different" was said.
template <typename Row, typename Get>
void add_share(Fields<Row>& fields, const std::string& key, const std::string& when, Get get) {
  using F = Field<Row>;
  fields.push_back(F(key + ".k", "answers \"different\" " + when, [get](const Row& r) { return get(r).k; }));
  fields.push_back(F(key + ".n", "trials " + when, [get](const Row& r) { return get(r).n; }));
  fields.push_back(F(key + ".value", "rate of \"different\" " + when, [get](const Row& r) { return get(r).value; },
                     {.title = "said different", .shown = Shown::percent}));
}

std::string behaviour_remarks(const BehaviourRow& row) {
  std::string text = row.order.status == OrderStatus::ok ? "" : std::string(to_string(row.order.status));
  if (row.bias.status != RateStatus::ok) text = joined(text, "bias: " + std::string(to_string(row.bias.status)));
  if (row.drift.status != RateStatus::ok) text = joined(text, "drift: " + std::string(to_string(row.drift.status)));
  return text;
}

// KEY.first, .second, .difference, .ci_low, .ci_high, .p of what changes between two halves.
template <typename Get>
void add_change(Fields<BehaviourRow>& fields, const std::string& key, const std::string& of, const std::string& title,
                Get get) {
  using F = Field<BehaviourRow>;
  const auto part = [get](double HalfDifference::*member) {
    return [get, member](const BehaviourRow& r) { return get(r).*member; };
  };
  fields.push_back(F(key + ".first", of + " in the first half of each cell's trials", part(&HalfDifference::first)));
  fields.push_back(F(key + ".second", of + " in the second half", part(&HalfDifference::second)));
  fields.push_back(F(key + ".difference", of + " in the second half minus the first", part(&HalfDifference::difference),
                     {.title = title}));
  fields.push_back(F(key + ".ci_low", "lower end of the 95 % interval of that change of " + of + " (Wald)",
                     part(&HalfDifference::ci_low)));
  fields.push_back(F(key + ".ci_high", "upper end of that of " + of, part(&HalfDifference::ci_high)));
  fields.push_back(F(key + ".p", "p of no change of " + of + ", of its interval's test", part(&HalfDifference::p),
                     {.title = "p", .shown = Shown::p_value}));
}

Block behaviour_block(const StudyResults& results, const Protocol& protocol) {
  using R = BehaviourRow;
  using F = Field<R>;
  const auto order = [](auto member) { return [member](const R& r) { return r.order.*member; }; };
  const auto bias = [](auto member) { return [member](const R& r) { return r.bias.*member; }; };
  const auto corrected = [](double BehaviourHolm::*member) { return [member](const R& r) { return r.holm.*member; }; };
  const auto session = [](auto member) {
    return [member](const R& r) { return r.session_drift ? std::optional((*r.session_drift).*member) : std::nullopt; };
  };
  const auto holm = [](std::string_view key, const std::string& of, auto get) {
    return F(key, of + " with Holm's correction over the conditions, or over the participants", get,
             {.title = "p(Holm)", .shown = Shown::p_value});
  };
  Fields<R> fields = {
      common<R>("participant", [](const R& r) { return r.participant.empty() ? std::string("all") : r.participant; }),
      condition_field<R>(protocol, [](const R& r) { return r.condition; }),
      F("order_effect.status", "whether both orders of different pairs occur", order(&OrderEffect::status))};
  add_share(fields, "order_effect.stiffer_first", "where the stiffer stimulus came first",
            order(&OrderEffect::stiffer_first));
  add_share(fields, "order_effect.stiffer_second", "where it came second", order(&OrderEffect::stiffer_second));
  fields.insert(
      fields.end(),
      {F("order_effect.difference", "rate of \"different\" with the stiffer stimulus first minus second",
         order(&OrderEffect::difference), {.title = "order"}),
       F("order_effect.ci_low",
         "lower end of the 95 % interval of that order effect, to which order_effect_p belongs (Miettinen and Nurminen)",
         order(&OrderEffect::ci_low)),
       F("order_effect.ci_high", "upper end of that of the order effect", order(&OrderEffect::ci_high)),
       F("order_effect.p", "p of no order effect, by the same score test", order(&OrderEffect::p),
         {.title = "p", .shown = Shown::p_value}),
       holm("order_effect.p_holm", "order_effect_p", corrected(&BehaviourHolm::order)),
       F("response_bias.status", "whether the criterion of all trials is defined", bias(&ResponseBias::status)),
       F("response_bias.criterion", "c over all trials, log-linear rates; positive: tends to say same",
         bias(&ResponseBias::criterion), {.title = "c"}),
       F("response_bias.ci_low", "lower end of the 95 % interval of that criterion (Wald)",
         bias(&ResponseBias::ci_low)),
       F("response_bias.ci_high", "upper end of that of the criterion", bias(&ResponseBias::ci_high))});
  add_share(fields, "response_bias.said_different", "of all", bias(&ResponseBias::said_different));
  fields.insert(
      fields.end(),
      {F("response_bias.planned_share", "share of different pairs among the planned trials",
         bias(&ResponseBias::planned_share)),
       F("response_bias.p", "p of said_different against the planned share, exact as its interval",
         bias(&ResponseBias::p), {.title = "p", .shown = Shown::p_value}),
       holm("response_bias.p_holm", "response_bias_p", corrected(&BehaviourHolm::bias)),
       F("drift.status", "whether both halves have both classes", [](const R& r) { return r.drift.status; })});
  add_change(fields, "drift.dprime", "d'", "drift of d'",
             [](const R& r) -> const HalfDifference& { return r.drift.dprime; });
  fields.push_back(holm("drift.dprime.p_holm", "drift_dprime_p", corrected(&BehaviourHolm::drift)));
  add_change(fields, "drift.criterion", "the criterion", "drift of c",
             [](const R& r) -> const HalfDifference& { return r.drift.criterion; });
  fields.insert(
      fields.end(),
      {F("session_drift.strata", "of all together: series with a d' in both halves of the session",
         session(&StratifiedDrift::strata)),
       F("session_drift.difference",
         "of all together: d' in the second half of the session minus the first, each series against itself",
         session(&StratifiedDrift::difference), {.title = "session"}),
       F("session_drift.ci_low", "lower end of the 95 % interval of that change in the session",
         session(&StratifiedDrift::ci_low)),
       F("session_drift.ci_high", "upper end of that in the session", session(&StratifiedDrift::ci_high)),
       F("session_drift.p", "p of no change in the session", session(&StratifiedDrift::p),
         {.title = "p", .shown = Shown::p_value}),
       F("session_drift.p_holm", "session_drift_p with Holm's correction over the conditions",
         [](const R& r) { return r.session_drift ? std::optional(r.holm.session) : std::nullopt; },
         {.title = "p(Holm)", .shown = Shown::p_value}),
       F("all_conditions", "",
         [&protocol](const R& r) { return r.condition < 0 ? std::string("all") : condition_of(protocol, r.condition); },
         {.title = "condition", .place = Place::table}),
       F("remarks", "", behaviour_remarks, {.title = "cautions", .place = Place::table})});
  std::vector<R> rows = results.behaviour.conditions;
  rows.insert(rows.end(), results.behaviour.participants.begin(), results.behaviour.participants.end());
  Block block;
  block.id = "behaviour";
  block.section = Section::behaviour;
  block.title = "How the answers were given";
  block.note =
      "order: rate of \"different\" with the stiffer stimulus first minus second; c: criterion over all trials (c > 0 leans to "
      "\"same\"), with the share of \"different\" answers; drift: d' in the second half of each cell minus the first; session: "
      "second half of the session minus the first, each series held against itself; p(Holm): over the conditions, or over the "
      "participants";
  block.columns = {{"participant"},
                   {"all_conditions"},
                   {"order_effect.difference"},
                   range("order_effect.ci_low", "order_effect.ci_high"),
                   {"order_effect.p"},
                   {"order_effect.p_holm"},
                   {"response_bias.criterion"},
                   range("response_bias.ci_low", "response_bias.ci_high"),
                   {"response_bias.said_different.value"},
                   {"response_bias.p"},
                   {"response_bias.p_holm"},
                   {"drift.dprime.difference"},
                   range("drift.dprime.ci_low", "drift.dprime.ci_high"),
                   {"drift.dprime.p"},
                   {"drift.dprime.p_holm"},
                   {"session_drift.difference"},
                   {"session_drift.p"},
                   {"session_drift.p_holm"},
                   {"remarks"}};
  return std::move(block.with(fields, std::move(rows)));
}

Block sureness_block(const StudyResults& results, const Protocol& protocol) {
  using R = SurenessRow;
  using F = Field<R>;
  const std::string unit(to_string(protocol.stimulus.unit));
  const auto fit = [](auto member) { return [member](const R& r) { return r.fit.*member; }; };
  const Fields<R> fields = {
      common<R>("participant", &R::participant),
      condition_field<R>(protocol, [](const R& r) { return r.condition; }),
      common<R>("trials", &R::trials),
      F("sigma", "JND from all degrees of sureness: the difference that adds d' = 1, ordered probit",
        fit(&Sureness::sigma), {.unit = unit, .title = "JND"}),
      common<R>("ci_low", fit(&Sureness::sigma_low), {.unit = unit}),
      common<R>("ci_high", fit(&Sureness::sigma_high), {.unit = unit}),
      F("deviance", "deviance of the fit against every difference with its own proportions", fit(&Sureness::deviance)),
      F("p_zero_slope", "likelihood-ratio p of no sensitivity", fit(&Sureness::p_zero_slope),
        {.title = "p", .shown = Shown::p_value}),
      common<R>("status", fit(&Sureness::status))};
  Block block;
  block.id = "sureness";
  block.section = Section::behaviour;
  block.title = "JND from how sure the answers were";
  block.note =
      "P(answer <= j) = Phi(c_j - dK / JND), the criteria c_j common to all differences; maximum likelihood with its profile "
      "interval; p: of no sensitivity";
  block.columns = {{"participant"}, {"condition"},    {"trials"}, {"sigma"}, range("ci_low", "ci_high"),
                   {"deviance"},    {"p_zero_slope"}, {"status"}};
  return std::move(block.with(fields, results.sureness));
}

// A cue in a condition.
struct CueFitRow {
  const CueRow* row;
  std::size_t cue;
  const CueFit& fit() const { return row->strategy.cues[cue]; }
};

// Whether a condition has any trial that a cue could be fitted to.
bool anything_measured(const CueRow& row) {
  return row.strategy.status != CueStatus::too_few_trials || row.strategy.common_trials != 0 ||
         std::any_of(row.strategy.cues.begin(), row.strategy.cues.end(), [](const CueFit& fit) { return fit.n != 0; });
}

Block cues_block(const StudyResults& results, const Protocol& protocol) {
  using R = CueFitRow;
  using F = Field<R>;
  const auto fit = [](auto member) { return [member](const R& r) { return r.fit().*member; }; };
  const auto partial = [](auto member) { return [member](const R& r) { return r.fit().beside_stiffness.*member; }; };
  const Fields<R> fields = {
      condition_field<R>(protocol, [](const R& r) { return r.row->condition; }),
      F("cue", "trace of the stimulus in the interval", fit(&CueFit::cue)),
      common<R>("trials", fit(&CueFit::n)),
      F("trials_without", "trials in which it was not measured", fit(&CueFit::missing)),
      F("cue_slope", "slope of the answers on the standardised cue", fit(&CueFit::slope), {.title = "b"}),
      F("cue_slope_se", "its standard error", fit(&CueFit::slope_se)),
      common<R>("log_likelihood", fit(&CueFit::log_likelihood)),
      F("deviance_explained", "share of the deviance that the cue explains", fit(&CueFit::deviance_explained),
        {.title = "deviance explained", .shown = Shown::percent}),
      F("aic", "Akaike's criterion", fit(&CueFit::aic), {.title = "AIC"}),
      F("beside_stiffness.status", "whether the cue was tested beside stiffness", partial(&CuePartialTest::status)),
      F("beside_stiffness.chi2", "likelihood-ratio chi-square of what it adds to stiffness",
        partial(&CuePartialTest::chi_square)),
      F("beside_stiffness.p", "p of that chi-square of a cue", partial(&CuePartialTest::p),
        {.title = "p beside stiffness", .shown = Shown::p_value}),
      F("participants_best", "participants whose own answers the cue explains best",
        [](const R& r) { return r.row->best_of.empty() ? std::nullopt : std::optional(r.row->best_of[r.cue]); },
        {.title = "best of"}),
      F("undecided", "participants for whom no cue is the best", [](const R& r) { return r.row->undecided; }),
      F("best", "1 for the cue that explains most", [](const R& r) { return r.row->strategy.best == r.fit().cue; },
        {.levels = "0 1"}),
      common<R>("status", fit(&CueFit::status)),
      F("remarks", "",
        [](const R& r) {
          std::string text = r.row->strategy.best == r.fit().cue ? "explains most" : "";
          if (r.fit().status != CueStatus::ok) text = joined(text, std::string(to_string(r.fit().status)));
          if (r.fit().missing > 0) text = joined(text, fmt::format("{} trials without it", r.fit().missing));
          return text;
        },
        {.title = "cautions", .place = Place::table})};
  std::vector<R> rows;
  for (const CueRow& row : results.behaviour.cues)
    if (anything_measured(row))
      for (std::size_t i = 0; i < row.strategy.cues.size(); ++i) rows.push_back({&row, i});
  Block block;
  block.id = "cues";
  block.section = Section::behaviour;
  block.title = "Which trace of the stimulus explains the answers?";
  block.note =
      "P(\"different\") = Phi(l + b z), z the standardised difference between the intervals as delivered; p: what the cue adds "
      "to stiffness; best of: participants whose own answers it explains best";
  block.columns = {{"condition"},
                   {"cue"},
                   {"trials"},
                   {"cue_slope"},
                   {"deviance_explained"},
                   {"aic"},
                   {"beside_stiffness.p"},
                   {"participants_best"},
                   {"remarks"}};
  return std::move(block.with(fields, std::move(rows)));
}

struct CombinedRow {
  const CueCombination* of;
  const CombinedParticipant* person;  // null: everyone together
};

Block combinations_block(const StudyResults& results, const Protocol& protocol) {
  using R = CombinedRow;
  using F = Field<R>;
  const std::string unit(to_string(protocol.stimulus.unit));
  const auto ratio = [](double MeanEstimate::*member) {
    return [member](const R& r) { return r.person == nullptr ? std::exp(r.of->log_ratio.*member) : kNaN; };
  };
  const Fields<R> fields = {
      condition_field<R>(
          protocol, [](const R& r) { return r.of->a; }, "a"),
      condition_field<R>(
          protocol, [](const R& r) { return r.of->b; }, "b"),
      F("both", "condition that has the cues of both",
        [&protocol](const R& r) { return condition_of(protocol, r.of->both); }),
      common<R>("participant", [](const R& r) { return r.person == nullptr ? std::string() : r.person->participant; }),
      common<R>("n", [](const R& r) { return r.person == nullptr ? std::optional(r.of->log_ratio.n) : std::nullopt; }),
      F("predicted", "JND of an optimal combination: 1 / JND^2 adds (Ernst and Banks 2002)",
        [](const R& r) { return r.person == nullptr ? std::nullopt : r.person->predicted; }, {.unit = unit}),
      F("observed", "JND in the condition that has both",
        [](const R& r) { return r.person == nullptr ? std::nullopt : r.person->observed; }, {.unit = unit}),
      F("observed_to_predicted", "of everyone: geometric mean of observed / predicted; empty in rows of participants",
        ratio(&MeanEstimate::mean)),
      common<R>("ci_low", ratio(&MeanEstimate::ci_low)),
      common<R>("ci_high", ratio(&MeanEstimate::ci_high))};
  std::vector<R> rows;
  for (const CueCombination& one : results.combinations) {
    if (one.log_ratio.n == 0) continue;
    rows.push_back({&one, nullptr});
    for (const CombinedParticipant& person : one.participants) rows.push_back({&one, &person});
  }
  Block block;
  block.id = "combinations";
  block.section = Section::behaviour;
  block.title = "Cues together against what they would come to";
  block.note = "predicted: the JND of an optimal combination; observed / predicted of everyone with Student's interval";
  block.columns = {{"both"},
                   {"participant"},
                   {"n"},
                   {"predicted"},
                   {"observed"},
                   {"observed_to_predicted", {}, {}, "ratio"},
                   range("ci_low", "ci_high")};
  return std::move(block.with(fields, std::move(rows)));
}

// --- Questions.

std::string series_name(const Protocol& protocol, int place) {
  return place < 0 ? std::string() : protocol.series[static_cast<std::size_t>(place)].name;
}

struct ScoreRow {
  const Question* question;
  const ItemScore* score;
};

const PublishedValue* published_rating(const Protocol& protocol, const ScoreRow& row) {
  return published_value(protocol, condition_of(protocol, row.score->condition), row.score->series, "rating",
                         row.question->id);
}

// "(1 not at all to 9 completely)", or "(0 to 40)" of a number, whose ends have no names.
std::string question_note(const Question& question) {
  const auto end = [](double value, const std::string& label) {
    return fmt::format("{:g}{}{}", value, label.empty() ? "" : " ", label);
  };
  return fmt::format("{}: \"{}\" ({} to {})", question.id, question.text, end(question.min, question.low_label),
                     end(question.max, question.high_label));
}

Block items_block(const StudyResults& results, const Protocol& protocol) {
  using R = ScoreRow;
  using F = Field<R>;
  const auto median = [](auto member) { return [member](const R& r) { return r.score->median.*member; }; };
  const auto side = [](int ItemScore::Sides::*member) {
    return [member](const R& r) { return r.score->sides ? std::optional((*r.score->sides).*member) : std::nullopt; };
  };
  Fields<R> fields = {common<R>("item", [](const R& r) { return r.question->id; }),
                      F("part", "part of the questionnaire", [](const R& r) { return r.question->group; }),
                      common<R>("text", [](const R& r) { return r.question->text; }),
                      condition_field<R>(protocol, [](const R& r) { return r.score->condition; }),
                      common<R>("series", [&protocol](const R& r) { return series_name(protocol, r.score->series); })};
  add_mean_fields(fields, [](const R& r) -> const MeanEstimate& { return r.score->mean; });
  fields.insert(
      fields.end(),
      {common<R>("median", median(&MedianInterval::median)),
       F("median_low", "lower end of the median's distribution-free interval", median(&MedianInterval::ci_low)),
       F("median_high", "upper end of that of the median", median(&MedianInterval::ci_high)),
       F("coverage", "how often that interval covers; below 0.95 where there are too few participants",
         median(&MedianInterval::coverage), {.title = "covers", .shown = Shown::percent}),
       F("scale_min", "lowest answer that may be given", [](const R& r) { return r.question->min; }),
       F("scale_max", "highest answer that may be given", [](const R& r) { return r.question->max; }),
       F("n_below", "ratings below the middle of the scale; empty for numbers, as the next two",
         side(&ItemScore::Sides::below), {.title = "below"}),
       F("n_middle", "ratings on the middle of the scale", side(&ItemScore::Sides::at), {.title = "middle"}),
       F("n_above", "ratings above the middle of the scale", side(&ItemScore::Sides::above), {.title = "above"}),
       common<R>("status", [](const R& r) { return std::string(to_text(r.score->median.status)); }),
       F("shown", "",
         [&protocol](const R& r) {
           return r.score->condition >= 0 ? condition_of(protocol, r.score->condition)
                  : r.score->series >= 0  ? series_name(protocol, r.score->series)
                                          : std::string("asked once");
         },
         {.title = "condition", .place = Place::table})});
  const bool printed = std::any_of(protocol.published.begin(), protocol.published.end(),
                                   [](const PublishedValue& one) { return one.quantity == "rating"; });
  if (printed) {
    fields.push_back(common<R>("published",
                               [&protocol](const R& r) {
                                 const PublishedValue* value = published_rating(protocol, r);
                                 return value == nullptr ? std::nullopt : std::optional(value->value);
                               },
                               {.shown = Shown::given}));
    fields.push_back(F("published_sd", "its standard deviation",
                       [&protocol](const R& r) {
                         const PublishedValue* value = published_rating(protocol, r);
                         return value == nullptr ? std::nullopt : value->sd;
                       },
                       {.shown = Shown::given}));
  }
  Block block;
  std::vector<R> rows;
  for (const QuestionnaireItem& item : results.questionnaire.items) {
    const Question& question = question_of(item.question, protocol);
    for (const ItemScore& score : item.scores) rows.push_back({&question, &score});
    block.footnotes.push_back(question_note(question));
  }
  block.id = "items";
  block.section = Section::questions;
  block.title = "Answers to the questions";
  block.note =
      "mean with Student's interval; median with a distribution-free one, which covers as often as said; below, middle, above: "
      "ratings by the middle of the scale";
  block.columns = {{"item"},
                   {"shown"},
                   {"n"},
                   {"mean"},
                   range("ci_low", "ci_high"),
                   {"sd"},
                   {"median"},
                   range("median_low", "median_high", "interval"),
                   {"coverage"},
                   {"n_below"},
                   {"n_middle"},
                   {"n_above"}};
  if (printed) block.columns.push_back(share("published", "published_sd", "published", " ± "));
  return std::move(block.with(fields, std::move(rows)));
}

struct RatingRow {
  const PairedItemResult* item;
  const ItemPair* pair;
};

Block ratings_block(const StudyResults& results, const Protocol& protocol) {
  using R = RatingRow;
  using F = Field<R>;
  const QuestionnaireResults& all = results.questionnaire;
  const TestCount& below = all.below_alpha;
  const double alpha = all.alpha;
  const auto test = [](auto member) { return [member](const R& r) { return r.pair->test.*member; }; };
  const auto of = [](auto member) { return [member](const R& r) { return r.pair->*member; }; };
  const auto p = [](std::string_view key, std::string_view meaning, auto get, std::string_view title) {
    return F(key, meaning, get, {.title = title, .shown = Shown::p_value});
  };
  const Fields<R> fields = {
      common<R>("item", [](const R& r) { return r.item->id; }),
      condition_field<R>(
          protocol, [](const R& r) { return static_cast<int>(r.pair->a); }, "a"),
      condition_field<R>(
          protocol, [](const R& r) { return static_cast<int>(r.pair->b); }, "b"),
      common<R>("n", test(&SignedRank::n)),
      F("median_a", "median answer under a", [](const R& r) { return r.item->conditions[r.pair->a].median; }),
      F("median_b", "median answer under b", [](const R& r) { return r.item->conditions[r.pair->b].median; }),
      F("median_difference", "median of the differences", of(&ItemPair::median_difference)),
      F("zeros", "equal answers, which the test drops", test(&SignedRank::zeros)),
      F("ties", "1 where differences are equal in size", test(&SignedRank::ties), {.levels = "0 1"}),
      F("v", "Wilcoxon's V", test(&SignedRank::v), {.title = "V"}),
      common<R>("p", test(&SignedRank::p), {.shown = Shown::p_value}),
      F("exact_as_r", "1 where R's wilcox.test gives an exact p, which p is then", test(&SignedRank::exact),
        {.levels = "0 1"}),
      p("p_exact_permutation", "exact permutation p with midranks (normal beyond 200 differences)", of(&ItemPair::p),
        "exact"),
      F("exact_permutation", "1 where p_exact_permutation is exact", of(&ItemPair::exact), {.levels = "0 1"}),
      p("p_exact_holm", "p_exact_permutation with Holm's correction over all pairs of all items", of(&ItemPair::p_holm),
        "Holm"),
      p("p_exact_bh", "p_exact_permutation with Benjamini and Hochberg's", of(&ItemPair::p_bh), "BH"),
      F("rank_biserial", "effect size, -1 to 1", test(&SignedRank::rank_biserial), {.title = "rank-biserial"}),
      common<R>("status", [](const R& r) { return std::string(to_text(r.pair->test.status)); }),
      F("decided", "",
        [alpha](const R& r) {
          std::string text = r.pair->p < alpha ? "alone" : "";
          if (r.pair->p_holm < alpha) text = joined(text, "Holm");
          return r.pair->p_bh < alpha ? joined(text, "BH") : text;
        },
        {.title = fmt::format("below {:g}", alpha), .place = Place::table})};
  Block block;
  block.id = "ratings";
  block.section = Section::questions;
  block.title = "Answers compared between conditions";
  block.note = fmt::format(
      "Wilcoxon's signed-rank test; p: as R's wilcox.test; exact: permutation p with midranks, which Holm and "
      "Benjamini-Hochberg correct over {} test{}; zeros: equal answers, dropped",
      all.tests.family, all.tests.family == 1 ? "" : "s");
  block.footnotes = {fmt::format(
      "Of {} tests, below {:g}: {} as R, {} by the exact p, {} with Holm's correction, {} with Benjamini-Hochberg's.",
      all.tests.family, alpha, below.as_r, below.exact, below.holm, below.bh)};
  block.columns = {{"item"},
                   share("a", "b", "pair", " - "),
                   share("median_a", "median_b", "medians", " / "),
                   {"n"},
                   {"zeros"},
                   {"v"},
                   {"p"},
                   {"p_exact_permutation"},
                   {"p_exact_holm"},
                   {"p_exact_bh"},
                   {"rank_biserial"},
                   {"decided"}};
  std::vector<R> rows;
  for (const PairedItemResult& item : all.tests.items)
    for (const ItemPair& pair : item.pairs) rows.push_back({&item, &pair});
  return std::move(block.with(fields, std::move(rows)));
}

struct OptionRow {
  const Question* question;
  const ChoiceResult* choice;
  std::size_t option;
};

Block choices_block(const StudyResults& results, const Protocol& protocol) {
  using R = OptionRow;
  using F = Field<R>;
  const auto of = [](auto member) { return [member](const R& r) { return r.choice->options[r.option].*member; }; };
  const Fields<R> fields = {common<R>("item", [](const R& r) { return r.question->id; }),
                            common<R>("text", [](const R& r) { return r.question->text; }),
                            condition_field<R>(protocol, [](const R& r) { return r.choice->condition; }),
                            F("option", "one of the answers that may be chosen",
                              [](const R& r) { return r.question->options[r.option]; }, {.title = "answer"}),
                            F("count", "how often that was so", of(&ExactProportion::k)),
                            common<R>("n", [](const R& r) { return r.choice->n; }),
                            F("share", "count / n", of(&ExactProportion::share), {.shown = Shown::percent}),
                            common<R>("ci_low", of(&ExactProportion::ci_low), {.shown = Shown::percent}),
                            common<R>("ci_high", of(&ExactProportion::ci_high), {.shown = Shown::percent})};
  Block block;
  std::vector<R> rows;
  for (const ChoiceResult& choice : results.exploration.choices) {
    const Question& question = question_of(choice.question, protocol);
    for (std::size_t i = 0; i < choice.options.size(); ++i) rows.push_back({&question, &choice, i});
    if (choice.condition <= 0) block.footnotes.push_back(fmt::format("{}: {}", question.id, question.text));
  }
  block.id = "choices";
  block.section = Section::questions;
  block.title = "Choices";
  block.note = "share with its exact binomial interval (Clopper and Pearson)";
  block.columns = {
      {"item"}, {"condition"}, {"option"}, share("count", "n", "count"), {"share"}, range("ci_low", "ci_high")};
  return std::move(block.with(fields, std::move(rows)));
}

Block exposure_block(const StudyResults& results, const Protocol& protocol) {
  using R = Exposure;
  using F = Field<R>;
  const Fields<R> fields = {
      condition_field<R>(protocol, [](const R& r) { return r.condition; }),
      F("object", "virtual object explored",
        [&protocol](const R& r) { return protocol.explore->objects[static_cast<std::size_t>(r.object)]; }),
      common<R>("n", &R::n),
      F("planned_s", "time planned for each", &R::planned_s, {.unit = "s", .title = "planned s"}),
      F("mean_s", "mean time, without pauses", &R::mean_s, {.unit = "s", .title = "mean s"}),
      F("shortest_s", "shortest time", &R::shortest_s, {.unit = "s", .title = "shortest s"}),
      F("ended_early", "of them ended by the operator", &R::ended_early, {.title = "ended early"}),
      F("given_up", "explorations that were given up", &R::given_up, {.title = "given up"})};
  Block block;
  block.id = "exposure";
  block.section = Section::questions;
  block.title = "Free interaction";
  block.note = "time with each object, without pauses";
  block.columns = {{"condition"}, {"object"},     {"n"},           {"planned_s"},
                   {"mean_s"},    {"shortest_s"}, {"ended_early"}, {"given_up"}};
  return std::move(block.with(fields, results.exploration.exposure));
}

}  // namespace

Blocks behaviour_blocks(const StudyResults& results, const Protocol& protocol) {
  Blocks blocks;
  if (!results.sureness.empty()) blocks.push_back(sureness_block(results, protocol));
  if (!results.behaviour.participants.empty()) {
    blocks.push_back(behaviour_block(results, protocol));
    blocks.push_back(cues_block(results, protocol));
  }
  if (!results.combinations.empty()) blocks.push_back(combinations_block(results, protocol));
  return blocks;
}

Blocks question_blocks(const StudyResults& results, const Protocol& protocol) {
  Blocks blocks;
  if (!results.exploration.exposure.empty()) blocks.push_back(exposure_block(results, protocol));
  if (!results.questionnaire.items.empty()) {
    blocks.push_back(items_block(results, protocol));
    blocks.push_back(ratings_block(results, protocol));
  }
  if (!results.exploration.choices.empty()) blocks.push_back(choices_block(results, protocol));
  return blocks;
}

std::vector<Block> result_blocks(const StudyResults& results, const Protocol& protocol, const StudyModels* models) {
  Blocks blocks;
  const auto add = [&blocks](Blocks more) {
    for (Block& block : more)
      if (block.rows() > 0) blocks.push_back(std::move(block));
  };
  add(estimate_blocks(results, protocol));
  add(test_blocks(results, protocol));
  add(hierarchical_blocks(results, protocol));
  add(model_blocks(results, protocol, models));
  add(behaviour_blocks(results, protocol));
  add(question_blocks(results, protocol));
  // Of free interaction they are all there is to find.
  if (results.task.outcomes.empty())
    for (Block& block : blocks)
      if (block.section == Section::questions) block.answer = {block.title, block.note, block.columns, ""};
  return blocks;
}

}  // namespace jnd
