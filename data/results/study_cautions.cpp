#include "data/results/study_cautions.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/fields/number_text.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/level_source.h"

namespace jnd {

namespace {

const char* plural(int n) {
  return n == 1 ? "" : "s";
}

std::string share(int part, int whole) {
  return fmt::format("{} of {} ({:.0f} %)", part, whole, 100.0 * part / std::max(whole, 1));
}

std::string names(const std::vector<LeftOut>& left_out) {
  std::string text;
  for (std::size_t i = 0; i < left_out.size() && i < 5; ++i)
    text += fmt::format("{}{} ({})", i == 0 ? "" : ", ", left_out[i].participant, left_out[i].reason);
  if (left_out.size() > 5) text += fmt::format(" and {} more", left_out.size() - 5);
  return text;
}

void add_missing_deviations(const TaskResults& task, std::vector<std::string>& out) {
  int cells = 0, missing = 0;
  const auto add = [&](int of_cell) {
    cells += of_cell > 0 ? 1 : 0;
    missing += of_cell;
  };
  if (task.cells.empty())
    for (const TaskEstimateRow& row : task.estimates) add(row.missing);
  else
    for (const CellResult& cell : task.cells) add(cell.missing);
  if (missing > 0)
    out.push_back(fmt::format("{} planned trial{} of {} cell{} {} not answered.", missing, plural(missing), cells,
                              plural(cells), missing == 1 ? "was" : "were"));
  for (const auto& [reason, trials] : task.exclusions)
    out.push_back(
        fmt::format("{} trial{} excluded by the registered rule {}.", trials, trials == 1 ? " was" : "s were", reason));
}

void add_rate_cautions(const TaskResults& task, std::vector<std::string>& out) {
  int cells = 0, extreme = 0, negative = 0, few = 0;
  for (const CellResult& cell : task.cells) {
    if (cell.yes_no.status == RateStatus::missing) continue;
    const Counts& c = cell.counts;
    ++cells;
    extreme += c.hits == 0 || c.hits == c.n_diff || c.false_alarms == 0 || c.false_alarms == c.n_same ? 1 : 0;
    negative += cell.yes_no.dprime <= 0 ? 1 : 0;
    few += std::min(c.n_diff, c.n_same) < 10 ? 1 : 0;
  }
  if (cells == 0) return;
  if (few > 0)
    out.push_back(fmt::format("{} cells have fewer than 10 trials of a class: single d' and JNDs scatter widely.",
                              share(few, cells)));
  if (10 * extreme > cells)
    out.push_back(fmt::format("{} cells have a rate of 0 or 1: their d' rests on the correction, not on the answers.",
                              share(extreme, cells)));
  if (20 * negative > cells) out.push_back(fmt::format("{} cells have a d' of 0 or below.", share(negative, cells)));
}

// Of JNDs of pairs.
void add_pair_cautions(const TaskResults& task, const Protocol& protocol, std::vector<std::string>& out) {
  if (task.cells.empty()) return;
  int thresholds = 0, extrapolated = 0, ok = 0;
  for (const TaskEstimateRow& row : task.estimates) {
    const std::vector<std::string>& cautions = row.estimates.cautions;
    ++thresholds;
    ok += row.estimates.status == "ok" ? 1 : 0;
    extrapolated += std::find(cautions.begin(), cautions.end(), "extrapolated") != cautions.end() ? 1 : 0;
  }
  if (ok < thresholds)
    out.push_back(fmt::format("{} thresholds have no JND; the mean JND leaves them out, the median does not.",
                              share(thresholds - ok, thresholds)));
  if (5 * extrapolated > thresholds)
    out.push_back(fmt::format("{} JNDs lie outside the tested differences: they are extrapolated along the line.",
                              share(extrapolated, thresholds)));
  if (!task.pairs.intervals)
    out.push_back(fmt::format("Above {} participants single JNDs carry no bootstrap interval.", kMostInDetail));
  int not_measured = 0;
  for (const TaskGroupRow& row : task.group)
    not_measured += row.outcome == 0 && row.difference_source != task.pairs.by ? 1 : 0;
  if (not_measured > 0)
    out.push_back(
        fmt::format("{} of {} conditions rest on nominal differences at least in part: nothing was delivered "
                    "there that has a stiffness to fit.",
                    not_measured, protocol.conditions.size()));
}

// What thresholds by a procedure rest on: some of the tracks, perhaps the upper or the lower ones only, and a prior, with
// which they differ less than what they estimate.
void add_procedure_cautions(const StudyResults& results, bool tested, const Protocol& protocol,
                            std::vector<std::string>& out) {
  constexpr double kLittle = 0.1;
  TrackCount tracks;
  int lost = 0, thresholds = 0, of_fewer = 0, estimates = 0, heavy = 0;
  double most = 0;
  const auto add = [&](const TrackCount& one, bool ok, double weight) {
    tracks.all += one.all;
    tracks.unfinished += one.unfinished;
    lost += one.used > 0 ? one.all - one.used : 0;
    thresholds += one.used > 0 ? 1 : 0;
    of_fewer += one.used > 0 && one.used < one.all ? 1 : 0;
    estimates += ok ? 1 : 0;
    heavy += ok && weight > kLittle ? 1 : 0;
    if (ok) most = std::max(most, weight);
  };
  for (const TaskEstimateRow& row : results.task.estimates) {
    const TaskEstimate& one = row.estimates.values[results.task.registered];
    add(row.estimates.tracks, one.value.has_value(), one.prior_weight);
  }
  if (tracks.unfinished > 0)
    out.push_back(
        fmt::format("{} tracks did not end: they have fewer than {} reversals, and {} (analysis.unfinished_tracks).",
                    share(tracks.unfinished, tracks.all), protocol.design.procedure->averaged_reversals,
                    protocol.analysis.unfinished_tracks == UnfinishedTracks::use ? "count with those that they have"
                                                                                 : "are left out"));
  if (lost > 0)
    out.push_back(fmt::format(
        "{} tracks have no threshold; {} of {} thresholds rest on the other tracks of their condition alone.",
        share(lost, tracks.all), of_fewer, thresholds));
  if (tested && heavy > 0)
    out.push_back(fmt::format(
        "In {} estimates that the tests compare, the procedure's prior has more than 10 % of the weight (at most {:.0f} %) "
        "and pulls them towards its mean: conditions and groups differ less in them than they do.{}",
        share(heavy, estimates), 100 * most,
        task_of(protocol.task.kind).answer_model(protocol)
            ? " The hierarchical model (jnd analyze --tests) compares conditions without that pull."
            : ""));
}

void add_test_cautions(const OutcomeComparison& outcome, const Protocol& protocol, std::vector<std::string>& out) {
  if (!outcome.refused.empty()) return;
  const Comparison& comparison = outcome.comparison;
  const bool anova = protocol.analysis.tests.omnibus == Omnibus::anova;
  if (anova && comparison.residuals.status == StatisticStatus::ok && comparison.residuals.p < 0.05)
    out.push_back(
        fmt::format("The residuals of the analysis of variance are not normal (Shapiro-Wilk W = {:.3f}, "
                    "{}): look at Friedman's test and the Wilcoxon tests beside it.",
                    comparison.residuals.w, p_text(comparison.residuals.p)));
  const Mauchly& mauchly = comparison.anova.effect.mauchly;
  if (anova && mauchly.status == StatisticStatus::ok && mauchly.p < 0.05)
    out.push_back(
        fmt::format("Sphericity is violated (Mauchly W = {:.3f}, {}): read the p with the "
                    "Greenhouse-Geisser correction.",
                    mauchly.w, p_text(mauchly.p)));
  if (protocol.analysis.tests.post_hoc == PostHoc::games_howell || protocol.analysis.tests.post_hoc == PostHoc::tukey)
    out.emplace_back(
        "The registered post-hoc test ignores that every participant had every condition; the paired t tests "
        "stand beside it.");
  if (outcome.table.n < 6) out.push_back(fmt::format("The tests rest on {} participants.", outcome.table.n));
}

}  // namespace

std::vector<std::string> deviations_of(const StudyResults& results, const Protocol& protocol) {
  std::vector<std::string> out;
  const Attendance& attendance = results.attendance;
  const PairMethod& pairs = results.task.pairs;
  if (!results.task.cells.empty() && pairs.by != registered_source(protocol))
    out.push_back(fmt::format("The protocol registers slopes over {} stiffness differences; these are over {} ones.",
                              to_string(registered_source(protocol)), to_string(pairs.by)));
  const Exclusions& rules = protocol.analysis.exclude;
  if (!levels_given(protocol) && (rules.response_time_below_s || rules.response_time_above_s ||
                                  rules.saturated_share_above || rules.off_prescription))
    out.emplace_back(
        "The registered exclusions are not applied: an excluded answer has moved the levels all the same.");
  if (results.off_prescription > 0)
    out.push_back(fmt::format("{} answered trial{} broke the prescription of how to explore.", results.off_prescription,
                              plural(results.off_prescription)));
  if (!attendance.excluded.empty()) {
    std::string who;
    for (const ExcludedParticipant& one : attendance.excluded)
      who += fmt::format("{}{} ({})", who.empty() ? "" : ", ", one.participant, one.reason);
    out.push_back(fmt::format("Participants excluded: {}.", who));
  }
  int open = 0;
  for (const SessionHead& head : attendance.heads) open += head.closed ? 0 : 1;
  if (open > 0)
    out.push_back(fmt::format("{} of {} sessions {} not finished: these numbers are not final.", open,
                              attendance.heads.size(), open == 1 ? "is" : "are"));
  std::vector<std::string> unblinded;
  for (const SessionHead& head : attendance.heads)
    if (head.unblinded) unblinded.push_back(head.participant);
  if (!unblinded.empty())
    out.push_back(fmt::format(
        "The operator saw the forces of the trials, and so the stimuli, in {} of {} session{}: {}.", unblinded.size(),
        attendance.heads.size(), plural(static_cast<int>(attendance.heads.size())), fmt::join(unblinded, ", ")));
  if (attendance.kind == SessionKind::real && attendance.participants != protocol.design.participants)
    out.push_back(fmt::format("{} participant{} took part; {} {} planned.", attendance.participants,
                              plural(attendance.participants), protocol.design.participants,
                              protocol.design.participants == 1 ? "was" : "were"));
  add_missing_deviations(results.task, out);
  if (const OutcomeComparison* outcome = results.registered()) {
    if (!outcome->refused.empty() && protocol.conditions.size() > 1)
      out.push_back(fmt::format("The registered tests on the {} were refused: {}.", outcome->title, outcome->refused));
    else if (!outcome->left_out.empty())
      out.push_back(fmt::format("The registered tests leave out {} of {} participants: {}.", outcome->left_out.size(),
                                attendance.participants, names(outcome->left_out)));
  }
  if (results.groups && results.groups->test != BetweenTest::none) {
    const GroupsCompared& groups = *results.groups;
    if (!groups.refused.empty())
      out.push_back(fmt::format("The registered test of the groups was refused: {}.", groups.refused));
    else if (!groups.left_out.empty())
      out.push_back(fmt::format("The registered test of the groups leaves out {} of {} participants: {}.",
                                groups.left_out.size(), attendance.participants, names(groups.left_out)));
  }
  for (const std::string& one : exposure_deviations(results.exploration, protocol)) out.push_back(one);
  return out;
}

std::vector<std::string> cautions_of(const StudyResults& results, const Protocol& protocol) {
  std::vector<std::string> out;
  add_rate_cautions(results.task, out);
  add_pair_cautions(results.task, protocol, out);
  const OutcomeComparison* outcome = results.registered();
  const bool tested = (outcome != nullptr && outcome->refused.empty()) || (results.groups && results.groups->tested());
  add_procedure_cautions(results, tested, protocol, out);
  if (outcome != nullptr) add_test_cautions(*outcome, protocol, out);
  if (protocol.analysis.hierarchical && results.hierarchical)
    out.insert(out.end(), results.hierarchical->cautions.begin(), results.hierarchical->cautions.end());
  if (results.groups && results.groups->tested() && results.groups->test == BetweenTest::mixed_anova &&
      results.groups->comparison.anova.unequal)
    out.emplace_back(
        "The groups differ in size: the sums of squares of the mixed analysis of variance are of type I, so that the "
        "larger group decides more about the conditions.");
  return out;
}

}  // namespace jnd
