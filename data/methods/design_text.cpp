#include "data/methods/design_text.h"

#include <algorithm>

#include <fmt/format.h>

#include "data/methods/markdown_text.h"
#include "protocols/condition_words.h"
#include "protocols/course/prescription.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/allotment.h"
#include "protocols/random_stream.h"
#include "protocols/tasks/posterior_model.h"
#include "protocols/tasks/task.h"

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
  const auto participants = static_cast<std::size_t>(results.attendance.participants);
  if (!task_of(protocol.task.kind).has_pairs())
    return fmt::format("{} {} participant{} did the task \"{}\" ({}) with {} under {} condition{}: {}. ", participants,
                       to_string(results.attendance.kind), plural(participants), to_string(protocol.task.kind),
                       task_of(protocol.task.kind).summary(), markdown_text(protocol.stimulus.quantity),
                       conditions.size(), plural(conditions.size()), list_of(conditions));
  return fmt::format(
      "{} {} participant{} judged whether two stimuli were the same or different in stiffness (same-different, two "
      "intervals) under {} feedback condition{}: {}. ",
      participants, to_string(results.attendance.kind), plural(participants), conditions.size(),
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
  if (protocol.feedback == Feedback::correctness)
    text += "After each answer participants were told whether it was correct. ";
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

std::string posterior_words(const AdaptiveProcedure& procedure, const Protocol& protocol) {
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

std::string procedure_words(const AdaptiveProcedure& procedure, const Protocol& protocol) {
  const std::string_view unit = unit_of(protocol);
  if (procedure.kind == AdaptiveProcedure::Kind::posterior) return posterior_words(procedure, protocol);
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

std::string procedure_sentences(const AdaptiveProcedure& procedure, const Protocol& protocol) {
  const std::string_view unit = unit_of(protocol);
  std::string text = fmt::format(
      "The answers set the difference from the reference of {:g} {}, within {:g} to {:g} {}: {}. Each condition had {} "
      "track{}{}; a track ended after {}{} trial{} with a difference. ",
      protocol.stimulus.reference, unit, procedure.clamp[0], procedure.clamp[1], unit,
      procedure_words(procedure, protocol), procedure.starts.size(), plural(procedure.starts.size()),
      session_words(protocol.design), can_end_early(procedure) ? early_end_of(procedure) + ", or " : std::string(),
      procedure.trials, plural(static_cast<std::size_t>(procedure.trials)));
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

// Of pairs: what sets their difference.
std::string pair_sentences(const Protocol& protocol) {
  const auto& procedure = protocol.design.procedure;
  return procedure ? procedure_sentences(*procedure, protocol) : series_sentences(protocol);
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
      text += fmt::format("The standard{} was {:g} {}",
                          protocol.series.size() > 1 ? fmt::format(" {}", markdown_text(series.name)) : std::string(),
                          series.standard, unit);
    else
      text += "The values";
    if (!levels.empty())
      text += fmt::format("{} {} {}", task.has_standard() ? ", compared with" : " were", list_of(levels), unit);
    text += ". ";
  }
  if (const auto& procedure = design.procedure)
    return text + fmt::format(
                      "The answers set {}, within {:g} to {:g} {}: {}. Each condition and "
                      "standard had {} track{}{} of {}{} trials with a difference. {}",
                      procedure->sides.front() == 0
                          ? "the comparison, down where it was said to have more and up where it was not"
                          : "the difference from the standard",
                      procedure->clamp[0], procedure->clamp[1], unit, procedure_words(*procedure, protocol),
                      procedure->starts.size(), plural(procedure->starts.size()), session_words(design),
                      can_end_early(*procedure) ? "at most " : "", procedure->trials, task.arrangement(protocol));
  return text + fmt::format("Each level was presented {} time{} in every condition{}, in random order. {}",
                            design.trials_per_cell, plural(static_cast<std::size_t>(design.trials_per_cell)),
                            session_words(design), task.arrangement(protocol));
}

}  // namespace

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

std::string design_paragraph(const Protocol& protocol, const StudyResults& results) {
  const bool pairs = task_of(protocol.task.kind).has_pairs();
  return task_words(protocol, results) + group_sentences(protocol) +
         (pairs ? pair_sentences(protocol) : comparison_sentences(protocol)) + order_sentences(protocol);
}

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
      results.attendance.participants, to_string(results.attendance.kind),
      results.attendance.participants == 1 ? "" : "s", objects, plural(objects), list_of(names),
      protocol.conditions.size(), plural(protocol.conditions.size()), list_of(conditions), explore.duration_s,
      kGeneratorName, protocol.stimulus.reference, to_string(protocol.stimulus.unit));
}

}  // namespace jnd
