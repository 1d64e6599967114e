#include "data/methods/verdict_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "data/fields/number_text.h"
#include "data/methods/markdown_text.h"
#include "protocols/planning/allotment.h"

namespace jnd {

namespace {

std::string number_word(std::size_t n) {
  constexpr std::array<const char*, 11> kWords = {"none", "one",   "two",   "three", "four", "five",
                                                  "six",  "seven", "eight", "nine",  "ten"};
  return n < kWords.size() ? kWords[n] : std::to_string(n);
}

std::string p_equals(double p, double alpha) {
  const std::string words = p_in_words(p, alpha);
  return words.front() == '<' || words.front() == '>' ? "p " + words : "p = " + words;
}

// "p = 0.14", "p from 0.14 to 0.48"; ps: not empty.
std::string range_of(const std::vector<double>& ps, double alpha) {
  const auto [least, most] = std::minmax_element(ps.begin(), ps.end());
  const std::string low = p_in_words(*least, alpha), high = p_in_words(*most, alpha);
  if (ps.size() == 1) return p_equals(*least, alpha);
  return low == high ? fmt::format("each p = {}", low) : fmt::format("p from {} to {}", low, high);
}

// "discrimination is finer in S than in V (slope of d', p = 0.012)". Finer: a smaller JND or threshold, a larger slope of d'.
std::string found_words(const ContrastRow& row, const OutcomeComparison& tested, const Protocol& protocol) {
  const std::string& a = condition_name(protocol, row.a);
  const std::string& b = condition_name(protocol, row.b);
  const std::string p = p_equals(row.p_registered, protocol.analysis.tests.alpha);
  const bool hierarchical = row.outcome == kHierarchicalScale;
  const bool more = row.difference.mean > 0;
  if (hierarchical && !std::isnan(row.difference.mean))
    return fmt::format("discrimination is finer in {} than in {} (JNDs of the hierarchical model, ratio {:.2f}, {})",
                       more ? b : a, more ? a : b, std::exp(row.difference.mean), p);
  // Without a JND there is no ratio; the sign of a mean difference need not be that of the ranks.
  if (hierarchical || protocol.analysis.tests.post_hoc == PostHoc::wilcoxon)
    return fmt::format("{} and {} differ ({}, {})", a, b,
                       hierarchical ? "likelihood ratio in the hierarchical model" : tested.title, p);
  if (!task_of(protocol.task.kind).has_pairs())
    return fmt::format("the mean {} is {} in {} than in {} ({})", tested.title, more ? "larger" : "smaller", a, b, p);
  const bool finer = more == tested.may_lack;  // a steeper slope, a smaller JND
  return fmt::format("discrimination is finer in {} than in {} ({}, {})", finer ? a : b, finer ? b : a, tested.title,
                     p);
}

std::string untested_words(std::size_t untested, std::size_t registered) {
  if (untested == 0) return {};
  return fmt::format(" {} of {} registered contrasts could not be tested.", capitalised(number_word(untested)),
                     number_word(registered));
}

std::string contrasts_words(const std::vector<ContrastRow>& rows, const OutcomeComparison& tested,
                            const Protocol& protocol) {
  const double alpha = protocol.analysis.tests.alpha;
  std::vector<const ContrastRow*> significant;
  std::vector<double> others;
  std::size_t registered = 0;
  for (const ContrastRow& row : rows) {
    if (!row.registered) continue;
    ++registered;
    if (std::isnan(row.p_registered)) continue;
    if (row.p_registered < alpha)
      significant.push_back(&row);
    else
      others.push_back(row.p_registered);
  }
  if (registered == 0) return {};
  const std::size_t untested = registered - significant.size() - others.size();
  if (untested == registered)
    return registered == 1 ? "The registered contrast could not be tested." : "No registered contrast could be tested.";
  const std::string level = fmt::format("at {:g}", alpha);
  std::string text;
  if (significant.empty()) {
    text = fmt::format("{} significant {} ({}), which does not show that the conditions are equal.",
                       registered == 1 ? "The registered contrast is not"
                       : untested == 0 ? "No registered contrast is"
                                       : "No registered contrast that could be tested is",
                       level, range_of(others, alpha));
    return text + untested_words(untested, registered);
  }
  std::vector<std::string> found;
  for (const ContrastRow* row : significant) found.push_back(found_words(*row, tested, protocol));
  text = fmt::format("Significant {}: {}", level, found.front());
  for (std::size_t i = 1; i < found.size(); ++i) text += "; " + found[i];
  text += ".";
  if (others.size() == 1)
    text += fmt::format(" The other contrast is not significant ({}).", range_of(others, alpha));
  else if (!others.empty())
    text += fmt::format(" The other {} contrasts are not significant ({}).", number_word(others.size()),
                        range_of(others, alpha));
  return text + untested_words(untested, registered);
}

std::string significance(double p, double alpha) {
  return fmt::format("{} ({})", p < alpha ? "significant" : "not significant", p_equals(p, alpha));
}

// Of two conditions the F of an analysis of variance is the square of the contrast's t.
bool is_the_contrasts_test(const Protocol& protocol) noexcept {
  return protocol.conditions.size() == 2 && protocol.analysis.contrasts.size() == 1 &&
         protocol.analysis.tests.omnibus == Omnibus::anova && protocol.analysis.tests.post_hoc == PostHoc::holm_t &&
         !protocol.analysis.hierarchical;
}

std::string omnibus_words(const OutcomeComparison& tested, const Protocol& protocol) {
  const bool alone = protocol.analysis.contrasts.empty();
  const Omnibus omnibus = protocol.analysis.tests.omnibus;
  if (omnibus == Omnibus::none || protocol.conditions.size() < 2 || is_the_contrasts_test(protocol)) return {};
  const double p = tested.refused.empty() ? omnibus_p(tested.comparison, protocol.analysis) : kNaN;
  if (std::isnan(p)) return alone ? " The registered test of all conditions could not be made." : "";
  return fmt::format(" The registered test of all conditions together ({}) is {}.",
                     omnibus == Omnibus::friedman     ? "Friedman"
                     : protocol.conditions.size() > 2 ? "analysis of variance, Greenhouse-Geisser"
                                                      : "analysis of variance",
                     significance(p, protocol.analysis.tests.alpha));
}

std::string effect_words(const char* name, double p, double alpha) {
  return std::isnan(p) ? fmt::format("{} not tested", name) : fmt::format("{} {}", name, significance(p, alpha));
}

std::string group_pair_words(const GroupsCompared& groups, const GroupPair& pair, const Protocol& protocol) {
  const double alpha = protocol.analysis.tests.alpha;
  const bool ranks = groups.test == BetweenTest::mann_whitney;
  const double p = ranks ? pair.ranks_p_holm : pair.welch_p_holm;
  const std::string_view a = group_name(protocol, static_cast<int>(pair.a));
  const std::string_view b = group_name(protocol, static_cast<int>(pair.b));
  if (std::isnan(p)) return fmt::format("{} and {} could not be tested", a, b);
  if (p >= alpha) return fmt::format("{} and {} do not differ significantly ({})", a, b, p_equals(p, alpha));
  if (ranks) return fmt::format("{} and {} differ ({})", a, b, p_equals(p, alpha));
  return fmt::format("the mean {} is {} in {} than in {} ({})", groups.title,
                     pair.welch.mean_difference > 0 ? "larger" : "smaller", a, b, p_equals(p, alpha));
}

std::string groups_words(const StudyResults& results, const Protocol& protocol) {
  if (!results.groups || results.groups->test == BetweenTest::none) return {};
  const GroupsCompared& groups = *results.groups;
  if (!groups.tested()) return " The registered test of the groups could not be made.";
  const double alpha = protocol.analysis.tests.alpha;
  std::vector<std::string> found;
  if (groups.test == BetweenTest::mixed_anova) {
    const MixedAnova& anova = groups.comparison.anova;
    found = {effect_words("group", anova.group.p, alpha), effect_words("condition", anova.condition.p_gg, alpha),
             effect_words("group x condition", anova.interaction.p_gg, alpha)};
  } else {
    for (const GroupPair& pair : groups.comparison.pairs) found.push_back(group_pair_words(groups, pair, protocol));
  }
  std::string text = " The registered test of the groups: ";
  for (std::size_t i = 0; i < found.size(); ++i) text += (i == 0 ? "" : "; ") + found[i];
  return text + ".";
}

// How many of the other models and methods decide every registered test alike.
std::string methods_words(const StudyResults& results, const Protocol& protocol) {
  if (protocol.analysis.hierarchical) return {};  // they test separate values, and not what is registered
  if (results.sensitivity.empty() || !results.sensitivity.front().refused.empty()) return {};
  const SensitivityRow& registered = results.sensitivity.front();
  std::size_t tested = 0, alike = 0, of_fewer = 0;
  for (const SensitivityRow& row : results.sensitivity) {
    if (row.registered || !row.refused.empty()) continue;
    ++tested;
    alike += row.same_conclusion ? 1 : 0;
    of_fewer += row.n < registered.n ? 1 : 0;
  }
  if (tested == 0) return {};
  const std::string fewer =
      of_fewer == 0 ? std::string() : fmt::format(" ({} of them with fewer participants)", number_word(of_fewer));
  if (tested == 1)
    return fmt::format(" The one other method that gives a test {}{}.", alike == 1 ? "agrees" : "decides otherwise",
                       of_fewer == 1 ? " (with fewer participants)" : "");
  if (alike == tested)
    return fmt::format(" All {} other methods that give a test agree{}.", number_word(tested), fewer);
  return fmt::format(" {} of {} other methods that give a test {} otherwise{}.",
                     capitalised(number_word(tested - alike)), number_word(tested),
                     tested - alike == 1 ? "decides" : "decide", fewer);
}

std::string ratings_words(const QuestionnaireResults& ratings) {
  if (ratings.tests.family == 0) return {};
  const TestCount& below = ratings.below_alpha;
  return fmt::format(
      "{} of {} Wilcoxon tests of the ratings fall{} below {:g} by the exact p, {} with Holm's correction and {} with "
      "Benjamini-Hochberg's.",
      below.exact, ratings.tests.family, below.exact == 1 ? "s" : "", ratings.alpha, below.holm, below.bh);
}

}  // namespace

std::string p_in_words(double p, double alpha) {
  std::string text = p_value_text(p);
  constexpr double kShown = 0.001;  // the least that is told
  if (p < kShown && alpha >= kShown) return text;
  const auto without_zero = [](const std::string& of) { return of.starts_with("0.") ? of.substr(1) : of; };
  for (int digits = 3; digits < 17; ++digits) {
    const std::string exact = fmt::format("{:.{}f}", p, digits);
    const double read = std::strtod(exact.c_str(), nullptr);
    if (read > 0 && (read < alpha) == (p < alpha)) return digits == 3 ? text : without_zero(exact);
  }
  return fmt::format("{}", p);
}

std::string verdict_text(const StudyResults& results, const Protocol& protocol) {
  if (results.attendance.participants == 0) return {};
  const OutcomeComparison* const tested = results.registered();
  if (tested == nullptr) return ratings_words(results.questionnaire);
  std::string text = contrasts_words(results.contrasts, *tested, protocol) + omnibus_words(*tested, protocol) +
                     groups_words(results, protocol);
  if (text.empty()) return protocol.conditions.size() > 1 ? "The protocol registers no test of the conditions." : "";
  text += methods_words(results, protocol);
  return text.starts_with(' ') ? text.substr(1) : text;
}

}  // namespace jnd
