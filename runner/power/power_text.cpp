#include "runner/power/power_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "data/fields/csv_writer.h"
#include "data/fields/number_text.h"
#include "protocols/planning/allotment.h"
#include "protocols/tasks/level_source.h"
#include "protocols/version.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;
using Align = TextTable::Align;

std::string word(PowerAnalysis analysis) {
  return std::string(word_of(kPowerAnalysisWords, analysis));
}

std::string amount_text(double value) {
  if (std::isnan(value)) return "-";
  return std::isinf(value) ? "inf" : fmt::format("{:.3g}", value);
}

std::string with_error(const Simulated& number) {
  if (std::isnan(number.value)) return "-";
  if (std::isnan(number.error) || std::isinf(number.value)) return amount_text(number.value);
  return fmt::format("{} ± {}", amount_text(number.value), fmt::format("{:.1g}", number.error));
}

std::string trials_text(const PowerDesign& design) {
  return design.trials > 0 ? std::to_string(design.trials) : "-";
}

// The cells that every table begins with, and their headers.
std::vector<std::string> design_cells(const PowerDesign& design) {
  return {std::to_string(design.participants), trials_text(design), fmt::format("{:g}", design.effect)};
}
const std::vector<std::string> kDesignHeader = {"people", "trials", "effect"};
const std::vector<Align> kDesignAlign(3, Align::right);

template <typename Value>
std::vector<Value> joined(std::vector<Value> first, const std::vector<Value>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

// A blank line where the design of a row is another one than that of the row before.
class DesignRules {
 public:
  explicit DesignRules(TextTable& table) : table_(table) {}
  void next(const PowerDesign& design) {
    const std::vector<std::string> cells = design_cells(design);
    if (!before_.empty() && before_ != cells) table_.rule();
    before_ = cells;
  }

 private:
  TextTable& table_;
  std::vector<std::string> before_;
};

std::string scale_of(PowerAnalysis analysis, const PowerResult& result, std::size_t contrast) {
  return contrast_scale(analysis, result.protocol, contrast >= result.question.contrasts.size());
}

// "; JND times 1.4 in patients": groups, and how they differ; empty without groups.
std::string groups_text(const PowerResult& result) {
  const Protocol& protocol = result.protocol;
  if (protocol.groups.empty()) return "";
  std::string differ;
  for (std::size_t g = 0; g < result.question.group_factors.size(); ++g) {
    const std::vector<double>& factors = result.question.group_factors[g];
    const bool alike = std::all_of(factors.begin(), factors.end(), [&](double one) { return one == factors.front(); });
    const auto add = [&](double factor, const std::string& of) {
      if (factor != 1) differ += fmt::format("{}times {:g} in {}", differ.empty() ? "" : ", ", factor, printable(of));
    };
    if (alike && !factors.empty()) add(factors.front(), protocol.groups[g].name);
    for (const int c : conditions_of(protocol, static_cast<int>(g)))
      if (!alike)
        add(factors[static_cast<std::size_t>(c)], protocol.groups[g].name + "/" + condition_name(protocol, c));
  }
  return fmt::format("; groups {}{}", fmt::join(group_names(protocol), ", "),
                     result.question.profile ? ""
                     : differ.empty()        ? " alike"
                                             : ": JND " + differ);
}

std::string people_text(const PowerResult& result) {
  const PowerQuestion& question = result.question;
  if (question.profile)
    return fmt::format("participants simulated through the rig at 1 kHz, profile {}{}", printable(*question.profile),
                       question.people.drop_out > 0
                           ? fmt::format("; {} drop out", percent_text(question.people.drop_out))
                           : "") +
           groups_text(result);
  const Population& people = question.people;
  const ResponseModel model = response_model_of(result.protocol).value();
  std::string text = fmt::format("answers drawn from the response model ({}); JND of the median person",
                                 model == ResponseModel::choice         ? "choices, probit"
                                 : model == ResponseModel::differencing ? "differencing"
                                                                        : "yes-no");
  for (std::size_t c = 0; c < question.jnds.size(); ++c)
    text +=
        fmt::format("{} {} {:.4g}", c == 0 ? "" : ",", printable(result.protocol.conditions[c].name), question.jnds[c]);
  text += fmt::format("; between people CV {:.0f} %, of a condition within a person {:.0f} %; criterion {:g}, SD {:g}",
                      100 * people.between_cv, 100 * people.interaction_cv, people.criterion, people.criterion_sd);
  if (people.lapse > 0) text += fmt::format("; lapses {}", percent_text(people.lapse));
  if (people.drop_out > 0) text += fmt::format("; {} drop out", percent_text(people.drop_out));
  return text + groups_text(result);
}

bool any_effect(const PowerQuestion& question) {
  return question.effects.size() != 1 || question.effects.front() != 1;
}

std::string power_table(const PowerResult& result, const std::vector<ContrastSummary>& rows) {
  const std::size_t analyses = result.question.analyses.size();
  std::vector<std::string> header = joined(kDesignHeader, {"contrast", "true ratio"});
  std::vector<Align> align = joined(kDesignAlign, {Align::left, Align::right});
  for (const PowerAnalysis one : result.question.analyses) {
    header.push_back(word(one));
    align.push_back(Align::right);
  }
  TextTable table(header, align);
  DesignRules rules(table);
  for (std::size_t i = 0; i < rows.size(); i += analyses) {
    rules.next(rows[i].design);
    std::vector<std::string> cells =
        joined(design_cells(rows[i].design), {printable(contrast_name(result, rows[i].contrast)),
                                              std::isnan(rows[i].ratio) ? "-" : fmt::format("{:.3f}", rows[i].ratio)});
    for (std::size_t a = 0; a < analyses; ++a) cells.push_back(share_text(rows[i + a].power));
    table.add(cells);
  }
  return table.text();
}

std::string estimate_table(const PowerResult& result, const std::vector<ContrastSummary>& rows) {
  TextTable table(joined(kDesignHeader, {"contrast", "analysis", "scale", "bias", "half width", "coverage", "no test"}),
                  joined(kDesignAlign, {Align::left, Align::left, Align::left, Align::right, Align::right, Align::right,
                                        Align::right}));
  DesignRules rules(table);
  for (const ContrastSummary& row : rows) {
    rules.next(row.design);
    table.add(joined(design_cells(row.design), {printable(contrast_name(result, row.contrast)), word(row.analysis),
                                                scale_of(row.analysis, result, row.contrast),
                                                with_error(row.estimate.bias), with_error(row.estimate.half_width),
                                                share_text(row.estimate.coverage), share_text(row.untested)}));
  }
  return table.text();
}

std::string group_table(const PowerResult& result) {
  TextTable table(joined(kDesignHeader, {"condition", "analysis", "RMSE", "bias", "half width", "coverage", "no JND"}),
                  joined(kDesignAlign, {Align::left, Align::left, Align::right, Align::right, Align::right,
                                        Align::right, Align::right}));
  DesignRules rules(table);
  for (const GroupSummary& row : group_summaries(result)) {
    rules.next(row.design);
    table.add(joined(design_cells(row.design),
                     {printable(result.protocol.conditions[row.condition].name), word(row.analysis),
                      with_error(row.estimate.rmse), with_error(row.estimate.bias), with_error(row.estimate.half_width),
                      share_text(row.estimate.coverage), share_text(row.estimate.undefined)}));
  }
  return table.text();
}

std::string studies_table(const PowerResult& result) {
  TextTable table(joined(kDesignHeader, {"analysis", "something undefined", "some contrast", "every contrast"}),
                  joined(kDesignAlign, {Align::left, Align::right, Align::right, Align::right}));
  DesignRules rules(table);
  for (const StudySummary& row : study_summaries(result)) {
    rules.next(row.design);
    table.add(joined(design_cells(row.design),
                     {word(row.analysis), share_text(row.undefined), share_text(row.any), share_text(row.all)}));
  }
  return table.text();
}

std::string smallest_text(const PowerResult& result) {
  const std::vector<SmallestDesign> smallest = smallest_designs(result);
  if (smallest.empty()) return "";
  TextTable table({"effect", "contrast", "analysis", "people", "trials", "power"},
                  {Align::right, Align::left, Align::left, Align::right, Align::right, Align::right});
  for (const SmallestDesign& one : smallest)
    table.add({fmt::format("{:g}", one.effect), printable(contrast_name(result, one.contrast)), word(one.analysis),
               one.design ? std::to_string(one.design->design.participants) : "none",
               one.design ? trials_text(one.design->design) : "", one.design ? share_text(one.design->power) : ""});
  return fmt::format(
      "\n{}\n{}",
      bold(fmt::format("The smallest of these designs with a power of {:.0f} %, even at the low end of its interval",
                       100 * result.question.wanted)),
      table.text());
}

std::string analyses_text(const PowerResult& result) {
  std::string text;
  for (const PowerAnalysis one : result.question.analyses) {
    switch (one) {
      case PowerAnalysis::registered:
        text += "registered: the protocol's JNDs, their mean, and its tests of its contrasts.\n";
        break;
      case PowerAnalysis::median:
        text +=
            "median: of the registered JNDs, with order statistics for an interval; Wilcoxon's test of the slopes, Holm.\n";
        break;
      case PowerAnalysis::log_ml:
        text +=
            "log-ml: a JND of each participant by maximum likelihood, the mean of the logarithms; paired t, Holm.\n";
        break;
      case PowerAnalysis::hierarchical:
        text += "hierarchical: one model of everybody's answers; likelihood-ratio tests, Holm.\n";
        break;
    }
  }
  if (result.question.group_tests.empty()) return text;
  const bool mixed = result.protocol.analysis.tests.between == BetweenTest::mixed_anova;
  text +=
      fmt::format("Groups: registered by {}; {}; hierarchical has no test of groups.\n",
                  to_string(result.protocol.analysis.tests.between),
                  mixed ? "log-ml by the same of the logarithms, median has no such test"
                        : "median by Mann and Whitney's test of the slopes, log-ml by Welch's of the logarithms; Holm");
  return text;
}

}  // namespace

std::string power_text(const PowerResult& result) {
  const std::vector<ContrastSummary> rows = contrast_summaries(result);
  std::string text =
      fmt::format("{}\n{} of each design, seed {}; {}.\n", bold(printable(result.protocol.title)),
                  result.tally.studies == 1 ? "1 study" : fmt::format("{} studies", result.tally.studies),
                  result.question.seed, people_text(result));
  text += analyses_text(result);
  text += fmt::format("\n{}\n",
                      bold(fmt::format("Power at {:g}, and what the number of studies leaves open (95 %){}",
                                       result.protocol.analysis.tests.alpha,
                                       any_effect(result.question) ? "; of effect 0 the rate of false findings" : "")));
  text += power_table(result, rows);
  text += smallest_text(result);
  text += fmt::format("\n{}\n{}", bold("Contrasts: bias, median half width and coverage of the 95 % interval"),
                      estimate_table(result, rows));
  text += fmt::format("\n{}\n{}", bold("JND of the group: errors and half widths of ln JND"), group_table(result));
  text += fmt::format("\n{}\n{}", bold("Studies with something undefined, and with findings"), studies_table(result));
  text +=
      "trials: of a cell. effect: how far apart the true JNDs are, 0 not at all, 1 as planned.\n"
      "In parentheses: exact 95 % interval of a share; more studies narrow it. ±: Monte-Carlo error.\n"
      "Every design has the same people, as far as they go (common random numbers).\n";
  return text;
}

namespace {

ordered_json simulated_json(const Simulated& number) {
  ordered_json out = {{"value", json_number(number.value)}, {"mc_error", json_number(number.error)}};
  if (!std::isnan(number.low)) out["ci95"] = {number.low, number.high};
  return out;
}

ordered_json design_json(const PowerDesign& design) {
  return {{"participants", design.participants},
          {"trials", design.trials > 0 ? ordered_json(design.trials) : ordered_json(nullptr)},
          {"effect", design.effect}};
}

void add_estimate(ordered_json& row, const EstimateSummary& estimate) {
  row["truth"] = json_number(estimate.truth);
  row[std::isnan(estimate.truth) ? "mean" : "bias"] = simulated_json(estimate.bias);
  row["rmse"] = simulated_json(estimate.rmse);
  row["half_width"] = simulated_json(estimate.half_width);
  row["coverage"] = simulated_json(estimate.coverage);
  row["undefined"] = simulated_json(estimate.undefined);
}

}  // namespace

ordered_json power_json(const PowerResult& result) {
  ordered_json out = {{"protocol", result.protocol.name},
                      {"protocol_sha256", result.protocol.sha256},
                      {"question", to_json(result.question)},
                      {"alpha", result.protocol.analysis.tests.alpha},
                      {"studies", result.tally.studies}};
  ordered_json contrasts = ordered_json::array(), group = contrasts, studies = contrasts, smallest = contrasts;
  for (const ContrastSummary& one : contrast_summaries(result)) {
    ordered_json row = design_json(one.design);
    row["analysis"] = word(one.analysis);
    row["contrast"] = contrast_name(result, one.contrast);
    row["true_ratio"] = json_number(one.ratio);
    row["scale"] = scale_of(one.analysis, result, one.contrast);
    row["power"] = simulated_json(one.power);
    row["untested"] = simulated_json(one.untested);
    add_estimate(row, one.estimate);
    contrasts.push_back(std::move(row));
  }
  for (const GroupSummary& one : group_summaries(result)) {
    ordered_json row = design_json(one.design);
    row["analysis"] = word(one.analysis);
    row["condition"] = result.protocol.conditions[one.condition].name;
    add_estimate(row, one.estimate);
    group.push_back(std::move(row));
  }
  for (const StudySummary& one : study_summaries(result)) {
    ordered_json row = design_json(one.design);
    row["analysis"] = word(one.analysis);
    row["undefined"] = simulated_json(one.undefined);
    row["some_contrast"] = simulated_json(one.any);
    row["every_contrast"] = simulated_json(one.all);
    studies.push_back(std::move(row));
  }
  for (const SmallestDesign& one : smallest_designs(result)) {
    ordered_json row = {
        {"effect", one.effect}, {"contrast", contrast_name(result, one.contrast)}, {"analysis", word(one.analysis)}};
    row["design"] = one.design ? design_json(one.design->design) : ordered_json(nullptr);
    smallest.push_back(std::move(row));
  }
  out["contrasts"] = std::move(contrasts);
  out["group"] = std::move(group);
  out["whole_studies"] = std::move(studies);
  out["smallest"] = std::move(smallest);
  return out;
}

std::string power_csv(const PowerResult& result) {
  std::string text = csv_line({"participants", "trials", "effect", "analysis", "of", "name", "number", "value",
                               "mc_error", "ci95_low", "ci95_high"});
  const auto add = [&](const PowerDesign& design, PowerAnalysis analysis, const char* of, const std::string& name,
                       const char* number, const Simulated& value) {
    text += csv_line({csv_number(design.participants), design.trials > 0 ? csv_number(design.trials) : "",
                      csv_number(design.effect), word(analysis), of, csv_text(name), number, csv_number(value.value),
                      csv_number(value.error), csv_number(value.low), csv_number(value.high)});
  };
  const auto add_all = [&](const auto& row, const char* of, const std::string& name) {
    const EstimateSummary& estimate = row.estimate;
    add(row.design, row.analysis, of, name, "truth", {.value = estimate.truth});
    add(row.design, row.analysis, of, name, std::isnan(estimate.truth) ? "mean" : "bias", estimate.bias);
    add(row.design, row.analysis, of, name, "rmse", estimate.rmse);
    add(row.design, row.analysis, of, name, "half_width", estimate.half_width);
    add(row.design, row.analysis, of, name, "coverage", estimate.coverage);
    add(row.design, row.analysis, of, name, "undefined", estimate.undefined);
  };
  for (const ContrastSummary& row : contrast_summaries(result)) {
    const std::string name = contrast_name(result, row.contrast);
    add(row.design, row.analysis, "contrast", name, "true_ratio", {.value = row.ratio});
    add(row.design, row.analysis, "contrast", name, "power", row.power);
    add(row.design, row.analysis, "contrast", name, "untested", row.untested);
    add_all(row, "contrast", name);
  }
  for (const GroupSummary& row : group_summaries(result))
    add_all(row, "condition", result.protocol.conditions[row.condition].name);
  for (const StudySummary& row : study_summaries(result)) {
    add(row.design, row.analysis, "study", "", "undefined", row.undefined);
    add(row.design, row.analysis, "study", "", "some_contrast", row.any);
    add(row.design, row.analysis, "study", "", "every_contrast", row.all);
  }
  return text;
}

std::string ademp_text(const PowerResult& result) {
  const PowerQuestion& question = result.question;
  std::vector<std::string> contrasts, analyses;
  for (std::size_t i = 0; i < question.tests(); ++i) contrasts.push_back(contrast_name(result, i));
  std::string methods = analyses_text(result);
  while (!methods.empty() && methods.back() == '\n') methods.pop_back();
  for (std::size_t at = methods.find('\n'); at != std::string::npos; at = methods.find('\n', at))
    methods.replace(at, 1, "<br>");
  const std::string trials = question.trials.empty()
                                 ? "as many as the procedure asks"
                                 : fmt::format("{} trials of a cell", fmt::join(question.trials, ", "));
  std::string text = fmt::format("# Simulation study: {}\n\n", result.protocol.title);
  text += "| | |\n|---|---|\n";
  text += fmt::format(
      "| **Aims** | Power and precision of the contrasts {}, by design and analysis; how often something is undefined |\n",
      fmt::join(contrasts, ", "));
  text += fmt::format(
      "| **Data-generating mechanisms** | {} participants; {}; {} with the effects {} (0: equal JNDs; 1: as planned); {}. "
      "{} studies of each design, seed {}; the same participants in every design |\n",
      fmt::join(question.participants, ", "), trials, level_words(result.protocol), fmt::join(question.effects, ", "),
      people_text(result), result.tally.studies, question.seed);
  text += fmt::format(
      "| **Estimands** | The JND of each condition (of the median person; for the registered mean the mean over people), and each contrast on the scale of its analysis ({}) |\n",
      scale_of(PowerAnalysis::registered, result, 0));
  text += fmt::format("| **Methods** | {} |\n", methods);
  text += fmt::format(
      "| **Performance measures** | Power (share of all studies with p below {:g}; a study without a test counts as not significant), bias and root mean square error, coverage and median "
      "half width of 95 % intervals, share of studies with undefined values; shares with their exact 95 % interval, the others with their Monte-Carlo error |\n",
      result.protocol.analysis.tests.alpha);
  text += fmt::format("\njnd {}, protocol {} ({})\n", kVersion, result.protocol.name, result.protocol.sha256);
  return text;
}

}  // namespace jnd
