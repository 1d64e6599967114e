#include "data/methods_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/blinding.h"
#include "data/questionnaire_methods.h"
#include "protocols/version.h"

namespace jnd {

namespace {

std::string_view unit_of(const Protocol& protocol) {
  return to_string(protocol.stimulus.unit);
}

std::string list_of(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i)
    text += (i == 0 ? "" : i + 1 == items.size() ? " and " : ", ") + items[i];
  return text;
}

std::string design_paragraph(const Protocol& protocol, const StudyResults& results) {
  std::vector<std::string> conditions, pairs;
  for (const Condition& one : protocol.conditions) conditions.push_back(fmt::format("{} ({})", one.name, one.label));
  for (const Series& one : protocol.series) pairs.push_back(fmt::format("{:g} and {:g}", one.pair[0], one.pair[1]));
  const Design& design = protocol.design;
  if (design.procedure)
    return fmt::format(
        "{} {} participant{} compared pairs of stimuli that differed in stiffness (same-different, two intervals) "
        "under {} "
        "feedback condition{}: {}. The answers set the difference from the reference of {:g} {}: {} track{} a "
        "condition, "
        "differences from {:g} to {:g}, {:.0f} % catch trials (equal pairs, which move nothing), balanced in short "
        "blocks. "
        "The order of conditions, tracks and catch trials was drawn per participant from the study's seed with "
        "counter-based random streams (Philox4x32, Salmon et al. 2011). Practice trials took no part in any number "
        "below.\n",
        results.analysis.participants, to_string(results.analysis.kind), results.analysis.participants == 1 ? "" : "s",
        protocol.conditions.size(), protocol.conditions.size() == 1 ? "" : "s", list_of(conditions),
        protocol.stimulus.reference, unit_of(protocol), design.procedure->starts.size(),
        design.procedure->starts.size() == 1 ? "" : "s", design.procedure->clamp[0], design.procedure->clamp[1],
        100 * design.procedure->catch_share);
  return fmt::format(
      "{} {} participant{} compared pairs of stimuli that differed in stiffness (same-different, two intervals) under "
      "{} "
      "feedback condition{}: {}. The pairs were {} {}. Each cell of condition and series had {} trials; the classes "
      "(same, "
      "different) were {}. The order of conditions, series and trials was drawn per participant from the study's seed "
      "with counter-based random streams (Philox4x32, Salmon et al. 2011). Practice trials took no part in any number "
      "below.\n",
      results.analysis.participants, to_string(results.analysis.kind), results.analysis.participants == 1 ? "" : "s",
      protocol.conditions.size(), protocol.conditions.size() == 1 ? "" : "s", list_of(conditions), list_of(pairs),
      unit_of(protocol), design.trials_per_cell,
      design.sampling == Sampling::balanced ? "balanced within each cell"
                                            : "drawn independently with a probability of one half");
}

std::string correction_words(const Protocol& protocol) {
  const std::string& correction = protocol.analysis.correction;
  if (correction == "loglinear")
    return "Rates were corrected log-linearly, (k + 0.5) / (n + 1), in every cell (Hautus 1995). ";
  if (correction == "half")
    return "Rates of 0 and 1 were replaced by 1/(2n) and 1 - 1/(2n) (Macmillan and Kaplan 1985). ";
  return "Rates were not corrected. ";
}

std::string dprime_words(const std::string& model) {
  if (model == "differencing")
    return "d' is that of the differencing model of same-different (Macmillan and Creelman 2005, chapter 9). ";
  if (model == "independent-observation")
    return "d' is that of the independent-observation model of same-different, unit slope (Macmillan and Creelman "
           "2005, "
           "chapter 9). ";
  return "d' = z(H) - z(F), with H the rate of \"different\" answers to different pairs and F to equal pairs. ";
}

std::string slope_words(const StudyAnalysis& analysis) {
  switch (analysis.method.method) {
    case JndMethod::least_squares:
    case JndMethod::least_squares_independent:
      return "The slope m of d' on the stiffness difference is the least-squares line through the origin over the "
             "series, m "
             "= sum(dK d') / sum(dK^2)";
    case JndMethod::weighted:
      return "The slope m of d' on the stiffness difference is a line through the origin, weighted by 1/se^2 of each "
             "d' "
             "(Gourevitch and Galanter 1967)";
    case JndMethod::inverse_mean_slope:
      return "The slope m is the mean of d'/dK over the series";
    case JndMethod::mean_of_ratios:
      return "The JND is the mean of dK/d' over the series, and m = 1/JND";
    case JndMethod::ml_yes_no_common:
      return "The slope m is the maximum-likelihood estimate over all series, P(\"different\") = Phi(l + m x), with "
             "one "
             "criterion";
    case JndMethod::ml_yes_no_series:
      return "The slope m is the maximum-likelihood estimate over all series, P(\"different\") = Phi(l + m x), with a "
             "criterion for each series";
    case JndMethod::ml_differencing_common:
      return "The slope m is the maximum-likelihood estimate over all series with d' = m dK and one criterion";
    case JndMethod::ml_differencing_series:
      return "The slope m is the maximum-likelihood estimate over all series with d' = m dK and a criterion for each "
             "series";
  }
  return "";
}

std::string interval_words(const StudyAnalysis& analysis) {
  if (is_maximum_likelihood(analysis.method.method))
    return " Intervals of single JNDs are profile-likelihood intervals.";
  if (analysis.method.method == JndMethod::least_squares && analysis.intervals)
    return " Intervals of single JNDs are percentile intervals of a parametric bootstrap (2000 replicates, log-linear "
           "rates; Efron and Tibshirani 1993).";
  return "";
}

std::string adaptive_paragraph(const AdaptiveProcedure& procedure) {
  const double target = 100 * adaptive_target(procedure);
  if (procedure.kind == AdaptiveProcedure::Kind::quest)
    return fmt::format(
        "The threshold is the difference of which \"different\" is said in {:.1f} %: 10 to the mean of the posterior "
        "of its "
        "logarithm after the last trial (QUEST, Watson and Pelli 1983), averaged over the tracks of a condition.\n",
        target);
  return fmt::format(
      "The threshold is the difference of which \"different\" is said in {:.1f} % (Levitt 1971): the mean of the last "
      "{} "
      "reversals of each track, averaged over the tracks of a condition. It moves with the criterion: the rate of "
      "false "
      "alarms on catch trials stands beside it.\n",
      target, procedure.averaged_reversals / 2 * 2);
}

std::string estimate_paragraph(const Protocol& protocol, const StudyResults& results) {
  if (protocol.design.procedure) return adaptive_paragraph(*protocol.design.procedure);
  const StudyAnalysis& analysis = results.analysis;
  return fmt::format(
      "{}{}{}; JND = 1/m, the difference at d' = 1, and the Weber fraction is JND / {:g} {}. Differences are the {} "
      "ones.{} "
      "Estimates with m <= 1e-9 have no JND (status no_sensitivity): means of JNDs leave them out, medians count them "
      "as "
      "infinite; every group number names how many of how many it rests on.\n",
      dprime_words(analysis.method.model), correction_words(protocol), slope_words(analysis),
      protocol.stimulus.reference, unit_of(protocol), to_string(analysis.by), interval_words(analysis));
}

std::string post_hoc_words(PostHoc post_hoc) {
  switch (post_hoc) {
    case PostHoc::holm_t:
      return "paired t tests of the registered contrasts with Holm's correction (Holm 1979)";
    case PostHoc::games_howell:
      return "Games-Howell tests (Games and Howell 1976), which ignore the pairing";
    case PostHoc::tukey:
      return "Tukey's studentised range test with the repeated-measures error term";
    case PostHoc::wilcoxon:
      return "Wilcoxon signed-rank tests of the registered contrasts with Holm's correction";
  }
  return "";
}

std::string test_paragraph(const Protocol& protocol, const OutcomeComparison& outcome) {
  const GroupTestPlan& tests = protocol.analysis.tests;
  std::string text;
  if (tests.omnibus == Omnibus::anova)
    text =
        "Conditions were compared by a one-way repeated-measures analysis of variance with the Greenhouse-Geisser "
        "correction";
  else if (tests.omnibus == Omnibus::friedman)
    text = "Conditions were compared by Friedman's test with the correction for ties";
  else
    text = "Conditions were compared in pairs only";
  text += fmt::format(" on the {} ({} of {} participants), and by {}; alpha = {:g}. ", outcome.outcome, outcome.table.n,
                      outcome.table.n + outcome.left_out.size(), post_hoc_words(tests.post_hoc), tests.alpha);
  text +=
      "Normality: Shapiro-Wilk (Royston 1995); sphericity: Mauchly. Within-participant intervals: Cousineau 2005 with "
      "Morey's correction (2008).";
  if (!outcome.refused.empty()) text += " The registered tests were refused: " + outcome.refused + ".";
  return text + "\n";
}

std::string exclusion_paragraph(const Protocol& protocol, const StudyResults& results) {
  if (protocol.design.procedure)
    return "No answered trial was excluded: an excluded answer would have moved the levels all the same.\n";
  const Exclusions& rules = protocol.analysis.exclude;
  std::vector<std::string> words;
  if (rules.response_time_below_s)
    words.push_back(fmt::format("response times below {:g} s", *rules.response_time_below_s));
  if (rules.response_time_above_s)
    words.push_back(fmt::format("response times above {:g} s", *rules.response_time_above_s));
  if (rules.saturated_share_above)
    words.push_back(fmt::format("more than {:g} of the contact time at the force limit", *rules.saturated_share_above));
  if (words.empty()) return "No trial was excluded by a registered rule.\n";
  std::string counts;
  for (const auto& [reason, trials] : results.analysis.exclusions)
    counts += fmt::format("{}{} by {}", counts.empty() ? ": " : ", ", trials, reason);
  return fmt::format("Trials were excluded by the registered rules ({}){}.\n", list_of(words),
                     counts.empty() ? ": none" : counts);
}

void add_list(std::string& text, const char* heading, const std::vector<std::string>& sentences, const char* none) {
  text += fmt::format("\n## {}\n\n", heading);
  if (sentences.empty()) text += fmt::format("{}\n", none);
  for (const std::string& sentence : sentences) text += fmt::format("- {}\n", sentence);
}

std::string reproduction(const Study& study, const Protocol& protocol, const StudyResults& results) {
  std::string text = fmt::format(
      "\n## To do it again\n\n"
      "- Program: jnd {}\n- Protocol: {}, SHA-256 `{}`\n- Seed of the study: {}\n- Sessions: {}, heads of their "
      "chains:\n",
      kVersion, protocol.name, protocol.sha256, seed_text(study, protocol, "sealed while the study is blinded"),
      results.analysis.heads.size());
  for (const SessionHead& head : results.analysis.heads)
    text += fmt::format("  - {} `{}`{}\n", head.participant, head.hash, head.closed ? "" : " (not finished)");
  return text;
}

constexpr const char* kReferences =
    "\n## References\n\n"
    "- Cousineau D. (2005). Tutorials in Quantitative Methods for Psychology 1, 42-45.\n"
    "- Efron B., Tibshirani R. (1993). An Introduction to the Bootstrap. Chapman and Hall.\n"
    "- Games P., Howell J. (1976). Journal of Educational Statistics 1, 113-125.\n"
    "- Gourevitch V., Galanter E. (1967). Psychometrika 32, 25-33.\n"
    "- Hautus M. (1995). Behavior Research Methods 27, 46-51.\n"
    "- Holm S. (1979). Scandinavian Journal of Statistics 6, 65-70.\n"
    "- Levitt H. (1971). Journal of the Acoustical Society of America 49, 467-477.\n"
    "- Macmillan N., Creelman C. (2005). Detection Theory: A User's Guide, 2nd ed. Erlbaum.\n"
    "- Macmillan N., Kaplan H. (1985). Psychological Bulletin 98, 185-199.\n"
    "- Morey R. (2008). Tutorials in Quantitative Methods for Psychology 4, 61-64.\n"
    "- Royston P. (1995). Applied Statistics 44, 547-551 (AS R94).\n"
    "- Salmon J. et al. (2011). Parallel random numbers: as easy as 1, 2, 3. SC '11.\n"
    "- Watson A., Pelli D. (1983). Perception and Psychophysics 33, 113-120.\n";

}  // namespace

std::string methods_text(const Study& study, const Protocol& protocol, const StudyResults& results) {
  std::string text = fmt::format("# Methods: {}\n\n", protocol.title);
  if (results.analysis.kind != SessionKind::real)
    text += fmt::format("**These are {} data, not those of a study with participants.**\n\n",
                        to_string(results.analysis.kind));
  if (!protocol.source.citation.empty())
    text += fmt::format("After: {}{}\n\n", protocol.source.citation,
                        protocol.source.doi.empty() ? "" : " https://doi.org/" + protocol.source.doi);
  if (results.questionnaire) {
    text += "## Design\n\n" + exploration_design(protocol, results);
    text += "\n## Tests\n\n" + questionnaire_tests(results);
    add_list(text, "Deviations from the registered plan", results.deviations, "None.");
    return text + reproduction(study, protocol, results) + questionnaire_references();
  }
  text += "## Design\n\n" + design_paragraph(protocol, results);
  text += "\n## Estimates\n\n" + estimate_paragraph(protocol, results) + "\n" + exclusion_paragraph(protocol, results);
  text += "\n## Tests\n\n" + test_paragraph(protocol, results.comparisons.front());
  add_list(text, "Deviations from the registered plan", results.deviations, "None.");
  add_list(text, "Warnings", results.warnings, "None.");
  text += reproduction(study, protocol, results);
  return text + kReferences;
}

}  // namespace jnd
