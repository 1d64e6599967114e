#include "data/results/hierarchical_words.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "analysis/hierarchical/hierarchical_likelihood.h"
#include "data/fields/number_text.h"

namespace jnd {

namespace {

constexpr std::pair<SlopeStatus, std::string_view> kSlopeMeanings[] = {
    {SlopeStatus::no_sensitivity,
     "positive answers do not become more frequent as the level grows; there is no JND within 12 times the levels"},
    {SlopeStatus::ceiling, "a step fits; the JND is below a twelfth of the smallest level"},
    {SlopeStatus::one_answer, "every answer is the same, so there is no JND"},
    {SlopeStatus::one_level, "every trial has the same level, so there is no JND"},
    {SlopeStatus::perfect,
     "all answers are negative up to some level and positive above it; the JND is 0 or near it, add levels in between"}};

constexpr std::pair<EndsStatus, std::string_view> kEndsMeanings[] = {
    {EndsStatus::not_converged, "an end could not be confirmed, so the interval is left out"},
    {EndsStatus::by_curvature,
     "the search for its ends takes too long, so it and its test are those of Wald, from the curvature of the likelihood at "
     "its maximum; jnd calc hierarchical --thorough searches"},
    {EndsStatus::out_of_work, "the search for its ends takes too long; the interval is unknown"}};

std::size_t levels_in(const std::vector<HierarchicalCell>& cells) {
  std::set<double> levels;
  for (const HierarchicalCell& cell : cells) levels.insert(cell.level);
  return levels.size();
}

bool any_interval(const HierarchicalFit& fit, EndsStatus status) {
  const auto has = [status](const auto& one) { return one.ends.status == status; };
  return std::any_of(fit.conditions.begin(), fit.conditions.end(),
                     [&](const ConditionMean& one) { return has(one) || one.criterion_ends.status == status; }) ||
         std::any_of(fit.differences.begin(), fit.differences.end(), has) ||
         std::any_of(fit.shared_estimates.begin(), fit.shared_estimates.end(), has);
}

std::string spreads_at_limit(const HierarchicalFit& fit, const std::vector<std::string>& conditions) {
  std::vector<std::string> names;
  for (const auto& [name, status] : {std::pair{"between persons (tu)", fit.tu},
                                     {"between persons by condition (tv)", fit.tv},
                                     {"of the criterion or PSE (tw)", fit.tw},
                                     {"correlation (rho)", fit.rho}})
    if (status == SpreadStatus::at_limit) names.emplace_back(name);
  for (std::size_t c = 0; c < fit.conditions.size(); ++c)
    if (fit.conditions[c].tv_status == SpreadStatus::at_limit)
      names.push_back(fmt::format("between persons in {} (tv)", conditions[c]));
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

PooledLevels pooled(std::vector<HierarchicalCell>& cells) {
  const std::size_t from = levels_in(cells);
  return pool_levels(cells) ? PooledLevels{from, levels_in(cells)} : PooledLevels{};
}

std::string status_with_interval(std::string_view status, EndsStatus interval) {
  if (interval == EndsStatus::ok || interval == EndsStatus::not_computed) return std::string(status);
  if (status == "ok") status = "";
  return fmt::format("{}{}interval {}", status, status.empty() ? "" : ", ", word_of(kEndsStatusWords, interval));
}

std::string lapse_caution(const SharedEstimate& lapses) {
  constexpr double kSignificant = 0.05;
  if (!(lapses.p < kSignificant)) return "";
  return fmt::format(
      "Some answers are guesses: a share of {:.1f} % fits them better ({}). Unknown lapses of 5 % make a JND "
      "8 % too large.",
      100 * lapses.value, p_text(lapses.p));
}

std::string predictive_verdict(const PredictiveCheck& check) {
  std::string text = fmt::format(
      "The model {} answers like these: {} of {} shares and spreads lie outside their 95 % bands",
      check.bands_fit() && check.scatter_fits() ? "draws" : "does not draw", check.outside(), check.bands());
  if (!check.bands_fit()) text += fmt::format(", more than the {} that chance explains", check.outside_by_chance());
  return text + fmt::format(", and {} ({}).",
                            check.scatter_fits() ? "the answers scatter about each person's rates as drawn ones do"
                            : check.p < 0.5      ? "the answers scatter more about each person's rates than drawn ones"
                                                 : "the answers are more regular than drawn ones",
                            p_text(check.p));
}

std::vector<std::string> hierarchical_cautions(const HierarchicalFit& fit, const std::vector<std::string>& conditions,
                                               const PooledLevels& pooled) {
  std::vector<std::string> out;
  if (!fit.maximum.converged)
    out.emplace_back("The search for the largest likelihood did not settle: take no number from here.");
  else if (fit.df > 0 && !fit.common.converged)
    out.emplace_back(
        "The search with one JND for all conditions did not settle: the test of it may have too large a chi-square.");
  for (const auto& [status, meaning] : kSlopeMeanings) {
    std::vector<std::string_view> names;
    for (std::size_t c = 0; c < fit.conditions.size(); ++c)
      if (fit.conditions[c].status == status) names.emplace_back(conditions[c]);
    if (!names.empty())
      out.push_back(fmt::format("{} ({}): {}.", word_of(kSlopeStatusWords, status), fmt::join(names, ", "), meaning));
  }
  for (const auto& [status, meaning] : kEndsMeanings)
    if (any_interval(fit, status))
      out.push_back(fmt::format("interval {}: {}.", word_of(kEndsStatusWords, status), meaning));
  if (const std::string names = spreads_at_limit(fit, conditions); !names.empty())
    out.push_back(fmt::format(
        "at_limit ({}): the answers of so few people set no upper bound to it; it is the largest value that "
        "is searched. Measure more participants.",
        names));
  if (!fit.exact)
    out.emplace_back(
        "The log-likelihood still changes by more than 0.000001 if it is integrated more finely: the last digits of these "
        "numbers may be wrong.");
  if (pooled)
    out.push_back(fmt::format("Levels within 5 % of each other were pooled: {} to {}.", pooled.from, pooled.to));
  if (std::none_of(fit.conditions.begin(), fit.conditions.end(),
                   [](const ConditionMean& one) { return one.status == SlopeStatus::ok; }))
    return out;
  if (fit.participants == 1) out.emplace_back("One participant: intervals and tests say nothing of anybody else.");
  if (fit.participants > 1 && fit.participants < kFewParticipants) {
    const IntervalCoverage &few = kIntervalCoverage[0], &more = kIntervalCoverage[1];
    out.push_back(fmt::format(
        "{} participants are few: in simulated studies of {} people, {:.1f} % of the 95 % intervals held the "
        "true JND and {:.1f} % the true ratio; with {} people, {:.1f} % and {:.1f} %.",
        fit.participants, few.participants, few.jnd, few.ratio, more.participants, more.jnd, more.ratio));
  }
  return out;
}

}  // namespace jnd
