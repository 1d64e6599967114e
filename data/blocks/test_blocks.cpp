// The registered contrasts, groups of participants, and conditions compared by every outcome.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "data/blocks/common_fields.h"
#include "data/blocks/comparison_blocks.h"
#include "data/blocks/result_blocks.h"
#include "protocols/planning/allotment.h"

namespace jnd {

namespace {

std::string_view post_hoc_name(PostHoc post_hoc) noexcept {
  constexpr auto kWords = words<PostHoc>({{"paired t, Holm over the contrasts", PostHoc::holm_t},
                                          {"Games-Howell", PostHoc::games_howell},
                                          {"Tukey", PostHoc::tukey},
                                          {"Wilcoxon signed ranks, Holm over the contrasts", PostHoc::wilcoxon}});
  return word_of(kWords, post_hoc);
}

Block contrasts_block(const StudyResults& results, const Protocol& protocol) {
  using R = ContrastRow;
  using F = Field<R>;
  const PostHoc test = protocol.analysis.tests.post_hoc;
  Fields<R> fields = {condition_field<R>(
                          protocol, [](const R& r) { return r.a; }, "a"),
                      condition_field<R>(
                          protocol, [](const R& r) { return r.b; }, "b"),
                      kind_field<R>(results.attendance.kind),
                      common<R>("outcome", &R::outcome),
                      common<R>("standard", &R::standard),
                      common<R>("title", &R::title, {.title = "scale"}),
                      common<R>("unit", &R::unit),
                      common<R>("registered", &R::registered, {.levels = "0 1"}),
                      common<R>("participants", &R::participants)};
  add_mean_fields(
      fields, [](const R& r) -> const MeanEstimate& { return r.difference; }, "mean_difference");
  fields.push_back(common<R>("p", &R::p, {.shown = Shown::p_value}));
  fields.push_back(F("p_registered",
                     "p by the registered test, corrected as registered; empty where not registered or refused",
                     &R::p_registered, {.title = "p registered", .shown = Shown::p_value}));
  fields.push_back(common<R>("test",
                             [test](const R& r) {
                               return std::isnan(r.p_registered)        ? std::string_view()
                                      : r.outcome == kHierarchicalScale ? kHierarchicalTest
                                                                        : to_string(test);
                             },
                             {.levels = "holm-t wilcoxon games-howell tukey hierarchical-lr-holm"}));
  fields.push_back(common<R>("refused", &R::refused));
  if (!results.task.cells.empty()) {
    fields.push_back(common<R>("difference_source", &R::difference_source, {.levels = "nominal delivered mixed"}));
    // Of one model of everybody there is no d' of a participant behind the difference.
    const auto of_pairs = [](auto word) {
      return [word](const R& r) { return r.outcome == kHierarchicalScale ? std::string() : std::string(word); };
    };
    fields.push_back(common<R>("model", of_pairs(protocol.analysis.model)));
    fields.push_back(common<R>("correction", of_pairs(protocol.analysis.correction)));
    fields.push_back(common<R>("method", of_pairs(to_string(results.task.pairs.method.method))));
  }
  fields.push_back(protocol_field<R>(protocol));
  // Slopes are small numbers: people read them per step of the difference.
  const int step = slope_step(protocol);
  const std::string slope = fmt::format("d' per {} {}", step, to_string(protocol.stimulus.unit));
  const auto scale = [slope](const R& r) {
    return r.outcome == "slope" ? slope : r.title + (r.unit.empty() ? "" : ", " + r.unit);
  };
  fields.push_back(
      F("scale", "", [scale](const R& r) { return scale(r) + (r.registered ? " *" : ""); }, {.place = Place::table}));
  for (const auto& [key, member] :
       {std::pair("difference", &MeanEstimate::mean), {"low", &MeanEstimate::ci_low}, {"high", &MeanEstimate::ci_high}})
    fields.push_back(
        F(key, "",
          [step, member = member](const R& r) { return (r.outcome == "slope" ? step : 1) * r.difference.*member; },
          {.place = Place::table}));
  const bool hierarchical = protocol.analysis.hierarchical;
  const std::string tests = hierarchical ? "likelihood ratio in the hierarchical model, Holm over the contrasts"
                                         : std::string(post_hoc_name(test));
  Block block;
  block.id = "contrasts";
  block.section = Section::tests;
  block.title = "Registered contrasts";
  block.note = fmt::format(
      "a - b within participants with Student's interval and its p{}, each row on one scale; p registered: {}, on the "
      "registered scale (*)",
      hierarchical ? ", of the hierarchical model with its profile interval" : "", tests);
  block.columns = {share("a", "b", "contrast", " - "),
                   {"scale"},
                   share("n", "participants", "n"),
                   {"difference"},
                   range("low", "high"),
                   {"p"},
                   {"p_registered"}};
  block.answer.columns = block.columns;
  block.answer.columns.erase(block.answer.columns.begin() + 1);
  block.answer.only = "registered";
  if (!results.contrasts.empty()) block.answer.title = "Registered contrasts: " + scale(results.contrasts.front());
  block.answer.note = fmt::format("{}; p registered: {}",
                                  hierarchical ? "ln of the ratio of JNDs with its profile interval and its p"
                                               : "paired differences with Student's interval and its p",
                                  tests);
  std::vector<std::string> refused;
  for (const ContrastRow& row : results.contrasts)
    if (!row.refused.empty() && std::find(refused.begin(), refused.end(), row.refused) == refused.end())
      refused.push_back(row.refused);
  for (const std::string& why : refused) block.footnotes.push_back("no test: " + why);
  return std::move(block.with(fields, results.contrasts));
}

// Condition x series.
struct SeriesEffectRow {
  const char* effect;
  const TwoWayEffect* tested;  // null where there is no test
  const SeriesComparison* of;
};

Block series_block(const SeriesComparison& series, const Protocol& protocol) {
  using R = SeriesEffectRow;
  using F = Field<R>;
  const auto of = [](double WithinEffect::*member) {
    return [member](const R& r) { return r.tested == nullptr ? kNaN : r.tested->effect.*member; };
  };
  const Fields<R> fields = {
      F("effect", "what is tested: group, condition, series, or whether the effect of one depends on another",
        &R::effect),
      common<R>("n", [](const R& r) { return r.of->n; }),
      common<R>("participants", [](const R& r) { return r.of->n + static_cast<int>(r.of->left_out.size()); }),
      F("f", "F of that effect", of(&WithinEffect::f), {.title = "F"}),
      F("df1", "degrees of freedom of f", of(&WithinEffect::df1)),
      F("df2", "those of the error of f", of(&WithinEffect::df2)),
      common<R>("p", of(&WithinEffect::p), {.shown = Shown::p_value}),
      F("p_gg", "that p with Greenhouse and Geisser's correction; empty of the groups", of(&WithinEffect::p_gg),
        {.title = "p(GG)", .shown = Shown::p_value}),
      F("p_hf", "that p with Huynh and Feldt's; empty of the groups", of(&WithinEffect::p_hf),
        {.title = "p(HF)", .shown = Shown::p_value}),
      F("epsilon_gg", "Greenhouse and Geisser's epsilon of what is within participants", of(&WithinEffect::epsilon_gg)),
      F("eta2_generalised", "generalised eta squared of the effect",
        [](const R& r) { return r.tested == nullptr ? kNaN : r.tested->eta2_generalised; }, {.title = "eta2 g"}),
      F("eta2_partial", "partial eta squared of the effect", of(&WithinEffect::eta2_partial), {.title = "eta2 p"}),
      common<R>("refused", [](const R& r) { return r.of->refused; }),
      common<R>("status", [](const R& r) {
        return r.tested == nullptr ? "refused" : std::string(to_text(r.tested->effect.status));
      })};
  std::vector<R> rows;
  if (series.refused.empty())
    rows = {{"condition", &series.test.a, &series},
            {"series", &series.test.b, &series},
            {"condition x series", &series.test.ab, &series}};
  else
    rows = {{"condition x series", nullptr, &series}};
  Block block;
  block.id = "condition_by_series";
  block.section = Section::tests;
  block.title = "Condition x series";
  block.note = fmt::format(
      "yes-no d' of {} rates, both factors within participants; does the effect of a condition depend on the series?",
      protocol.analysis.correction);
  for (const LeftOut& one : series.left_out)
    block.footnotes.push_back(fmt::format("left out: {} ({})", one.participant, one.reason));
  block.columns = {{"effect"}, share("n", "participants", "n")};
  if (series.refused.empty())
    block.columns.insert(
        block.columns.end(),
        {{"f"}, share("df1", "df2", "df", ", "), {"p"}, {"p_gg"}, {"eta2_generalised"}, {"eta2_partial"}});
  block.columns.push_back({"refused", {}, {}, "no test"});
  return std::move(block.with(fields, std::move(rows)));
}

}  // namespace

Blocks test_blocks(const StudyResults& results, const Protocol& protocol) {
  std::vector<std::string> conditions;
  for (const Condition& condition : protocol.conditions) conditions.push_back(condition.name);
  Blocks blocks;
  if (!results.contrasts.empty()) blocks.push_back(contrasts_block(results, protocol));
  const auto add = [&blocks](std::vector<Block> more) {
    for (Block& block : more) blocks.push_back(std::move(block));
  };
  if (results.groups) add(group_comparison_blocks(*results.groups, group_names(protocol), conditions));
  if (!results.comparisons.empty())
    add(comparison_blocks(results.comparisons, conditions,
                          protocol.groups.empty() ? std::vector<std::string>() : group_names(protocol)));
  if (!results.task.cells.empty() && protocol.conditions.size() > 1 && protocol.series.size() > 1)
    blocks.push_back(series_block(results.by_series, protocol));
  return blocks;
}

}  // namespace jnd
