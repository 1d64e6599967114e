// The same under other models, methods and corrections.
#include <algorithm>

#include <fmt/format.h>

#include "data/blocks/common_fields.h"
#include "data/blocks/detection_fields.h"
#include "data/blocks/result_blocks.h"
#include "data/fields/number_text.h"

namespace jnd {

namespace {

// Of models that work on the raw counts there is no correction.
std::string rates_name(const ThresholdMethod& method) {
  return method.correction == Correction::none ? "raw" : std::string(to_string(method.correction));
}

// A method and condition.
struct MethodRow {
  const SensitivityRow* of;
  const TaskGroupRow* group;
  std::size_t number;  // of the method, from 1
};

std::string median_text(const TaskGroupRow& row) {
  if (row.median_n == 0) return "no_information";
  if (row.middle == Beyond::below) return "ceiling";
  return number_text(row.median, decimals_of_size(row.median));
}

Block sensitivity_block(const StudyResults& results, const Protocol& protocol) {
  using R = MethodRow;
  using F = Field<R>;
  const std::string unit(to_string(protocol.stimulus.unit));
  Fields<R> fields = {
      F("number", "number of the method; 1 is the registered one", [](const R& r) { return r.number; },
        {.title = "no."}),
      common<R>("model", [](const R& r) { return r.of->method.model; },
                {.levels = "yes-no differencing independent-observation"}),
      common<R>("correction", [](const R& r) { return r.of->method.correction; }, {.levels = "none loglinear half"}),
      common<R>("method", [](const R& r) { return r.of->method.method; }),
      common<R>("registered", [](const R& r) { return r.of->registered; }, {.levels = "0 1"}),
      condition_field<R>(protocol, [](const R& r) { return r.group->condition; }),
      common<R>("median", [](const R& r) { return r.group->median; }, {.unit = unit}),
      common<R>("mean", [](const R& r) { return r.group->mean.mean; }, {.unit = unit}),
      common<R>("n", [](const R& r) { return r.group->mean.n; }),
      F("n_tested", "participants in the tests", [](const R& r) { return r.of->n; }),
      common<R>("participants", [](const R& r) { return r.of->participants; }),
      F("omnibus_p", "p of the registered test over all conditions; empty where refused",
        [](const R& r) { return r.of->omnibus_p; }, {.title = "omnibus p", .shown = Shown::p_value}),
      F("same_conclusion", "1 where every registered test decides as under the registered method",
        [](const R& r) { return r.of->same_conclusion; }, {.levels = "0 1"}),
      common<R>("refused", [](const R& r) { return r.of->refused; })};
  std::vector<TableColumn> contrasts;
  for (std::size_t i = 0; i < protocol.analysis.contrasts.size(); ++i) {
    const Contrast& contrast = protocol.analysis.contrasts[i];
    const std::string a = condition_of(protocol, contrast.a), b = condition_of(protocol, contrast.b);
    const std::string key = fmt::format("p_{}_{}", a, b), title = fmt::format("p {} - {}", a, b);
    fields.push_back(F(key, "p of that registered contrast, adjusted as registered",
                       [i](const R& r) { return r.of->contrast_p[i]; }, {.title = title, .shown = Shown::p_value}));
    fields.push_back(F(fmt::format("difference_{}_{}", a, b),
                       "mean of a - b of that contrast, on the scale of the tests",
                       [i](const R& r) { return r.of->contrast_slope[i]; }));
    contrasts.push_back({key});
  }
  fields.push_back(F("rates", "", [](const R& r) { return rates_name(r.of->method); }, {.place = Place::table}));
  fields.push_back(F("median_words", "", [](const R& r) { return median_text(*r.group); },
                     {.title = fmt::format("median JND {}", unit), .place = Place::table}));
  fields.push_back(F("conclusion", "",
                     [](const R& r) {
                       return r.of->registered         ? "registered"
                              : !r.of->refused.empty() ? "no test"
                              : r.of->same_conclusion  ? "the same"
                                                       : "DIFFERENT";
                     },
                     {.place = Place::table}));
  std::vector<R> rows;
  for (const SensitivityRow& row : results.sensitivity)
    for (const TaskGroupRow& group : row.group)
      rows.push_back({&row, &group, static_cast<std::size_t>(&row - results.sensitivity.data()) + 1});
  Block block;
  block.id = "sensitivity";
  block.section = Section::models;
  block.title = "Would another method change the conclusion?";
  block.note = fmt::format(
      "median JND (no sensitivity counts as infinite; ceiling: below what was tested); tests on the {} as registered, alpha = "
      "{:g}; models measure d' differently: JNDs of different models are not comparable{}",
      results.registered()->title, protocol.analysis.tests.alpha,
      protocol.analysis.hierarchical
          ? "; the contrasts are registered by the hierarchical model, and stand here by separate values"
          : "");
  block.columns = {{"number"},
                   {"model"},
                   {"rates"},
                   {"method"},
                   {"condition"},
                   {"median_words"},
                   share("n_tested", "participants", "n"),
                   {"omnibus_p"}};
  block.columns.insert(block.columns.end(), contrasts.begin(), contrasts.end());
  block.columns.push_back({"conclusion"});
  return std::move(block.with(fields, std::move(rows)));
}

Block models_block(const StudyModels& models, const Protocol& protocol) {
  using R = ThresholdModel;
  using F = Field<R>;
  const std::string unit(to_string(protocol.stimulus.unit));
  const auto of = [](auto member) { return [member](const R& r) { return r.jnd.*member; }; };
  const auto quality = [](double FitQuality::*member) {
    return [member](const R& r) { return r.quality ? std::optional((*r.quality).*member) : std::nullopt; };
  };
  const std::string slope = fmt::format("d' per {} {}", slope_step(protocol), unit);
  Fields<R> fields = {
      common<R>("participant", &R::participant),
      condition_field<R>(protocol, [](const R& r) { return r.condition; }),
      common<R>("model", [](const R& r) { return r.method.model; },
                {.levels = "yes-no differencing independent-observation"}),
      common<R>("correction", [](const R& r) { return r.method.correction; }, {.levels = "none loglinear half"}),
      common<R>("method", [](const R& r) { return r.method.method; }),
      common<R>("slope", of(&JndEstimate::slope),
                {.title = slope, .factor = static_cast<double>(slope_step(protocol))}),
      common<R>("jnd", of(&JndEstimate::jnd), {.unit = unit, .title = "JND"}),
      common<R>("ci_low", of(&JndEstimate::ci_low), {.unit = unit}),
      common<R>("ci_high", of(&JndEstimate::ci_high), {.unit = unit}),
      common<R>("weber", of(&JndEstimate::weber), {.title = "Weber", .shown = Shown::percent}),
      common<R>("status", of(&JndEstimate::status), {.levels = "ok no_sensitivity ceiling no_information"}),
      common<R>("log_likelihood", of(&JndEstimate::log_likelihood)),
      F("fit.status", "whether the deviance says anything: too few trials leave chi-square without meaning",
        [](const R& r) { return r.quality ? std::optional(r.quality->status) : std::nullopt; }),
      F("fit.deviance", "deviance of the fit against a rate for each class of each series",
        quality(&FitQuality::deviance)),
      F("fit.df", "degrees of freedom of fit_deviance",
        [](const R& r) { return r.quality ? std::optional(r.quality->degrees_of_freedom) : std::nullopt; }),
      F("fit.p", "chi-square p of fit_deviance; empty unless fit_status is ok", quality(&FitQuality::deviance_p),
        {.title = "deviance p", .shown = Shown::p_value}),
      F("rates", "", [](const R& r) { return rates_name(r.method); }, {.place = Place::table})};
  add_group_field(fields, protocol, [](const R& r) { return r.group; });
  Block block;
  block.id = "models";
  block.section = Section::models;
  block.title = "Every model";
  block.note =
      fmt::format("JND in {}; 95 % CI of the same method; deviance p against a rate for each class and series", unit);
  if (std::any_of(models.thresholds.begin(), models.thresholds.end(),
                  [](const R& one) { return one.quality && one.quality->status == FitStatus::few_trials; }))
    block.footnotes = {
        "deviance p is empty where too few trials per class and series leave chi-square without meaning; jnd calc jnd "
        "--bootstrap draws one"};
  block.columns = {{"participant"}, {"condition"}, {"model"}, {"rates"},
                   {"method"},      {"slope"},     {"jnd"},   range("ci_low", "ci_high"),
                   {"weber"},       {"fit.p"},     {"status"}};
  return std::move(block.with(fields, models.thresholds));
}

// Without a table: jnd calc sdt prints one.
Block model_cells_block(const StudyModels& models, const Protocol& protocol) {
  using R = CellModel;
  Fields<R> fields = {
      common<R>("participant", &R::participant), condition_field<R>(protocol, [](const R& r) { return r.condition; }),
      common<R>("series",
                [&protocol](const R& r) { return protocol.series[static_cast<std::size_t>(r.series)].name; })};
  add_detection_fields(fields, &R::row);
  Block block;
  block.id = "model_cells";
  block.section = Section::models;
  return std::move(block.with(fields, models.cells));
}

}  // namespace

Blocks model_blocks(const StudyResults& results, const Protocol& protocol, const StudyModels* models) {
  Blocks blocks;
  if (!results.sensitivity.empty()) blocks.push_back(sensitivity_block(results, protocol));
  if (models != nullptr && !models->thresholds.empty()) blocks.push_back(models_block(*models, protocol));
  if (models != nullptr && !models->cells.empty()) blocks.push_back(model_cells_block(*models, protocol));
  return blocks;
}

}  // namespace jnd
