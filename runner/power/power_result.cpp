#include "runner/power/power_result.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/binomial.h"
#include "protocols/planning/allotment.h"

namespace jnd {

namespace {

Simulated share(std::int64_t count, std::int64_t of) {
  if (of == 0) return {};
  const ExactProportion found = exact_proportion(static_cast<int>(count), static_cast<int>(of));
  const double p = found.share;
  return {p, p > 0 && p < 1 ? std::sqrt(p * (1 - p) / static_cast<double>(of)) : kNaN, found.ci_low, found.ci_high};
}

// The error of a median is that of the ranks about it.
Simulated median_of(const LogHistogram& histogram, std::int64_t n) {
  if (n == 0) return {};
  const double reach = 0.5 / std::sqrt(static_cast<double>(n));
  const double low = histogram.quantile(std::max(0.0, 0.5 - reach)),
               high = histogram.quantile(std::min(1.0, 0.5 + reach));
  return {.value = histogram.quantile(0.5), .error = std::isfinite(high) && n > 1 ? 0.5 * (high - low) : kNaN};
}

EstimateSummary summary_of(const EstimateTally& tally, double truth, std::int64_t studies) {
  EstimateSummary summary;
  summary.truth = truth;
  summary.undefined = share(studies - tally.defined, studies);
  summary.half_width = median_of(tally.half_widths, tally.intervals);
  if (tally.defined == 0) return summary;
  const auto n = static_cast<double>(tally.defined);
  const double mean = tally.errors.value() / n, square = tally.squares.value() / n, fourth = tally.fourths.value() / n;
  summary.bias = {.value = mean, .error = n > 1 ? std::sqrt(std::max(0.0, square - mean * mean) / n) : kNaN};
  if (std::isnan(truth)) return summary;
  summary.coverage = share(tally.covered, tally.intervals);
  summary.rmse.value = std::sqrt(square);
  if (square > 0 && n > 1)
    summary.rmse.error = 0.5 * std::sqrt(std::max(0.0, fourth - square * square) / n) / summary.rmse.value;
  return summary;
}

// call(design, its place, analysis, its place, analyst)
template <typename Call>
void for_analyses(const PowerResult& result, const Call& call) {
  const std::vector<PowerDesign> designs = result.question.designs();
  for (std::size_t d = 0; d < designs.size(); ++d) {
    const StudyAnalyst analyst(result.protocol, result.question, designs[d].effect);
    for (std::size_t a = 0; a < result.question.analyses.size(); ++a)
      call(designs[d], d, result.question.analyses[a], a, analyst);
  }
}

// By design, then contrast or condition; analyses stay in their order.
template <typename Summary>
void sort_by_design(std::vector<Summary>& all, std::size_t Summary::*place) {
  std::stable_sort(all.begin(), all.end(), [place](const Summary& x, const Summary& y) {
    const auto key = [place](const Summary& one) {
      return std::tuple(one.design.participants, one.design.trials, one.design.effect, one.*place);
    };
    return key(x) < key(y);
  });
}

}  // namespace

std::string share_text(const Simulated& share) {
  if (std::isnan(share.value)) return "-";
  return fmt::format("{:.1f} % ({:.1f} to {:.1f})", 100 * share.value, 100 * share.low, 100 * share.high);
}

std::vector<ContrastSummary> contrast_summaries(const PowerResult& result) {
  std::vector<ContrastSummary> all;
  for_analyses(result, [&](const PowerDesign& design, std::size_t d, PowerAnalysis analysis, std::size_t a,
                           const StudyAnalyst& analyst) {
    for (std::size_t i = 0; i < result.question.tests(); ++i) {
      const ContrastTally& tally = result.tally.by_design[d][a].contrasts[i];
      ContrastSummary& one = all.emplace_back();
      one.design = design;
      one.analysis = analysis;
      one.contrast = i;
      one.ratio = std::exp(analyst.true_difference(PowerAnalysis::log_ml, i));
      if (!analyst.has_test(analysis, i)) continue;
      one.power = share(tally.significant, result.tally.studies);
      one.untested = share(result.tally.studies - tally.tested, result.tally.studies);
      if (analyst.has_estimate(analysis, i))
        one.estimate = summary_of(tally.estimates, analyst.true_difference(analysis, i), result.tally.studies);
    }
  });
  sort_by_design(all, &ContrastSummary::contrast);
  return all;
}

std::vector<GroupSummary> group_summaries(const PowerResult& result) {
  std::vector<GroupSummary> all;
  for_analyses(result, [&](const PowerDesign& design, std::size_t d, PowerAnalysis analysis, std::size_t a,
                           const StudyAnalyst& analyst) {
    for (std::size_t c = 0; c < result.question.jnds.size(); ++c)
      all.push_back({design, analysis, c,
                     summary_of(result.tally.by_design[d][a].group[c], std::log(analyst.true_jnd(analysis, c)),
                                result.tally.studies)});
  });
  sort_by_design(all, &GroupSummary::condition);
  return all;
}

std::vector<StudySummary> study_summaries(const PowerResult& result) {
  std::vector<StudySummary> all;
  for_analyses(result, [&](const PowerDesign& design, std::size_t d, PowerAnalysis analysis, std::size_t a,
                           const StudyAnalyst&) {
    const AnalysisTally& tally = result.tally.by_design[d][a];
    const std::int64_t studies = result.tally.studies;
    all.push_back(
        {design, analysis, share(tally.undefined, studies), share(tally.any, studies), share(tally.all, studies)});
  });
  return all;
}

std::vector<SmallestDesign> smallest_designs(const PowerResult& result) {
  std::vector<SmallestDesign> all;
  const std::vector<ContrastSummary> rows = contrast_summaries(result);
  for (const double effect : result.question.effects) {
    if (effect == 0) continue;
    for (std::size_t i = 0; i < result.question.tests(); ++i)
      for (const PowerAnalysis analysis : result.question.analyses) {
        SmallestDesign smallest{effect, i, analysis, std::nullopt};
        const auto size = [](const ContrastSummary& one) {
          return std::pair(one.design.participants * std::max(1, one.design.trials), one.design.participants);
        };
        for (const ContrastSummary& row : rows)
          if (row.design.effect == effect && row.contrast == i && row.analysis == analysis &&
              row.power.low >= result.question.wanted && (!smallest.design || size(row) < size(*smallest.design)))
            smallest.design = row;
        all.push_back(smallest);
      }
  }
  return all;
}

std::string contrast_name(const PowerResult& result, std::size_t contrast) {
  const std::size_t contrasts = result.question.contrasts.size();
  if (contrast >= contrasts) {
    const GroupTest& groups = result.question.group_tests[contrast - contrasts];
    if (groups.kind == GroupTest::Kind::groups) return "groups";
    if (groups.kind == GroupTest::Kind::interaction) return "groups x conditions";
    return fmt::format("{} - {}", group_name(result.protocol, groups.a), group_name(result.protocol, groups.b));
  }
  const auto& [a, b] = result.question.contrasts[contrast];
  return condition_name(result.protocol, a) + " - " + condition_name(result.protocol, b);
}

}  // namespace jnd
