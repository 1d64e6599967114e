#include "data/results/methods_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "data/results/markdown_text.h"
#include "data/results/references.h"
#include "data/study/blinding.h"
#include "protocols/course/prescription.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/allotment.h"
#include "protocols/random_stream.h"
#include "protocols/tasks/posterior_model.h"
#include "protocols/tasks/task.h"
#include "protocols/version.h"

namespace jnd {

namespace {

std::string_view unit_of(const Protocol& protocol) {
  return to_string(protocol.stimulus.unit);
}

std::string order_words(Order order) {
  switch (order) {
    case Order::fixed:
      return "in the protocol's order";
    case Order::random:
      return "in an order drawn for each participant";
    case Order::permuted:
      return "in all their orders, dealt to the participants in turn";
    case Order::williams:
      return "in the orders of a Williams square, dealt to the participants in turn";
  }
  return "";
}

// Who judged what, under which conditions.
std::string task_words(const Protocol& protocol, const StudyResults& results) {
  std::vector<std::string> conditions;
  for (const Condition& one : protocol.conditions)
    conditions.push_back(fmt::format("{} ({})", markdown_text(one.name), markdown_text(one.label)));
  const auto participants = static_cast<std::size_t>(attendance_of(results).participants);
  if (!task_of(protocol.task.kind).has_own_results())
    return fmt::format("{} {} participant{} did the task \"{}\" ({}) with {} under {} condition{}: {}. ", participants,
                       to_string(attendance_of(results).kind), plural(participants), to_string(protocol.task.kind),
                       task_of(protocol.task.kind).summary(), markdown_text(protocol.stimulus.quantity),
                       conditions.size(), plural(conditions.size()), list_of(conditions));
  return fmt::format(
      "{} {} participant{} judged whether two stimuli were the same or different in stiffness (same-different, two "
      "intervals) under {} feedback condition{}: {}. ",
      participants, to_string(attendance_of(results).kind), plural(participants), conditions.size(),
      plural(conditions.size()), list_of(conditions));
}

// Who got which conditions, and what decided that.
std::string group_sentences(const Protocol& protocol) {
  if (protocol.groups.empty()) return "";
  std::vector<std::string> groups;
  for (const Group& group : protocol.groups) {
    std::vector<std::string> conditions;
    for (const int condition : group.conditions)
      conditions.push_back(markdown_text(condition_name(protocol, condition)));
    groups.push_back(fmt::format("{} ({}{})", markdown_text(group.name), markdown_text(group.label),
                                 everyone_has_all(protocol) ? "" : fmt::format("; {}", list_of(conditions))));
  }
  return fmt::format(
      "They were in {} groups: {}. {} ", groups.size(), list_of(groups),
      protocol.allotment == Allotment::balanced
          ? fmt::format("Each {} participants in turn were allotted to the groups in random order.", groups.size())
          : "Who belonged to which group was said before the first session.");
}

std::string session_words(const Design& design) {
  return design.sessions == 1 ? "" : fmt::format(" in each of {} sessions", design.sessions);
}

// where: "In S, ", or nothing.
std::string prescription_sentences(const Prescription& prescription, const std::string& where, Unit unit) {
  std::string text;
  if (!prescription.say.empty())
    text += fmt::format("{}articipants were told: \"{}\". ", where.empty() ? "P" : where + "p",
                        markdown_text(prescription.say));
  if (prescription.pace_hz > 0)
    text +=
        fmt::format("{} metronome of {:g} Hz set the pace. ", where.empty() ? "A" : where + "a", prescription.pace_hz);
  if (prescription.limits.empty()) return text;
  std::vector<std::string> limits;
  for (const Prescription::Limit& limit : prescription.limits) limits.push_back(limit_text(limit, unit));
  return text + fmt::format("{}hat was measured in every interval was held against {}; a trial outside was {}. ",
                            where.empty() ? "W" : where + "w", list_of(limits),
                            prescription.on_breach == OnSaturation::repeat ? "voided and repeated" : "marked");
}

std::string parameter_text(const ParameterValue& value) {
  if (const double* number = std::get_if<double>(&value)) return fmt::format("{:g}", *number);
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  return std::get<std::string>(value);
}

// How the standard was felt, what ended an interval, and what participants were told to do in it. Nothing where only time did.
std::string exploration_sentences(const Protocol& protocol) {
  const Timeline& timeline = protocol.timeline;
  std::string text;
  for (const Condition& condition : protocol.conditions) {
    if (condition.standard_parameters.empty()) continue;
    std::vector<std::string> words;
    for (const auto& [name, value] : condition.standard_parameters)
      words.push_back(fmt::format("{} = {}", markdown_text(name), markdown_text(parameter_text(value))));
    text += fmt::format("In {} the standard was presented with {}. ", markdown_text(condition.name), list_of(words));
  }
  if (timeline.interval_end == IntervalEnd::contacts)
    text += fmt::format("An interval ended after {} contact{}, at the latest {:g} s after the first. ",
                        timeline.contacts, plural(static_cast<std::size_t>(timeline.contacts)), timeline.explore_s);
  if (timeline.interval_end == IntervalEnd::key)
    text += fmt::format(
        "An interval ended when the participant had felt enough, at the latest {:g} s after the first contact. ",
        timeline.explore_s);
  if (timeline.prescription) text += prescription_sentences(*timeline.prescription, "", protocol.stimulus.unit);
  for (const Condition& condition : protocol.conditions)
    if (condition.prescription)
      text += prescription_sentences(*condition.prescription, fmt::format("In {}, ", markdown_text(condition.name)),
                                     protocol.stimulus.unit);
  return text;
}
// In which order it came, and what decided that.
std::string order_sentences(const Protocol& protocol) {
  const Design& design = protocol.design;
  std::string text = exploration_sentences(protocol);
  if (protocol.series.size() > 1) text += fmt::format("Series came {}. ", order_words(design.series_order));
  const bool own_order = design.per_series && design.condition_order != Order::fixed && protocol.series.size() > 1;
  if (protocol.conditions.size() > 1)
    text += design.arrangement == Arrangement::mixed
                ? "Conditions were mixed trial by trial. "
                : fmt::format("Conditions came in blocks, {}{}. ", order_words(design.condition_order),
                              own_order ? ", another one in each series" : "");
  text += fmt::format(
      "Whatever was drawn or dealt followed from the study's seed, by counter-based random streams ({}, Salmon et al. "
      "2011).",
      kGeneratorName);
  if (protocol.practice) text += " Practice trials took no part in any number below.";
  return text + "\n";
}

// The response model and its prior, of the first series: those of others are in proportion.
std::string model_words(const Protocol& protocol) {
  const PosteriorConfiguration c = posterior_model(protocol, protocol.series.front()).configuration;
  const std::string_view unit = unit_of(protocol);
  const bool which = c.task == PosteriorTask::which;
  return fmt::format(
      "P({}) = l/2 + (1 - l) Phi({}), on a grid of {} values of ln s, {} of {} and {} of l, with a prior of ln s about ln "
      "{:.4g} {}, standard deviation {:.3g}, and of {} about {:.3g}, standard deviation {:.3g}",
      which                                    ? "the comparison chosen"
      : protocol.task.kind == TaskKind::yes_no ? "yes"
                                               : "\"different\"",
      which ? "(x - standard - a)/s" : "difference/s - k", c.ln_s.size(), c.shift.size(), which ? "a" : "k",
      c.lapse.size(), std::exp(c.ln_s_prior.mean), unit, c.ln_s_prior.sd, which ? "a" : "k", c.shift_prior.mean,
      c.shift_prior.sd);
}

std::string posterior_words(const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  const std::vector<double>& levels = procedure.posterior.levels;
  const bool variance = procedure.posterior.utility == PosteriorUtility::variance;
  const bool catches = task_of(protocol.task.kind).has_catch_trials();
  return fmt::format(
      "of {} levels each trial had the one whose answer was expected to {} (Kontsevich and Tyler 1999{}), given the answers "
      "so far{} and the response model {}",
      levels.size(),
      variance ? "leave the smallest posterior variance of ln s" : "tell most about s and the other parameters",
      variance ? "; King-Smith et al. 1994" : "", catches ? ", those to catch trials among them," : "",
      model_words(protocol));
}

std::string procedure_words(const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  const std::string_view unit = unit_of(protocol);
  if (procedure.kind == AdaptiveProcedure::Kind::posterior) return posterior_words(protocol);
  if (procedure.kind == AdaptiveProcedure::Kind::quest)
    return fmt::format(
        "QUEST (Watson and Pelli 1983) presented ten to the mean of the posterior (King-Smith et al. 1994), with beta "
        "= "
        "{:g}, delta = {:g} and gamma = {:g}",
        procedure.quest.beta, procedure.quest.delta, procedure.quest.gamma);
  const StaircaseRule& rule = procedure.staircase;
  std::string halved;
  for (const int reversal : rule.halve_after)
    halved += fmt::format("{}{}", halved.empty() ? ", halved at reversal " : ", ", reversal);
  if (rule.accelerated) halved = ", shrinking with the reversals (Kesten 1958)";
  const std::string steps =
      rule.multiplicative
          ? fmt::format("factors of {:g} up and {:g} down", rule.step_up, rule.step_down)
          : fmt::format("steps of {:g} {} up and {:g} {} down", rule.step_up, unit, rule.step_down, unit);
  return fmt::format("staircases went {} up, {} down ({}) in {}{}", rule.up, rule.down,
                     rule.step_up == rule.step_down ? "Levitt 1971" : "Levitt 1971; Kaernbach 1991", steps, halved);
}

std::string procedure_sentences(const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  const std::string_view unit = unit_of(protocol);
  std::string text = fmt::format(
      "The answers set the difference from the reference of {:g} {}, within {:g} to {:g} {}: {}. Each condition had {} "
      "track{}{}; a track ended after {}{} trial{} with a difference. ",
      protocol.stimulus.reference, unit, procedure.clamp[0], procedure.clamp[1], unit, procedure_words(protocol),
      procedure.starts.size(), plural(procedure.starts.size()), session_words(protocol.design),
      can_end_early(procedure) ? early_end_of(procedure) + ", or " : std::string(), procedure.trials,
      plural(static_cast<std::size_t>(procedure.trials)));
  if (procedure.catch_share > 0)
    text += fmt::format("{:.0f} % of the trials were catch trials (equal pairs{}), kept in short blocks. ",
                        100 * procedure.catch_share,
                        procedure.kind == AdaptiveProcedure::Kind::posterior ? "" : ", which move nothing");
  return text;
}

std::string series_sentences(const Protocol& protocol) {
  const Design& design = protocol.design;
  std::vector<std::string> pairs;
  for (const Series& one : protocol.series) pairs.push_back(fmt::format("{:g}/{:g}", one.pair[0], one.pair[1]));
  return fmt::format(
      "The pairs of stiffnesses were {} {}. Each cell of condition and series was planned with {} trial{}{}; the "
      "classes (same, "
      "different) were {}. ",
      list_of(pairs), unit_of(protocol), design.trials_per_cell,
      plural(static_cast<std::size_t>(design.trials_per_cell)), session_words(design),
      design.sampling == Sampling::balanced ? "balanced within each cell"
                                            : "drawn independently with a probability of one half");
}

// Of the tasks that have standards and levels.
std::string comparison_sentences(const Protocol& protocol) {
  const Task& task = task_of(protocol.task.kind);
  const Design& design = protocol.design;
  const std::string_view unit = unit_of(protocol);
  std::string text;
  for (const Series& series : protocol.series) {
    std::vector<std::string> levels;
    for (const double level : series.levels) levels.push_back(fmt::format("{:g}", level));
    if (task.has_standard())
      text += fmt::format("The standard {} was {:g} {}", markdown_text(series.name), series.standard, unit);
    else
      text += "The values";
    if (!levels.empty())
      text += fmt::format("{} {} {}", task.has_standard() ? ", compared with" : " were", list_of(levels), unit);
    text += ". ";
  }
  if (design.procedure)
    return text +
           fmt::format(
               "The answers set the difference from the standard, within {:g} to {:g} {}: {}. Each condition and "
               "standard had {} track{}{} of at most {} trials with a difference. ",
               design.procedure->clamp[0], design.procedure->clamp[1], unit, procedure_words(protocol),
               design.procedure->starts.size(), plural(design.procedure->starts.size()), session_words(design),
               design.procedure->trials);
  return text + fmt::format("Each level was presented {} time{} in every condition{}; {}. ", design.trials_per_cell,
                            plural(static_cast<std::size_t>(design.trials_per_cell)), session_words(design),
                            design.sampling == Sampling::balanced ? "its orders were balanced"
                                                                  : "its orders were drawn at random");
}

std::string design_paragraph(const Protocol& protocol, const StudyResults& results) {
  return task_words(protocol, results) + group_sentences(protocol) +
         (!task_of(protocol.task.kind).has_own_results() ? comparison_sentences(protocol)
          : protocol.design.procedure                    ? procedure_sentences(protocol)
                                                         : series_sentences(protocol)) +
         order_sentences(protocol);
}

std::string correction_words(const StudyAnalysis& analysis) {
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

std::string posterior_paragraph(const Protocol& protocol) {
  const bool joint = protocol.design.procedure->joint_likelihood;
  return fmt::format(
      "The threshold is the JND s, the difference at d' = 1, exp of the posterior mean of ln s given all answers of a "
      "condition at once{}; its interval is the middle 95 % of the posterior. The criterion k is a parameter of the model, so that the threshold does not "
      "move with it. There is no threshold while the answers "
      "say less than the prior (status too_few_answers: the posterior variance of ln s is above half of the prior's), nor "
      "where the posterior is highest at an end of the grid (status pinned_at_grid).\n",
      joint ? ", by the response model " + model_words(protocol) : "");
}

std::string adaptive_paragraph(const Protocol& protocol) {
  if (threshold_source(protocol) == ThresholdSource::answers) return posterior_paragraph(protocol);
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  std::string text = fmt::format("The threshold is the difference of which \"different\" is said in {:.1f} %: ",
                                 100 * adaptive_target(procedure).value_or(kNaN));
  if (procedure.kind == AdaptiveProcedure::Kind::quest)
    text +=
        "ten to the mean of the posterior of its logarithm after the last trial, averaged on the logarithm over the "
        "tracks of a condition that have a threshold.";
  else
    text += fmt::format(
        "the mean of the last {} reversals of each track (Levitt 1971), averaged over the tracks of a condition that "
        "have so many.",
        procedure.averaged_reversals / 2 * 2);
  text += " It moves with the criterion";
  text += procedure.catch_share > 0 ? ": the rate of false alarms on catch trials stands beside it.\n"
                                    : ", of which nothing is known without catch trials.\n";
  return text;
}

std::string estimate_paragraph(const Protocol& protocol, const StudyAnalysis& analysis) {
  return fmt::format(
      "{}{}{}; JND = 1/m, the difference at d' = 1, and the Weber fraction is JND / {:g} {}. Differences are the {} "
      "ones.{} Estimates with m <= 1e-9 have no JND (status no_sensitivity), nor have those whose m is infinite "
      "(status ceiling): means of JNDs leave both out, medians count the former as infinite and the latter as smaller "
      "than any JND. Every group number names how many of how many it rests on.{}\n",
      dprime_words(analysis.method.model), correction_words(analysis), slope_words(analysis),
      protocol.stimulus.reference, unit_of(protocol), to_string(analysis.by), interval_words(analysis),
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
  const std::size_t contrasts = protocol.analysis.contrasts.size();
  std::string text = omnibus.empty() ? "" : "all conditions together by " + omnibus;
  if (contrasts == 0) return text;
  return text + fmt::format("{}the {}registered contrast{} by {}", text.empty() ? "" : ", and ",
                            contrasts == 1 ? "" : fmt::format("{} ", contrasts), plural(contrasts),
                            post_hoc_words(protocol.analysis.tests.post_hoc, contrasts));
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
  const OutcomeComparison& outcome = results.comparisons.front();
  const std::size_t conditions = protocol.conditions.size();
  if (conditions < 2) return "There was one condition, and nothing to compare it with.\n";
  const std::string tests = registered_tests(protocol);
  if (!outcome.refused.empty())
    return fmt::format("The tests on the {} were refused: {}.{}\n", outcome.title, markdown_text(outcome.refused),
                       other_tests(results, !tests.empty()));
  std::string text =
      tests.empty() ? std::string("No test was registered.")
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
      attendance_of(results).heads.size());
  for (const SessionHead& head : attendance_of(results).heads)
    text += fmt::format("  - {} `{}`{}\n", head.participant, head.hash, head.closed ? "" : " (not finished)");
  return text;
}

// Of free interaction.
std::string exploration_design(const Protocol& protocol, const StudyResults& results) {
  std::vector<std::string> conditions;
  for (const Condition& one : protocol.conditions)
    conditions.push_back(fmt::format("{} ({}{})", markdown_text(one.name), markdown_text(one.label),
                                     one.devices ? "" : "; nothing was rendered"));
  const Exploration& explore = *protocol.explore;
  const std::size_t objects = explore.objects.size();
  std::vector<std::string> names;
  for (const std::string& one : explore.objects) names.push_back(markdown_text(one));
  return fmt::format(
      "{} {} participant{} interacted freely with {} virtual object{} ({}) under {} condition{}: {}. Each condition "
      "lasted {:g} s, divided equally among the objects. The order of conditions and objects was dealt per participant "
      "from the study's seed with counter-based random streams ({}, Salmon et al. 2011). Objects had a "
      "stiffness of {:g} {}. Time in which the session was paused does not count.\n",
      attendance_of(results).participants, to_string(attendance_of(results).kind),
      attendance_of(results).participants == 1 ? "" : "s", objects, plural(objects), list_of(names),
      protocol.conditions.size(), plural(protocol.conditions.size()), list_of(conditions), explore.duration_s,
      kGeneratorName, protocol.stimulus.reference, to_string(protocol.stimulus.unit));
}

std::string questionnaire_tests(const StudyResults& results, const ExplorationResults& exploration) {
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
  if (!exploration.choices.empty())
    text += "\nChoices are counts, with exact binomial intervals of each share (Clopper and Pearson 1934).\n";
  return text;
}

// What depends on the kind of study: design, estimates and tests.
struct Sections {
  const Protocol& protocol;
  const StudyResults& results;

  std::string operator()(const ConstantResults& measured) const {
    return with_estimates(estimate_paragraph(protocol, measured.analysis),
                          exclusion_paragraph(protocol, measured.analysis.exclusions));
  }
  std::string operator()(const AdaptiveResults&) const {
    return with_estimates(
        adaptive_paragraph(protocol),
        "No answered trial was excluded: an excluded answer would have moved the levels all the same.\n");
  }
  std::string operator()(const MeasuredTask& measured) const {
    return with_estimates(task_of(protocol.task.kind).methods(protocol) + "\n",
                          exclusion_paragraph(protocol, measured.task.exclusions));
  }
  std::string operator()(const ExplorationResults& measured) const {
    return "## Design\n\n" + exploration_design(protocol, results) + "\n## Tests\n\n" +
           questionnaire_tests(results, measured);
  }

 private:
  std::string with_estimates(const std::string& estimates, const std::string& exclusions) const {
    return "## Design\n\n" + design_paragraph(protocol, results) + "\n## Estimates\n\n" + estimates + "\n" +
           exclusions + "\n## Tests\n\n" + test_paragraph(protocol, results) + group_tests(protocol, results);
  }
};

}  // namespace

std::string methods_text(const Study& study, const Protocol& protocol, const StudyResults& results) {
  std::string text = fmt::format("# Methods: {}\n\n", markdown_text(protocol.title));
  if (attendance_of(results).kind != SessionKind::real)
    text += fmt::format("**These are {} data, not those of a study with participants.**\n\n",
                        to_string(attendance_of(results).kind));
  if (!protocol.source.citation.empty())
    text += fmt::format("After: {}{}\n\n", markdown_text(protocol.source.citation),
                        protocol.source.doi.empty() ? "" : " https://doi.org/" + markdown_text(protocol.source.doi));
  text += std::visit(Sections{protocol, results}, results.measured);
  add_list(text, "Deviations from the registered plan", results.deviations, "None.");
  if (!std::holds_alternative<ExplorationResults>(results.measured))
    add_list(text, "Cautions", results.cautions, "None.");
  text += reproduction(study, protocol, results);
  return text + references_of(text);
}

}  // namespace jnd
