#include "data/methods/methods_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "data/methods/design_text.h"
#include "data/methods/markdown_text.h"
#include "data/methods/references.h"
#include "data/study/blinding.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"
#include "protocols/version.h"

namespace jnd {

namespace {

std::string correction_words(const PairMethod& analysis) {
  if (is_maximum_likelihood(analysis.method.method)) return "The fit is to the counts, without any correction. ";
  switch (analysis.method.correction) {
    case Correction::loglinear:
      return "Rates were corrected log-linearly, (k + 0.5) / (n + 1), in every cell (Hautus 1995). ";
    case Correction::half:
      return "Rates of 0 and 1 were replaced by 1/(2n) and 1 - 1/(2n) (Macmillan and Kaplan 1985). ";
    case Correction::none:
      break;
  }
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

std::string slope_words(const PairMethod& analysis) {
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

std::string interval_words(const PairMethod& analysis) {
  if (is_maximum_likelihood(analysis.method.method))
    return " Intervals of single JNDs are profile-likelihood intervals.";
  if (analysis.method.method == JndMethod::least_squares && analysis.intervals)
    return " Intervals of single JNDs are percentile intervals of a parametric bootstrap (2000 replicates, log-linear "
           "rates; Efron and Tibshirani 1993).";
  return "";
}

std::string posterior_paragraph(const AdaptiveProcedure& procedure, const Protocol& protocol) {
  return fmt::format(
      "The threshold is the JND s, the difference at d' = 1, exp of the posterior mean of ln s given all answers of a "
      "condition at once{}; its interval is the middle 95 % of the posterior. The criterion k is a parameter of the model, so that the threshold does not "
      "move with it. There is no threshold while the answers "
      "say less than the prior (status too_few_answers: the posterior variance of ln s is above half of the prior's), nor "
      "where the posterior is highest at an end of the grid (status pinned_at_grid).\n",
      procedure.joint_likelihood ? ", by the response model " + model_words(protocol) : "");
}

std::string adaptive_paragraph(const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  if (threshold_source(protocol) == ThresholdSource::answers) return posterior_paragraph(procedure, protocol);
  std::string text = fmt::format("The threshold is the difference of which \"different\" is said in {:.1f} %: ",
                                 100 * adaptive_target(procedure).value_or(kNaN));
  if (procedure.kind == AdaptiveProcedure::Kind::quest)
    text +=
        "ten to the mean of the posterior of its logarithm after the last trial, averaged on the logarithm over the "
        "tracks of a condition that have a threshold.";
  else
    text += fmt::format(
        "the mean of the last {} reversals of each track (Levitt 1971), averaged over the tracks of a condition{}",
        procedure.averaged_reversals / 2 * 2,
        protocol.analysis.unfinished_tracks == UnfinishedTracks::use
            ? "; a track with fewer counts with those that it has, if at least 2."
            : " that have so many.");
  text += " It moves with the criterion";
  text += procedure.catch_share > 0 ? ": the rate of false alarms on catch trials stands beside it.\n"
                                    : ", of which nothing is known without catch trials.\n";
  return text;
}

// What the tracks of a task's procedure come to, beside what its answers say together; nothing without such.
std::string track_sentence(const TaskResults& results, const Protocol& protocol) {
  const TaskOutcome& last = results.outcomes.back();
  return last.key == kTrackThreshold
             ? fmt::format(" The {} is the {}; tracks without one are left out{}.", last.title, last.meaning,
                           protocol.analysis.unfinished_tracks == UnfinishedTracks::use
                               ? ", and a track with fewer reversals counts with those that it has, if at least 2"
                               : "")
             : std::string();
}

std::string estimate_paragraph(const Protocol& protocol, const PairMethod& analysis) {
  return fmt::format(
      "{}{}{}; JND = 1/m, the difference at d' = 1, and the Weber fraction is JND / {:g} {}. Differences are the {} "
      "ones.{} Estimates with m <= 1e-9 have no JND (status no_sensitivity), nor have those whose m is infinite "
      "(status ceiling): means of JNDs leave both out, medians count the former as infinite and the latter as smaller "
      "than any JND. Every group number names how many of how many it rests on.{}\n",
      dprime_words(analysis.method.model), correction_words(analysis), slope_words(analysis),
      protocol.stimulus.reference, to_string(protocol.stimulus.unit), to_string(analysis.by), interval_words(analysis),
      protocol.task.sureness_levels == 0
          ? ""
          : " Beside it the JND was estimated from all degrees of sureness: P(answer <= j) = Phi(c_j - dK / JND) with the "
            "criteria c_j common to all differences, by maximum likelihood with a profile interval (McCullagh 1980).");
}

std::string omnibus_words(Omnibus omnibus, std::size_t conditions) {
  switch (omnibus) {
    case Omnibus::anova:
      return conditions > 2 ? "a one-way repeated-measures analysis of variance with the correction of Greenhouse and "
                              "Geisser 1959"
                            : "a one-way repeated-measures analysis of variance";
    case Omnibus::friedman:
      return "Friedman's test with the correction for ties (Friedman 1937)";
    case Omnibus::none:
      break;
  }
  return "";
}

std::string post_hoc_words(PostHoc post_hoc, std::size_t contrasts) {
  switch (post_hoc) {
    case PostHoc::holm_t:
      if (contrasts == 1) return "a paired t test";
      return "paired t tests with Holm's correction over them (Holm 1979)";
    case PostHoc::games_howell:
      return "Games-Howell tests over all conditions, which ignore the pairing (Games and Howell 1976)";
    case PostHoc::tukey:
      return "Tukey's studentised range test over all conditions, with the repeated-measures error term";
    case PostHoc::wilcoxon:
      if (contrasts == 1) return "a signed-rank test (Wilcoxon 1945)";
      return "signed-rank tests (Wilcoxon 1945) with Holm's correction over them (Holm 1979)";
  }
  return "";
}

// What is registered: "... by A, and the 3 registered contrasts by B"; empty where nothing is.
std::string registered_tests(const Protocol& protocol) {
  const std::string omnibus = omnibus_words(protocol.analysis.tests.omnibus, protocol.conditions.size());
  const std::size_t contrasts = protocol.analysis.hierarchical ? 0 : protocol.analysis.contrasts.size();
  std::string text = omnibus.empty() ? "" : "all conditions together by " + omnibus;
  if (contrasts == 0) return text;
  return text + fmt::format("{}the {}registered contrast{} by {}", text.empty() ? "" : ", and ",
                            contrasts == 1 ? "" : fmt::format("{} ", contrasts), plural(contrasts),
                            post_hoc_words(protocol.analysis.tests.post_hoc, contrasts));
}

// The response model of the hierarchical one, with its letters.
std::string observer_formula(const StudyHierarchical& model, const Protocol& protocol) {
  if (model.response == ResponseModel::choice) {
    const double jnd = task_of(protocol.task.kind).answer_model(protocol).value().jnd_of_s;
    return fmt::format("P(comparison chosen) = {}Phi((x - k)/s){}, where x is the comparison less the standard, {}, {}",
                       model.lapse > 0 ? fmt::format("{:g} + {:g} ", model.lapse / 2, 1 - model.lapse) : "",
                       model.pse_at_standard ? " with k = 0" : " with the PSE less the standard k",
                       jnd == 1 ? "s a participant's JND in a condition (84 %)"
                                : fmt::format("{:.4f} s a participant's {} in a condition", jnd, jnd_title(protocol)),
                       model.pse_at_standard ? "as all comparisons lie on one side of it"
                                             : "k the sum of a value of the condition and one of the participant");
  }
  if (!task_of(protocol.task.kind).has_pairs())
    return "P(\"yes\") = Phi(x/s - k) with the criterion k, where x is the distance of the signal from the noise, s a "
           "participant's threshold in a condition";
  return fmt::format("{}, where x is the stiffness difference, s a participant's JND in a condition",
                     model.response == ResponseModel::differencing
                         ? "P(\"different\") = Phi((x/s - t)/sqrt(2)) + Phi((-x/s - t)/sqrt(2)) with the criterion t"
                         : "P(\"different\") = Phi(x/s - k) with the criterion k");
}

// The contrasts by one model of everybody's answers, where that is registered.
std::string hierarchical_paragraph(const Protocol& protocol, const StudyResults& results) {
  const std::size_t contrasts = protocol.analysis.contrasts.size();
  if (!protocol.analysis.hierarchical || !results.hierarchical || contrasts == 0) return "";
  const StudyHierarchical& model = *results.hierarchical;
  if (model.status != HierarchicalStatus::ok)
    return fmt::format("\nThe registered contrasts of the hierarchical model were refused: {}.\n", model.reason);
  return fmt::format(
      "\nThe {}registered contrast{} {} of JNDs by one model of the answers of all {} participants, fitted by maximum "
      "likelihood: {}, and ln s the sum of a value of the condition, one of the participant and one of both (Pinheiro and "
      "Bates 2000; Moscatelli et al. 2012). {}A ratio was tested by its likelihood ratio{}, and its interval is of profile "
      "likelihood (Venzon and Moolgavkar 1988; alpha = {:g}). {}\n",
      contrasts == 1 ? "" : fmt::format("{} ", contrasts), plural(contrasts),
      contrasts == 1 ? "is a ratio" : "are ratios", model.participants, observer_formula(model, protocol),
      levels_given(protocol)
          ? ""
          : "The levels that the procedure chose count like given ones, as they depend on nothing but earlier answers. ",
      contrasts == 1 ? "" : " with Holm's correction over the contrasts (Holm 1979)", protocol.analysis.tests.alpha,
      hierarchical_assumptions(model));
}

// What was tested beside the registered outcome.
std::string other_tests(const StudyResults& results, bool any_registered) {
  std::vector<std::string> others;
  for (const OutcomeComparison& outcome : results.comparisons)
    if (!(outcome.registered && any_registered) && outcome.refused.empty())
      others.push_back(outcome.question ? fmt::format("the answers to \"{}\"", markdown_text(outcome.title))
                                        : outcome.title);
  std::string text;
  if (!others.empty())
    text += fmt::format(" {}: {}. Nothing is corrected for the number of outcomes.",
                        any_registered ? "The same tests were made beside the registered ones on"
                                       : "The analysis of variance, Friedman's test (Friedman 1937) and pairwise tests "
                                         "were computed for",
                        list_of(others));
  if (results.questionnaire.tests.family > 0)
    text += fmt::format(
        " Pairs of conditions were also compared by the answers to questions, with signed-rank tests (Wilcoxon 1945) "
        "and the corrections of Holm 1979 and of Benjamini and Hochberg 1995 over the {} test{}.",
        results.questionnaire.tests.family, plural(results.questionnaire.tests.family));
  return text;
}

// How the groups were compared: "by ..."; empty where that is not registered.
std::string between_words(const Protocol& protocol) {
  const bool several = protocol.groups.size() > 2;
  const bool one_condition = conditions_of(protocol, largest_plan(protocol)).size() == 1;
  const std::string values = one_condition ? "" : ", of each participant's mean over their conditions";
  switch (protocol.analysis.tests.between) {
    case BetweenTest::welch:
      return several ? fmt::format(
                           "by Welch's t test (Welch 1947) of each pair{}, with Holm's correction over the pairs "
                           "(Holm 1979)",
                           values)
                     : fmt::format("by Welch's t test (Welch 1947){}", values);
    case BetweenTest::mann_whitney:
      return several ? fmt::format(
                           "by the test of Mann and Whitney 1947 of each pair{}, with Holm's correction over the "
                           "pairs (Holm 1979)",
                           values)
                     : fmt::format("by the test of Mann and Whitney 1947{}", values);
    case BetweenTest::mixed_anova:
      return "together with the conditions by an analysis of variance with groups between and conditions within "
             "participants (Maxwell and Delaney 2004), what is within corrected as by Greenhouse and Geisser 1959";
    case BetweenTest::none:
      break;
  }
  return "";
}

std::string group_tests(const Protocol& protocol, const StudyResults& results) {
  if (!results.groups) return "";
  const GroupsCompared& groups = *results.groups;
  const std::string words = between_words(protocol);
  std::string text;
  if (!results.comparisons.front().crossed && !protocol.analysis.contrasts.empty())
    text += "\nGroups had different conditions: a contrast rests on the participants who had both.\n";
  if (words.empty()) return text + "\nNo test of the groups was registered.\n";
  if (!groups.refused.empty())
    return text + fmt::format("\nThe registered test of the groups was refused: {}.\n", markdown_text(groups.refused));
  return text + fmt::format("\nThe groups were compared on the {} {} ({} of {} participants; alpha = {:g}).{}\n",
                            groups.title, words, groups.participants.size(),
                            groups.participants.size() + groups.left_out.size(), protocol.analysis.tests.alpha,
                            groups.test == BetweenTest::mixed_anova && groups.comparison.anova.unequal
                                ? " The groups differed in size: sums of squares are of type I, in the order group, "
                                  "condition, group x condition."
                                : "");
}

std::string test_paragraph(const Protocol& protocol, const StudyResults& results) {
  const OutcomeComparison& outcome = *results.registered();
  const std::size_t conditions = protocol.conditions.size();
  if (conditions < 2) return "There was one condition, and nothing to compare it with.\n";
  const std::string tests = registered_tests(protocol);
  if (!outcome.refused.empty())
    return fmt::format("The tests on the {} were refused: {}.{}\n", outcome.title, markdown_text(outcome.refused),
                       other_tests(results, !tests.empty()));
  std::string text =
      tests.empty() ? std::string(protocol.analysis.hierarchical ? "No test of separate values was registered."
                                                                 : "No test was registered.")
                    : fmt::format("The {} was compared over {} ({} of {} participants{}; alpha = {:g}).", outcome.title,
                                  tests, outcome.table.n, outcome.table.n + outcome.left_out.size(),
                                  outcome.crossed ? "" : " who had every condition", protocol.analysis.tests.alpha);
  text += " The normality of residuals was looked at with Shapiro and Wilk's test (Royston 1995)";
  if (conditions > 2) text += ", sphericity with that of Mauchly 1940";
  text +=
      ". Intervals of a condition within participants are those of Cousineau 2005 with the correction of Morey 2008.";
  return text + other_tests(results, !tests.empty()) + "\n";
}

std::string exclusion_paragraph(const Protocol& protocol, const std::map<std::string, int>& exclusions) {
  const Exclusions& rules = protocol.analysis.exclude;
  std::vector<std::string> words;
  if (rules.response_time_below_s)
    words.push_back(fmt::format("response times below {:g} s", *rules.response_time_below_s));
  if (rules.response_time_above_s)
    words.push_back(fmt::format("response times above {:g} s", *rules.response_time_above_s));
  if (rules.saturated_share_above)
    words.push_back(fmt::format("more than {:g} of the contact time at the force limit", *rules.saturated_share_above));
  if (rules.off_prescription) words.emplace_back("a trial that broke the prescription of how to explore");
  if (words.empty()) return "No trial was excluded by a registered rule.\n";
  std::string counts;
  for (const auto& [reason, trials] : exclusions)
    counts += fmt::format("{}{} by {}", counts.empty() ? ": " : ", ", trials, reason);
  return fmt::format("Trials were excluded by the registered rules ({}){}.\n", list_of(words),
                     counts.empty() ? ": none" : counts);
}

void add_list(std::string& text, const char* heading, const std::vector<std::string>& sentences, const char* none) {
  text += fmt::format("\n## {}\n\n", heading);
  if (sentences.empty()) text += fmt::format("{}\n", none);
  for (const std::string& sentence : sentences) text += fmt::format("- {}\n", markdown_text(sentence));
}

std::string reproduction(const Study& study, const Protocol& protocol, const StudyResults& results) {
  std::string text = fmt::format(
      "\n## To do it again\n\n"
      "- Program: jnd {}\n- Protocol: {}, SHA-256 `{}`\n- Seed of the study: {}\n- Events: {}\n- Sessions: {}, heads "
      "of their chains:\n",
      kVersion, markdown_text(protocol.name), protocol.sha256,
      seed_text(study, protocol, "sealed while the study is blinded"), chain_line(results.chains),
      results.attendance.heads.size());
  for (const SessionHead& head : results.attendance.heads)
    text += fmt::format("  - {} `{}`{}\n", head.participant, head.hash.empty() ? "sealed" : head.hash,
                        head.closed ? "" : " (not finished)");
  return text;
}

std::string questionnaire_tests(const StudyResults& results) {
  const QuestionnaireResults& all = results.questionnaire;
  const auto paired = static_cast<std::size_t>(
      std::count_if(all.items.begin(), all.items.end(), [](const QuestionnaireItem& item) { return item.paired; }));
  const std::size_t once = all.items.size() - paired;
  std::string text = fmt::format(
      "{} item{} {} answered for each condition. Conditions were compared item by item with Wilcoxon's signed-rank "
      "test "
      "(Wilcoxon 1945; zero differences dropped). The p of the normal approximation with the corrections for "
      "continuity "
      "and ties, or the exact one without ties, is that of R's wilcox.test. Ratings tie, therefore the p that enters "
      "the corrections is the exact permutation p with midranks, over all changes of sign. The {} tests are one "
      "family: "
      "Holm 1979, and Benjamini and Hochberg 1995, both stand beside the uncorrected p. The effect size is the "
      "rank-biserial correlation (Kerby 2014). At alpha = {:g}, {} of {} tests fall below it as R computes them, {} by "
      "the exact p, {} with Holm's correction and {} with Benjamini and Hochberg's.\n",
      paired, plural(paired), paired == 1 ? "was" : "were", all.tests.family, all.alpha, all.below_alpha.as_r,
      all.tests.family, all.below_alpha.exact, all.below_alpha.holm, all.below_alpha.bh);
  if (once > 0)
    text += fmt::format(
        "\n{} item{} {} answered once. They have no pair and no test: mean, standard deviation, and "
        "the median with its distribution-free interval (Conover 1999, section 3.2).\n",
        once, plural(once), once == 1 ? "was" : "were");
  if (!results.exploration.choices.empty())
    text += "\nChoices are counts, with exact binomial intervals of each share (Clopper and Pearson 1934).\n";
  return text;
}

std::string estimates(const Protocol& protocol, const StudyResults& results) {
  const Task& task = task_of(protocol.task.kind);
  if (task.evidence(protocol) == Evidence::tracks) return adaptive_paragraph(protocol);
  if (task_of(protocol.task.kind).evidence(protocol) == Evidence::counts)
    return estimate_paragraph(protocol, results.task.pairs);
  return fmt::format("{}{}\n", task.methods(protocol), track_sentence(results.task, protocol));
}

std::string exclusions(const Protocol& protocol, const StudyResults& results) {
  return levels_given(protocol)
             ? exclusion_paragraph(protocol, results.task.exclusions)
             : "No answered trial was excluded: an excluded answer would have moved the levels all the same.\n";
}

// Design, estimates and tests.
std::string sections(const Protocol& protocol, const StudyResults& results) {
  if (results.registered() == nullptr)
    return "## Design\n\n" + exploration_design(protocol, results) + "\n## Tests\n\n" + questionnaire_tests(results);
  return fmt::format("## Design\n\n{}\n## Estimates\n\n{}\n{}\n## Tests\n\n{}{}{}", design_paragraph(protocol, results),
                     estimates(protocol, results), exclusions(protocol, results), test_paragraph(protocol, results),
                     hierarchical_paragraph(protocol, results), group_tests(protocol, results));
}

}  // namespace

std::string methods_text(const Study& study, const Protocol& protocol, const StudyResults& results) {
  std::string text = fmt::format("# Methods: {}\n\n", markdown_text(protocol.title));
  if (results.attendance.kind != SessionKind::real)
    text += fmt::format("**These are {} data, not those of a study with participants.**\n\n",
                        to_string(results.attendance.kind));
  if (!protocol.source.citation.empty())
    text += fmt::format("After: {}{}\n\n", markdown_text(protocol.source.citation),
                        protocol.source.doi.empty() ? "" : " https://doi.org/" + markdown_text(protocol.source.doi));
  text += sections(protocol, results);
  add_list(text, "Deviations from the registered plan", results.deviations, "None.");
  if (results.registered() != nullptr) add_list(text, "Cautions", results.cautions, "None.");
  text += reproduction(study, protocol, results);
  return text + references_of(text);
}

}  // namespace jnd
