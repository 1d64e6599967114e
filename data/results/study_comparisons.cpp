#include "data/results/study_comparisons.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include <fmt/format.h>

#include "analysis/group/p_adjust.h"
#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "protocols/planning/allotment.h"

namespace jnd {

namespace {

const std::string& condition_name(const Protocol& protocol, std::size_t place) {
  return protocol.conditions[place].name;
}

// Fills the table with the participants who have a finite value under every condition. rows: how many participants;
// value(row, condition); why(row, condition): the reason where the value is not finite. Neither is asked for conditions
// that a participant's group does not get.
void fill(OutcomeComparison& outcome, std::size_t rows, const Protocol& protocol,
          const std::function<const std::string&(std::size_t)>& name,
          const std::function<std::optional<int>(std::size_t)>& group,
          const std::function<double(std::size_t, std::size_t)>& value,
          const std::function<std::string(std::size_t, std::size_t)>& why) {
  outcome.crossed = everyone_has_all(protocol);
  outcome.table.k = protocol.conditions.size();
  for (std::size_t row = 0; row < rows; ++row) {
    ParticipantValues one{name(row), group(row), std::vector<double>(outcome.table.k, kNaN), ""};
    const std::vector<int> own = conditions_of(protocol, one.group);
    if (own.size() < outcome.table.k) one.gets.assign(outcome.table.k, false);
    for (const int place : own) {
      const auto condition = static_cast<std::size_t>(place);
      if (!one.gets.empty()) one.gets[condition] = true;
      one.values[condition] = value(row, condition);
      if (!std::isfinite(one.values[condition]))
        one.missing += fmt::format("{}{}: {}", one.missing.empty() ? "" : ", ", condition_name(protocol, condition),
                                   why(row, condition));
    }
    outcome.everyone.push_back(std::move(one));
    const ParticipantValues& known = outcome.everyone.back();
    if (own.size() < outcome.table.k) continue;
    if (!known.missing.empty()) {
      outcome.left_out.push_back({known.participant, known.missing});
      continue;
    }
    outcome.participants.push_back(known.participant);
    outcome.table.values.insert(outcome.table.values.end(), known.values.begin(), known.values.end());
    ++outcome.table.n;
  }
}

// The same of estimates. first: at the first standard.
void fill(OutcomeComparison& outcome, const std::vector<ParticipantRows>& rows, const Protocol& protocol,
          const std::function<double(const TaskEstimateRow&)>& value,
          const std::function<std::string(const TaskEstimateRow&)>& why) {
  fill(
      outcome, rows.size(), protocol, [&](std::size_t row) -> const std::string& { return rows[row].participant; },
      [&](std::size_t row) { return rows[row].group; },
      [&](std::size_t row, std::size_t condition) {
        const TaskEstimateRow* const first = rows[row].of[condition];
        return first == nullptr ? kNaN : value(*first);
      },
      [&](std::size_t row, std::size_t condition) {
        const TaskEstimateRow* const first = rows[row].of[condition];
        return first == nullptr ? std::string("no value") : why(*first);
      });
}

PairTest pair_test(PostHoc test) noexcept {
  switch (test) {
    case PostHoc::holm_t:
      return PairTest::paired_t;
    case PostHoc::games_howell:
      return PairTest::games_howell;
    case PostHoc::tukey:
      return PairTest::tukey;
    case PostHoc::wilcoxon:
      break;
  }
  return PairTest::wilcoxon;
}

// pairs: only those, by this test; none: everything.
void test(OutcomeComparison& outcome, std::optional<PostHoc> pairs = std::nullopt) {
  if (outcome.refused.empty() && outcome.table.k < 2) outcome.refused = "one condition has nothing to be compared with";
  if (outcome.refused.empty() && outcome.table.n < 2 && !outcome.crossed && outcome.left_out.empty())
    outcome.refused = "groups of participants get different conditions: fewer than 2 participants get them all";
  if (outcome.refused.empty() && outcome.table.n < 2)
    outcome.refused = fmt::format("{} complete participant{}: at least 2 are needed", outcome.table.n,
                                  outcome.table.n == 1 ? "" : "s");
  if (!pairs && outcome.table.n > 1 && outcome.table.k > 1) outcome.within = summaries_of(outcome.table);
  if (outcome.share)
    for (ConditionSummary& one : outcome.within) keep_within_0_and_1(one.ci_within_low, one.ci_within_high);
  if (!outcome.refused.empty()) return;
  outcome.comparison = pairs ? compare_pairs(outcome.table, pair_test(*pairs)) : compare(outcome.table);
}

void test(OutcomeComparison& outcome, Compared compared, const Protocol& protocol) {
  test(outcome, compared == Compared::contrasts ? std::optional(protocol.analysis.tests.post_hoc) : std::nullopt);
}

// Of a participant's values under the conditions of their group; NaN where one is missing.
double mean_over_own(const ParticipantValues& one) {
  if (!one.missing.empty()) return kNaN;
  double sum = 0;
  int n = 0;
  for (const double value : one.values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++n;
  }
  return n > 0 ? sum / n : kNaN;
}

std::string joined_names(const std::vector<LeftOut>& left_out) {
  std::string names;
  const std::size_t shown = std::min<std::size_t>(left_out.size(), 8);
  for (std::size_t i = 0; i < shown; ++i)
    names += fmt::format("{}{} ({})", i == 0 ? "" : "; ", left_out[i].participant, left_out[i].reason);
  if (shown < left_out.size()) names += fmt::format("; and {} more", left_out.size() - shown);
  return names;
}

}  // namespace

std::string_view to_string(BetweenTest test) noexcept {
  constexpr auto kWords = words<BetweenTest>({{"none", BetweenTest::none},
                                              {"welch", BetweenTest::welch},
                                              {"mann-whitney", BetweenTest::mann_whitney},
                                              {"mixed-anova", BetweenTest::mixed_anova}});
  return word_of(kWords, test);
}

std::string_view to_string(PostHoc test) noexcept {
  constexpr auto kWords = words<PostHoc>({{"holm-t", PostHoc::holm_t},
                                          {"games-howell", PostHoc::games_howell},
                                          {"tukey", PostHoc::tukey},
                                          {"wilcoxon", PostHoc::wilcoxon}});
  return word_of(kWords, test);
}

std::string compared_title(const TaskOutcome& outcome, const Protocol& protocol) {
  const std::string title(outcome.title);
  if (protocol.analysis.standard >= 0) return fmt::format("{} at {}", title, compared_standard(protocol));
  const std::size_t standards = judged_standard_count(protocol);
  return standards > 1 ? fmt::format("{}, mean over {} standards", title, standards) : title;
}

std::string compared_standard(const Protocol& protocol) {
  const int one = protocol.analysis.standard;
  return one < 0 ? "all" : protocol.series[static_cast<std::size_t>(one)].name;
}

OutcomeComparison compare_task(const TaskResults& results, const Protocol& protocol, Compared compared) {
  const TaskOutcome& outcome = results.outcomes[results.registered];
  OutcomeComparison result;
  result.outcome = (results.logarithm ? "ln_" : "") + std::string(outcome.key);
  result.title = (results.logarithm ? "logarithm of the " : "") + compared_title(outcome, protocol);
  result.unit = results.logarithm ? "" : outcome.unit;
  result.standard = compared_standard(protocol);
  result.may_lack = outcome.may_lack;
  result.share = outcome.share && !results.logarithm;
  fill(
      result, by_participant(results.estimates, protocol.conditions.size()), protocol,
      [&](const TaskEstimateRow& first) { return registered_value(first, results, protocol); },
      [&](const TaskEstimateRow& first) {
        for (const TaskEstimateRow& row : compared_standards(first, protocol))
          if (row.estimates.status != "ok") return row.estimates.status;
        return std::string("no value");
      });
  // Leaving out who has none would pick the good ones.
  if (!result.may_lack && !result.left_out.empty())
    result.refused = fmt::format("tests on the {} need a value of everyone; without one: {}", outcome.title,
                                 joined_names(result.left_out));
  test(result, compared, protocol);
  return result;
}

OutcomeComparison compare_times(const TaskResults& results, const Protocol& protocol) {
  OutcomeComparison result;
  result.outcome = "trial_time";
  result.title = "time per trial";
  result.unit = "s";
  fill(
      result, by_participant(results.estimates, protocol.conditions.size()), protocol,
      [&](const TaskEstimateRow& first) {
        double sum = 0;
        int trials = 0;
        for (const TaskEstimateRow& row : standards_from(first, protocol)) {
          if (!row.mean_trial_s) continue;
          sum += row.trials * *row.mean_trial_s;
          trials += row.trials;
        }
        return trials > 0 ? sum / trials : kNaN;
      },
      [](const TaskEstimateRow&) { return std::string("no counted trial"); });
  test(result);
  return result;
}

OutcomeComparison compare_ratings(const RatedQuestion& ratings, const std::vector<std::string>& participants,
                                  const Protocol& protocol, const std::vector<std::optional<int>>& groups) {
  const Question& question = protocol.questions[static_cast<std::size_t>(ratings.question)];
  OutcomeComparison result;
  result.outcome = question.id;
  result.title = question.text;
  result.question = true;
  fill(
      result, participants.size(), protocol, [&](std::size_t row) -> const std::string& { return participants[row]; },
      [&](std::size_t row) { return row < groups.size() ? groups[row] : std::nullopt; },
      [&](std::size_t row, std::size_t condition) {
        return ratings.ratings[row * protocol.conditions.size() + condition];
      },
      [](std::size_t, std::size_t) { return "no answer"; });
  test(result);
  return result;
}

namespace {

// Over the participants who have a value, and how many there are.
GroupMean group_mean(const OutcomeComparison& outcome, int group, int condition) {
  GroupMean row;
  row.group = group;
  row.condition = condition;
  std::vector<double> values;
  for (const ParticipantValues& one : outcome.everyone) {
    if (one.group != group) continue;
    ++row.participants;
    const double value = condition < 0 ? mean_over_own(one) : one.values[static_cast<std::size_t>(condition)];
    if (std::isfinite(value)) values.push_back(value);
  }
  row.mean = mean_with_ci(values);
  if (outcome.share) keep_within_0_and_1(row.mean.ci_low, row.mean.ci_high);
  row.median = median_of(values);
  row.shapiro = shapiro_wilk(values);
  return row;
}

void add_means(GroupsCompared& result, const OutcomeComparison& outcome, const Protocol& protocol) {
  for (int group = 0; group < group_count(protocol); ++group) {
    const std::vector<int> own = conditions_of(protocol, group);
    for (const int condition : own) result.means.push_back(group_mean(outcome, group, condition));
    if (own.size() > 1) result.means.push_back(group_mean(outcome, group, -1));
  }
}

// Rows of those who have a value under each of their conditions.
void add_tested(GroupsCompared& result, const OutcomeComparison& outcome, const Protocol& protocol) {
  const bool mixed = result.test == BetweenTest::mixed_anova;
  const std::vector<int> own = conditions_of(protocol, 0);  // of mixed_anova those of every group
  result.table.groups = protocol.groups.size();
  result.table.values.k = mixed ? own.size() : 1;
  for (const ParticipantValues& one : outcome.everyone) {
    if (!one.group || !one.missing.empty()) {
      result.left_out.push_back({one.participant, one.group ? one.missing : "no group"});
      continue;
    }
    if (!mixed) result.table.values.values.push_back(mean_over_own(one));
    for (std::size_t i = 0; mixed && i < own.size(); ++i)
      result.table.values.values.push_back(one.values[static_cast<std::size_t>(own[i])]);
    result.table.group.push_back(static_cast<std::size_t>(*one.group));
    result.participants.push_back(one.participant);
    ++result.table.values.n;
  }
}

}  // namespace

GroupsCompared compare_groups(const OutcomeComparison& registered, const Protocol& protocol) {
  GroupsCompared result;
  result.outcome = registered.outcome;
  result.title = registered.title;
  result.unit = registered.unit;
  result.standard = registered.standard;
  result.test = protocol.analysis.tests.between;
  add_means(result, registered, protocol);
  if (result.test == BetweenTest::none) return result;
  add_tested(result, registered, protocol);
  const std::set<std::size_t> groups(result.table.group.begin(), result.table.group.end());
  if (!result.left_out.empty() && !registered.may_lack)
    result.refused = fmt::format("a comparison of the groups' {} needs a value of everyone; without one: {}",
                                 result.title, joined_names(result.left_out));
  else if (groups.size() < 2)
    result.refused = "fewer than two groups have a participant";
  else
    result.comparison = compare_groups(result.table);
  return result;
}

SeriesComparison compare_series(const std::vector<CellResult>& cells, const Protocol& protocol) {
  SeriesComparison result;
  TwoWayTable table;
  table.a = protocol.conditions.size();
  table.b = protocol.series.size();
  const std::size_t each = table.a * table.b;
  const auto whole = [&](std::size_t first) {  // a participant who gets every condition
    return first + each <= cells.size() && cells[first].participant == cells[first + each - 1].participant;
  };
  for (std::size_t first = 0; first < cells.size(); first += whole(first) ? each : table.b) {
    if (!whole(first)) continue;
    std::string reason;
    for (std::size_t i = first; i < first + each && reason.empty(); ++i)
      if (!std::isfinite(cells[i].yes_no.dprime))
        reason =
            fmt::format("{}, series {}: {}", condition_name(protocol, static_cast<std::size_t>(cells[i].condition)),
                        protocol.series[static_cast<std::size_t>(cells[i].series)].name,
                        cells[i].yes_no.status == RateStatus::ok ? "infinite d'" : to_string(cells[i].yes_no.status));
    if (!reason.empty()) {
      result.left_out.push_back({cells[first].participant, reason});
      continue;
    }
    for (std::size_t i = first; i < first + each; ++i) table.values.push_back(cells[i].yes_no.dprime);
    ++table.n;
  }
  result.n = static_cast<int>(table.n);
  if (table.a < 2 || table.b < 2)
    result.refused = "needs at least two conditions and two series";
  else if (table.n < 2)
    result.refused = fmt::format("{} complete participant{}: at least 2 are needed", table.n, table.n == 1 ? "" : "s");
  else
    result.test = two_way_within(table);
  return result;
}

namespace {

double p_within(const std::vector<double>& a, const std::vector<double>& b, PostHoc test, std::size_t conditions) {
  switch (test) {
    case PostHoc::holm_t:
      return paired_t(a, b).p;
    case PostHoc::wilcoxon:
      return signed_rank(a, b).p;
    case PostHoc::games_howell:
      return games_howell(a, b, static_cast<int>(conditions)).p;
    case PostHoc::tukey:
      break;
  }
  return kNaN;
}

}  // namespace

std::vector<ContrastWithin> contrasts_within(const OutcomeComparison& outcome, const Protocol& protocol) {
  const PostHoc test = protocol.analysis.tests.post_hoc;
  std::vector<ContrastWithin> all;
  std::vector<double> p;
  for (const Contrast& contrast : protocol.analysis.contrasts) {
    ContrastWithin one;
    std::vector<double> a, b;
    for (const ParticipantValues& row : outcome.everyone) {
      if (!has_condition(protocol, row.group, contrast.a) || !has_condition(protocol, row.group, contrast.b)) continue;
      ++one.participants;
      const double of_a = row.values[static_cast<std::size_t>(contrast.a)];
      const double of_b = row.values[static_cast<std::size_t>(contrast.b)];
      if (!std::isfinite(of_a) || !std::isfinite(of_b)) continue;
      a.push_back(of_a);
      b.push_back(of_b);
      one.differences.push_back(of_a - of_b);
    }
    const auto n = static_cast<int>(a.size());
    if (test == PostHoc::tukey)
      one.refused = "Tukey's test needs every condition of every participant";
    else if (n < one.participants && !outcome.may_lack)
      one.refused = fmt::format("{} of the {} who get both have no value", one.participants - n, one.participants);
    else if (n < 2)
      one.refused = fmt::format("{} get both: at least 2 are needed", n);
    else
      one.p = p_within(a, b, test, protocol.conditions.size());
    p.push_back(one.p);
    all.push_back(std::move(one));
  }
  if (test == PostHoc::holm_t || test == PostHoc::wilcoxon) p = holm(p);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].p = p[i];
  return all;
}

PairPlace pair_of(const Contrast& contrast, std::size_t conditions) noexcept {
  const auto low = static_cast<std::size_t>(std::min(contrast.a, contrast.b));
  const auto high = static_cast<std::size_t>(std::max(contrast.a, contrast.b));
  // Pairs come as (0,1), (0,2), ..., (1,2), ...
  return {low * conditions - low * (low + 1) / 2 + (high - low - 1), contrast.a > contrast.b};
}

std::vector<double> contrast_p(const Comparison& comparison, const AnalysisPlan& plan) {
  std::vector<double> p;
  for (const Contrast& contrast : plan.contrasts) {
    const PairPlace place = pair_of(contrast, comparison.k);
    if (place.pair >= comparison.pairs.size()) {
      p.push_back(kNaN);
      continue;
    }
    const PairComparison& pair = comparison.pairs[place.pair];
    switch (plan.tests.post_hoc) {
      case PostHoc::holm_t:
        p.push_back(pair.t.p);
        break;
      case PostHoc::games_howell:
        p.push_back(pair.games_howell.p);
        break;
      case PostHoc::tukey:
        p.push_back(pair.tukey.p);
        break;
      case PostHoc::wilcoxon:
        p.push_back(pair.wilcoxon.p);
        break;
    }
  }
  const bool adjusted = plan.tests.post_hoc == PostHoc::holm_t || plan.tests.post_hoc == PostHoc::wilcoxon;
  return adjusted ? holm(p) : p;
}

double omnibus_p(const Comparison& comparison, const AnalysisPlan& plan) noexcept {
  switch (plan.tests.omnibus) {
    case Omnibus::anova:
      return comparison.anova.effect.p_gg;
    case Omnibus::friedman:
      return comparison.friedman.p;
    case Omnibus::none:
      break;
  }
  return kNaN;
}

}  // namespace jnd
