#include "data/fields/answer_fields.h"

#include <string>

namespace jnd {

namespace {

// Nothing where the place is that of no condition.
FieldValue named_condition(const Protocol& protocol, int place) {
  return place < 0 ? FieldValue() : FieldValue(condition_of(protocol, place));
}

// key.k, key.n and key.value: how often "different" was said.
template <typename Row, typename Get>
void add_share(Fields<Row>& fields, const std::string& key, Get get) {
  fields.push_back(beside<Row>(key + ".k", [get](const Row& r) { return std::invoke(get, r).k; }));
  fields.push_back(beside<Row>(key + ".n", [get](const Row& r) { return std::invoke(get, r).n; }));
  fields.push_back(beside<Row>(key + ".value", [get](const Row& r) { return std::invoke(get, r).value; }));
}

}  // namespace

Fields<BehaviourRow> behaviour_fields(const Protocol& protocol) {
  using R = BehaviourRow;
  using F = Field<R>;
  Fields<R> fields = {
      beside<R>("participant",
                [](const R& r) { return r.participant.empty() ? FieldValue() : FieldValue(r.participant); }),
      F("participant_or_all", "code of the participant; all for everyone together",
        [](const R& r) { return r.participant.empty() ? std::string("all") : r.participant; },
        {.column = "participant"}),
      F("condition", "condition; empty for all together",
        [&protocol](const R& r) { return named_condition(protocol, r.condition); }),
      F("order_effect.status", "whether both orders of different pairs occur",
        [](const R& r) { return r.order.status; }, {.column = "order_status"})};
  const auto add = [&](F field) { fields.push_back(std::move(field)); };
  // A number with a column; p values are read like such.
  const auto number = [&](const char* key, const char* column, const char* meaning, const char* title, int digits,
                          auto get) {
    add(F(key, meaning, get,
          {.column = column,
           .title = title,
           .digits = digits,
           .shown = std::string_view(key).ends_with(".p") ? Shown::p_value : Shown::number}));
  };
  add_share(fields, "order_effect.stiffer_first", [](const R& r) { return r.order.stiffer_first; });
  add_share(fields, "order_effect.stiffer_second", [](const R& r) { return r.order.stiffer_second; });
  number("order_effect.difference", "order_difference",
         "rate of \"different\" with the stiffer stimulus first minus second", "order", 3,
         [](const R& r) { return r.order.difference; });
  number("order_effect.ci_low", "order_ci95_low", "lower end of its 95 % interval (Newcombe)", "", 2,
         [](const R& r) { return r.order.ci_low; });
  number("order_effect.ci_high", "order_ci95_high", "upper end", "", 2, [](const R& r) { return r.order.ci_high; });
  number("order_effect.p", "order_p", "Fisher's exact p", "p", 0, [](const R& r) { return r.order.p; });
  number("order_effect.holm.p", "order_p_holm", "that p, Holm over the conditions or over the participants", "p(Holm)",
         0, [](const R& r) { return r.holm.order; });

  add(F("response_bias.status", "whether the criterion is defined", [](const R& r) { return r.bias.status; },
        {.column = "bias_status"}));
  number("response_bias.criterion", "criterion", "c over all trials, log-linear rates; positive: tends to say same",
         "c", 2, [](const R& r) { return r.bias.criterion; });
  number("response_bias.ci_low", "criterion_ci95_low", "lower end of its 95 % interval", "", 2,
         [](const R& r) { return r.bias.ci_low; });
  number("response_bias.ci_high", "criterion_ci95_high", "upper end", "", 2, [](const R& r) { return r.bias.ci_high; });
  add_share(fields, "response_bias.said_different", [](const R& r) { return r.bias.said_different; });
  fields.back() = F("response_bias.said_different.value", "share of \"different\" answers",
                    [](const R& r) { return r.bias.said_different.value; },
                    {.column = "said_different", .title = "said different", .shown = Shown::percent});
  add(beside<R>("response_bias.planned_share", [](const R& r) { return r.bias.planned_share; }));
  number("response_bias.p", "bias_p", "exact binomial p of that share against the planned one", "p", 0,
         [](const R& r) { return r.bias.p; });
  number("response_bias.holm.p", "bias_p_holm", "that p, Holm over the conditions or over the participants", "p(Holm)",
         0, [](const R& r) { return r.holm.bias; });

  add(F("drift.status", "whether both halves have both classes", [](const R& r) { return r.drift.status; },
        {.column = "drift_status"}));
  add(beside<R>("drift.dprime.first", [](const R& r) { return r.drift.dprime.first; }));
  add(beside<R>("drift.dprime.second", [](const R& r) { return r.drift.dprime.second; }));
  number("drift.dprime.difference", "drift_dprime", "d' in the second half of each cell's trials minus the first",
         "drift of d'", 2, [](const R& r) { return r.drift.dprime.difference; });
  number("drift.dprime.ci_low", "drift_dprime_ci95_low", "lower end of its 95 % interval", "", 2,
         [](const R& r) { return r.drift.dprime.ci_low; });
  number("drift.dprime.ci_high", "drift_dprime_ci95_high", "upper end", "", 2,
         [](const R& r) { return r.drift.dprime.ci_high; });
  number("drift.dprime.p", "drift_dprime_p", "likelihood-ratio p of no change", "p", 0,
         [](const R& r) { return r.drift.dprime.p; });
  number("drift.dprime.holm.p", "drift_dprime_p_holm", "that p, Holm over the conditions or over the participants",
         "p(Holm)", 0, [](const R& r) { return r.holm.drift; });
  add(beside<R>("drift.criterion.first", [](const R& r) { return r.drift.criterion.first; }));
  add(beside<R>("drift.criterion.second", [](const R& r) { return r.drift.criterion.second; }));
  number("drift.criterion.difference", "drift_criterion",
         "criterion in the second half of each cell's trials minus the first", "", 2,
         [](const R& r) { return r.drift.criterion.difference; });
  add(beside<R>("drift.criterion.ci_low", [](const R& r) { return r.drift.criterion.ci_low; }));
  add(beside<R>("drift.criterion.ci_high", [](const R& r) { return r.drift.criterion.ci_high; }));
  number("drift.criterion.p", "drift_criterion_p", "likelihood-ratio p of no change", "p", 0,
         [](const R& r) { return r.drift.criterion.p; });

  const auto session = [](auto member) {
    return [member](const R& r) { return r.session_drift ? std::optional((*r.session_drift).*member) : std::nullopt; };
  };
  add(beside<R>("session_drift.strata", session(&StratifiedDrift::strata)));
  number("session_drift.difference", "session_drift_dprime",
         "of all together: d' in the second half of the session minus the first, each series against itself", "session",
         2, session(&StratifiedDrift::difference));
  add(beside<R>("session_drift.ci_low", session(&StratifiedDrift::ci_low)));
  add(beside<R>("session_drift.ci_high", session(&StratifiedDrift::ci_high)));
  number("session_drift.p", "session_drift_dprime_p", "p of no change", "p", 0, session(&StratifiedDrift::p));
  number("session_drift.holm.p", "session_drift_dprime_p_holm", "that p, Holm over the conditions", "p(Holm)", 0,
         [](const R& r) { return r.session_drift ? std::optional(r.holm.session) : std::nullopt; });
  return fields;
}

Fields<SurenessRow> sureness_fields(const Protocol& protocol) {
  using R = SurenessRow;
  using F = Field<R>;
  const std::string unit(to_string(protocol.stimulus.unit));
  const auto fit = [](auto member) { return [member](const R& r) { return r.fit.*member; }; };
  return {F("participant", "code of the participant", &R::participant),
          F("condition", "condition", [&protocol](const R& r) { return condition_of(protocol, r.condition); }),
          F("trials", "counted trials", &R::trials),
          F("jnd", "JND from all degrees of sureness: the difference that adds d' = 1, ordered probit",
            fit(&Sureness::sigma), {.unit = unit, .title = "JND", .shown = Shown::compact}),
          F("ci_low", "lower end of its 95 % profile-likelihood interval", fit(&Sureness::sigma_low),
            {.column = "jnd_ci95_low", .unit = unit, .shown = Shown::compact}),
          F("ci_high", "upper end", fit(&Sureness::sigma_high),
            {.column = "jnd_ci95_high", .unit = unit, .shown = Shown::compact}),
          F("deviance", "deviance of the fit against every difference with its own proportions",
            fit(&Sureness::deviance), {.digits = 2}),
          F("p", "likelihood-ratio p of no sensitivity", fit(&Sureness::p_zero_slope), {.shown = Shown::p_value}),
          F("status",
            "ok; flat, the answers do not rise with the difference; separated, they do without an overlap; "
            "not_identified, one difference only; no_information, one answer throughout",
            fit(&Sureness::status))};
}

Fields<CueFitRow> cue_fields(const Protocol& protocol) {
  using R = CueFitRow;
  const auto fit = [](auto member) { return [member](const R& r) { return r.row->strategy.cues[r.cue].*member; }; };
  const auto partial = [](auto member) {
    return [member](const R& r) { return r.row->strategy.cues[r.cue].beside_stiffness.*member; };
  };
  return {beside<R>("condition", [&protocol](const R& r) { return condition_of(protocol, r.row->condition); }),
          beside<R>("cue", fit(&CueFit::cue)),
          beside<R>("status", fit(&CueFit::status)),
          beside<R>("n", fit(&CueFit::n), {.title = "trials"}),
          beside<R>("missing", fit(&CueFit::missing)),
          beside<R>("slope", fit(&CueFit::slope), {.title = "b"}),
          beside<R>("slope_se", fit(&CueFit::slope_se)),
          beside<R>("log_likelihood", fit(&CueFit::log_likelihood)),
          beside<R>("deviance_explained", fit(&CueFit::deviance_explained),
                    {.title = "deviance explained", .shown = Shown::percent}),
          beside<R>("aic", fit(&CueFit::aic), {.title = "AIC", .digits = 1}),
          beside<R>("beside_stiffness.status", partial(&CuePartialTest::status)),
          beside<R>("beside_stiffness.chi2", partial(&CuePartialTest::chi_square)),
          beside<R>("beside_stiffness.p", partial(&CuePartialTest::p),
                    {.title = "p beside stiffness", .shown = Shown::p_value}),
          beside<R>("participants_best", [](const R& r) {
            return r.row->best_of.empty() ? std::nullopt : std::optional(r.row->best_of[r.cue]);
          })};
}

Fields<ScoreRow> score_fields(const Protocol& protocol) {
  using R = ScoreRow;
  using F = Field<R>;
  const auto mean = [](auto member) { return [member](const R& r) { return r.score->mean.*member; }; };
  const auto median = [](auto member) { return [member](const R& r) { return r.score->median.*member; }; };
  const auto side = [](int ItemScore::Sides::*member) {
    return [member](const R& r) { return r.score->sides ? std::optional((*r.score->sides).*member) : std::nullopt; };
  };
  return {F("item", "identifier of the question", [](const R& r) { return r.question->id; }),
          F("group", "part of the questionnaire", [](const R& r) { return r.question->group; }),
          F("text", "the question", [](const R& r) { return r.question->text; }),
          F("condition", "condition rated; empty where asked once",
            [&protocol](const R& r) { return named_condition(protocol, r.score->condition); }),
          F("n", "participants who answered", mean(&MeanEstimate::n)),
          F("mean", "mean answer", mean(&MeanEstimate::mean), {.digits = 2}),
          F("sd", "standard deviation, n - 1", mean(&MeanEstimate::sd)),
          F("mean_ci_low", "lower end of the mean's 95 % interval (Student t)", mean(&MeanEstimate::ci_low),
            {.column = "mean_ci95_low", .digits = 2}),
          F("mean_ci_high", "upper end", mean(&MeanEstimate::ci_high), {.column = "mean_ci95_high", .digits = 2}),
          F("median", "median answer", median(&MedianInterval::median), {.digits = 1}),
          F("ci_low", "lower end of the median's distribution-free interval", median(&MedianInterval::ci_low),
            {.digits = 1}),
          F("ci_high", "upper end", median(&MedianInterval::ci_high), {.digits = 1}),
          F("coverage", "how often the interval covers; below 0.95 where there are too few participants",
            median(&MedianInterval::coverage), {.shown = Shown::percent}),
          beside<R>("status", [](const R& r) { return to_text(r.score->median.status); }),
          F("scale_min", "lowest answer that may be given", [](const R& r) { return r.question->min; }),
          F("scale_max", "highest", [](const R& r) { return r.question->max; }),
          F("below", "ratings below the middle of the scale; empty for numbers, as the next two",
            side(&ItemScore::Sides::below), {.column = "n_below"}),
          F("middle", "ratings on the middle of the scale", side(&ItemScore::Sides::at), {.column = "n_middle"}),
          F("above", "ratings above the middle of the scale", side(&ItemScore::Sides::above), {.column = "n_above"})};
}

std::vector<ScoreRow> score_rows(const QuestionnaireItem& item, const Protocol& protocol) {
  std::vector<ScoreRow> rows;
  for (const ItemScore& score : item.scores)
    rows.push_back({&protocol.questions[static_cast<std::size_t>(item.question)], &score});
  return rows;
}

Fields<RatingRow> rating_fields(const Protocol& protocol) {
  using R = RatingRow;
  using F = Field<R>;
  return {F("item", "identifier of the question", [](const R& r) { return r.item->id; }),
          F("a", "first condition", [&protocol](const R& r) { return protocol.conditions[r.pair->a].name; },
            {.column = "condition_a"}),
          F("b", "second condition", [&protocol](const R& r) { return protocol.conditions[r.pair->b].name; },
            {.column = "condition_b"}),
          F("n", "participants who answered for both", [](const R& r) { return r.pair->test.n; }),
          F("median_a", "median answer under a", [](const R& r) { return r.item->conditions[r.pair->a].median; }),
          F("median_b", "median answer under b", [](const R& r) { return r.item->conditions[r.pair->b].median; }),
          F("zeros", "equal answers, which the test drops", [](const R& r) { return r.pair->test.zeros; }),
          beside<R>("ties", [](const R& r) { return r.pair->test.ties; }),
          F("v", "Wilcoxon's V", [](const R& r) { return r.pair->test.v; }, {.title = "V", .digits = 1}),
          beside<R>("p_r", [](const R& r) { return r.pair->test.p; }, {.title = "p", .shown = Shown::p_value}),
          beside<R>("p_r_exact", [](const R& r) { return r.pair->test.exact; }),
          F("p", "exact permutation p (normal beyond 200 differences)", [](const R& r) { return r.pair->p; },
            {.shown = Shown::p_value}),
          beside<R>("exact", [](const R& r) { return r.pair->exact; }),
          F("p_holm", "with Holm's correction over all pairs of all items", [](const R& r) { return r.pair->p_holm; },
            {.title = "p(Holm)", .shown = Shown::p_value}),
          F("p_bh", "with Benjamini and Hochberg's", [](const R& r) { return r.pair->p_bh; },
            {.title = "p(BH)", .shown = Shown::p_value}),
          beside<R>("median_difference", [](const R& r) { return r.pair->median_difference; }),
          F("rank_biserial", "effect size, -1 to 1", [](const R& r) { return r.pair->test.rank_biserial; },
            {.title = "rank-biserial", .digits = 2}),
          beside<R>("status", [](const R& r) { return to_text(r.pair->test.status); })};
}

std::vector<RatingRow> rating_rows(const PairedQuestionnaire& tests) {
  std::vector<RatingRow> rows;
  for (const PairedItemResult& item : tests.items)
    for (const ItemPair& pair : item.pairs) rows.push_back({&item, &pair});
  return rows;
}

Fields<OptionRow> option_fields(const Protocol& protocol) {
  using R = OptionRow;
  using F = Field<R>;
  const auto share = [](auto member) { return [member](const R& r) { return r.choice->options[r.option].*member; }; };
  return {
      F("question", "identifier of the question", [](const R& r) { return r.question->id; }),
      beside<R>("text", [](const R& r) { return r.question->text; }),
      F("condition", "condition asked about; empty where asked once",
        [&protocol](const R& r) { return named_condition(protocol, r.choice->condition); }),
      F("option", "the answer", [](const R& r) { return r.question->options[r.option]; }, {.title = "answer"}),
      F("count", "participants who chose it", share(&ExactProportion::k)),
      F("n", "participants who chose any", [](const R& r) { return r.choice->n; }),
      F("share", "count / n", share(&ExactProportion::share), {.shown = Shown::percent}),
      F("ci_low", "lower end of its exact binomial interval (Clopper and Pearson)", share(&ExactProportion::ci_low),
        {.column = "ci95_low", .shown = Shown::percent}),
      F("ci_high", "upper end", share(&ExactProportion::ci_high), {.column = "ci95_high", .shown = Shown::percent})};
}

std::vector<OptionRow> option_rows(const ChoiceResult& choice, const Protocol& protocol) {
  std::vector<OptionRow> rows;
  for (std::size_t i = 0; i < choice.options.size(); ++i)
    rows.push_back({&protocol.questions[static_cast<std::size_t>(choice.question)], &choice, i});
  return rows;
}

Fields<Exposure> exposure_fields(const Protocol& protocol) {
  using R = Exposure;
  using F = Field<R>;
  return {F("condition", "condition", [&protocol](const R& r) { return condition_of(protocol, r.condition); }),
          F("object", "virtual object explored",
            [&protocol](const R& r) { return protocol.explore->objects[static_cast<std::size_t>(r.object)]; }),
          F("n", "completed explorations", &R::n),
          F("planned_s", "time planned for each", &R::planned_s, {.unit = "s", .title = "planned s", .digits = 1}),
          F("mean_s", "mean time, without pauses", &R::mean_s, {.unit = "s", .title = "mean s", .digits = 1}),
          F("shortest_s", "shortest time", &R::shortest_s, {.unit = "s", .title = "shortest s", .digits = 1}),
          F("ended_early", "of them ended by the operator", &R::ended_early, {.title = "ended early"}),
          F("given_up", "explorations that were given up", &R::given_up, {.title = "given up"})};
}

}  // namespace jnd
