#include "data/results/study_comparisons.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "analysis/group/p_adjust.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

namespace {

const std::string& condition_name(const Protocol& protocol, std::size_t place) {
  return protocol.conditions[place].name;
}

// Fills the table with the participants who have a finite value under every condition. rows: how many participants;
// value(row, condition); why(row, condition): the reason where the value is not finite.
void fill(OutcomeComparison& outcome, std::size_t rows, const Protocol& protocol,
          const std::function<const std::string&(std::size_t)>& name,
          const std::function<double(std::size_t, std::size_t)>& value,
          const std::function<std::string(std::size_t, std::size_t)>& why) {
  outcome.table.k = protocol.conditions.size();
  for (std::size_t row = 0; row < rows; ++row) {
    std::vector<double> values;
    std::string reason;
    for (std::size_t condition = 0; condition < outcome.table.k; ++condition) {
      values.push_back(value(row, condition));
      if (!std::isfinite(values.back()))
        reason += fmt::format("{}{}: {}", reason.empty() ? "" : ", ", condition_name(protocol, condition),
                              why(row, condition));
    }
    if (!reason.empty()) {
      outcome.left_out.push_back({name(row), reason});
      continue;
    }
    outcome.participants.push_back(name(row));
    outcome.table.values.insert(outcome.table.values.end(), values.begin(), values.end());
    ++outcome.table.n;
  }
}

void test(OutcomeComparison& outcome) {
  if (outcome.refused.empty() && outcome.table.k < 2) outcome.refused = "one condition has nothing to be compared with";
  if (outcome.refused.empty() && outcome.table.n < 2)
    outcome.refused = fmt::format("{} complete participant{}: at least 2 are needed", outcome.table.n,
                                  outcome.table.n == 1 ? "" : "s");
  if (outcome.refused.empty()) outcome.comparison = compare(outcome.table);
}

double outcome_of(const JndEstimate& estimate, Outcome outcome) {
  if (outcome == Outcome::slope) return estimate.slope;
  if (estimate.status != JndStatus::ok) return kNaN;
  return outcome == Outcome::jnd ? estimate.jnd : std::log(estimate.jnd);
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

std::string_view to_string(Outcome outcome) noexcept {
  constexpr auto kWords =
      words<Outcome>({{"slope", Outcome::slope}, {"jnd", Outcome::jnd}, {"log_jnd", Outcome::log_jnd}});
  return word_of(kWords, outcome);
}

OutcomeComparison compare_thresholds(const std::vector<ThresholdResult>& thresholds, const Protocol& protocol,
                                     Outcome outcome) {
  const std::size_t conditions = protocol.conditions.size();
  const std::string unit(to_string(protocol.stimulus.unit));
  OutcomeComparison result;
  result.outcome = to_string(outcome);
  if (outcome == Outcome::slope) {
    result.title = "slope of d' on the stiffness difference";
    result.unit = "per " + unit;
  } else {
    result.title = outcome == Outcome::jnd ? "JND" : fmt::format("ln(JND / {})", unit);
    result.unit = outcome == Outcome::jnd ? unit : "";
  }
  const auto row_of = [&](std::size_t row, std::size_t condition) -> const ThresholdResult& {
    return thresholds[row * conditions + condition];
  };
  fill(
      result, thresholds.size() / conditions, protocol,
      [&](std::size_t row) -> const std::string& { return row_of(row, 0).participant; },
      [&](std::size_t row, std::size_t condition) { return outcome_of(row_of(row, condition).jnd, outcome); },
      [&](std::size_t row, std::size_t condition) {
        return std::string(to_string(row_of(row, condition).jnd.status));
      });
  // 1/m of a shallow slope is anything at all: leaving those participants out would pick the good ones.
  if (outcome != Outcome::slope && !result.left_out.empty())
    result.refused =
        fmt::format("tests on the JND need a JND of everyone; without one: {}", joined_names(result.left_out));
  test(result);
  return result;
}

OutcomeComparison compare_adaptive(const std::vector<AdaptiveRow>& rows, const Protocol& protocol) {
  const std::size_t conditions = protocol.conditions.size();
  std::vector<const AdaptiveRow*> whole;  // by participant, condition
  for (const AdaptiveRow& row : rows)
    if (row.track == 0) whole.push_back(&row);
  OutcomeComparison result;
  result.outcome = "threshold";
  result.title = "adaptive threshold";
  result.unit = to_string(protocol.stimulus.unit);
  fill(
      result, whole.size() / conditions, protocol,
      [&](std::size_t row) -> const std::string& { return whole[row * conditions]->participant; },
      [&](std::size_t row, std::size_t condition) {
        const AdaptiveThreshold& threshold = whole[row * conditions + condition]->threshold;
        return threshold.status == AdaptiveStatus::ok ? threshold.threshold : kNaN;
      },
      [&](std::size_t row, std::size_t condition) {
        return std::string(to_string(whole[row * conditions + condition]->threshold.status));
      });
  if (!result.left_out.empty())
    result.refused =
        fmt::format("tests on thresholds need one of everyone; without one: {}", joined_names(result.left_out));
  test(result);
  return result;
}

OutcomeComparison compare_task(const TaskResults& results, const Protocol& protocol) {
  const TaskOutcome& outcome = results.outcomes[results.registered];
  const bool logarithm = protocol.analysis.tests.outcome == Outcome::log_jnd;
  const std::size_t conditions = protocol.conditions.size(), each = conditions * protocol.series.size();
  OutcomeComparison result;
  result.outcome = (logarithm ? "ln_" : "") + std::string(outcome.key);
  result.title = logarithm ? fmt::format("logarithm of the {}", outcome.title) : std::string(outcome.title);
  result.unit = logarithm ? "" : std::string(outcome.unit);
  fill(
      result, participants_of(results, protocol), protocol,
      [&](std::size_t row) -> const std::string& { return results.estimates[row * each].participant; },
      [&](std::size_t row, std::size_t condition) {
        return registered_value(results, protocol, row, static_cast<int>(condition));
      },
      [&](std::size_t row, std::size_t condition) {
        for (std::size_t series = 0; series < protocol.series.size(); ++series) {
          const TaskEstimates& estimates =
              results.estimates[row * each + condition * protocol.series.size() + series].estimates;
          if (estimates.status != "ok") return estimates.status;
        }
        return std::string("no value");
      });
  // Leaving out who has none would pick the good ones.
  if (!result.left_out.empty())
    result.refused = fmt::format("tests on the {} need a value of everyone; without one: {}", outcome.title,
                                 joined_names(result.left_out));
  test(result);
  return result;
}

OutcomeComparison compare_times(const std::vector<ThresholdResult>& thresholds, const Protocol& protocol) {
  const std::size_t conditions = protocol.conditions.size();
  OutcomeComparison result;
  result.outcome = "trial_time";
  result.title = "time per trial";
  result.unit = "s";
  fill(
      result, thresholds.size() / conditions, protocol,
      [&](std::size_t row) -> const std::string& { return thresholds[row * conditions].participant; },
      [&](std::size_t row, std::size_t condition) { return thresholds[row * conditions + condition].mean_trial_s; },
      [](std::size_t, std::size_t) { return "no counted trial"; });
  test(result);
  return result;
}

OutcomeComparison compare_ratings(const RatedQuestion& ratings, const std::vector<std::string>& participants,
                                  const Protocol& protocol) {
  const Question& question = protocol.questions[static_cast<std::size_t>(ratings.question)];
  OutcomeComparison result;
  result.outcome = question.id;
  result.title = question.text;
  result.question = true;
  fill(
      result, participants.size(), protocol, [&](std::size_t row) -> const std::string& { return participants[row]; },
      [&](std::size_t row, std::size_t condition) {
        return ratings.ratings[row * protocol.conditions.size() + condition];
      },
      [](std::size_t, std::size_t) { return "no answer"; });
  test(result);
  return result;
}

SeriesComparison compare_series(const std::vector<CellResult>& cells, const Protocol& protocol) {
  SeriesComparison result;
  TwoWayTable table;
  table.a = protocol.conditions.size();
  table.b = protocol.series.size();
  const std::size_t each = table.a * table.b;
  for (std::size_t first = 0; first + each <= cells.size(); first += each) {
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
