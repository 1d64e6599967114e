#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/hierarchical/model_variants.h"
#include "data/fields/number_text.h"
#include "runner/calc_hierarchical/calc_hierarchical_check.h"
#include "runner/calc_hierarchical/hierarchical_result.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Align = TextTable::Align;

std::string four_digits(double value) {
  return std::isnan(value) ? "-" : fmt::format("{:.4g}", value);
}

std::string jnd_range(const ProfileEnds& ends) {
  if (std::isnan(ends.low)) return "-";
  return range_text(four_digits(std::exp(ends.low)), four_digits(std::exp(ends.high)));
}

std::string range_of(const ProfileEnds& ends, double origin = 0) {
  if (std::isnan(ends.low)) return "-";
  return range_text(four_digits(origin + ends.low), four_digits(origin + ends.high));
}

std::string conditions_text(const HierarchicalResult& result) {
  const double standard = result.answers.standard.value_or(kNaN);
  std::vector<std::string> header = {"condition", "JND", "95 % profile"};
  std::vector<Align> align = {Align::left, Align::right, Align::right};
  if (standard > 0) {
    header.emplace_back("Weber");
    align.push_back(Align::right);
  }
  header.emplace_back(result.choice()                                        ? "PSE"
                      : result.model.response == ResponseModel::differencing ? "ln tau"
                                                                             : "criterion");
  header.emplace_back("status");
  align.push_back(Align::right);
  if (result.choice()) {
    header.insert(header.end() - 1, "95 % profile");
    align.push_back(Align::right);
  }
  align.push_back(Align::left);
  TextTable table(header, align);
  for (std::size_t c = 0; c < result.fit.conditions.size(); ++c) {
    const ConditionMean& one = result.fit.conditions[c];
    std::vector<std::string> row = {printable(result.answers.conditions[c]), four_digits(std::exp(one.mu)),
                                    jnd_range(one.ends)};
    if (standard > 0) row.push_back(percent_text(std::exp(one.mu) / standard));
    const double pse = one.status == SlopeStatus::ok ? standard + one.criterion : kNaN;
    row.push_back(result.choice() ? four_digits(pse) : number_text(one.criterion, 3));
    if (result.choice()) row.push_back(range_of(one.criterion_ends, standard));
    const bool of_jnd = one.ends.status != EndsStatus::ok;
    row.push_back(status_with_interval(word_of(kSlopeStatusWords, one.status),
                                       of_jnd ? one.ends.status : one.criterion_ends.status));
    table.add(row);
  }
  return table.text();
}

std::string differences_text(const HierarchicalResult& result) {
  if (result.fit.differences.empty()) return "";
  TextTable table({"conditions", "ratio of JNDs", "95 % profile", "chi-square", "p", ""},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::left});
  for (const ConditionDifference& one : result.fit.differences)
    table.add({printable(result.answers.conditions[one.a] + " : " + result.answers.conditions[one.b]),
               number_text(std::exp(one.difference), 3), range_text(std::exp(one.ends.low), std::exp(one.ends.high), 3),
               number_text(one.lr, 2), p_value_text(one.p), status_with_interval("", one.ends.status)});
  std::string text = "\n" + table.text();
  if (result.fit.df == 0) return text;
  text += fmt::format("One JND for all conditions: chi-square {} with {} df, p {}.\n", number_text(result.fit.lr, 2),
                      result.fit.df, p_value_text(result.fit.p));
  if (result.bootstrap)
    text += fmt::format("In {} of {} studies drawn without a difference it is as large: p {}.\n",
                        result.bootstrap->as_large, result.bootstrap->replicates, p_value_text(result.bootstrap->p));
  return text;
}

std::string spreads_text(const HierarchicalResult& result) {
  const HierarchicalFit& fit = result.fit;
  const HierarchicalPlace& place = fit.maximum.place;
  TextTable table({"standard deviation between people", "", "of", "status"},
                  {Align::left, Align::right, Align::left, Align::left});
  const auto add = [&table](std::string name, double value, const char* of, SpreadStatus status) {
    if (status == SpreadStatus::not_asked) return;
    table.add({std::move(name), status == SpreadStatus::not_identified ? "-" : four_digits(value), of,
               std::string(word_of(kSpreadStatusWords, status))});
  };
  add("persons (tu)", place.tu, "ln JND", fit.tu);
  if (fit.tv != SpreadStatus::by_condition) add("persons by condition (tv)", place.tv, "ln JND", fit.tv);
  for (std::size_t c = 0; c < place.own_tv.size() && fit.tv == SpreadStatus::by_condition; ++c)
    add(fmt::format("persons in {} (tv)", printable(result.answers.conditions[c])), fit.conditions[c].tv, "ln JND",
        fit.conditions[c].tv_status);
  add(result.choice() ? "PSE (tw)" : "criterion (tw)", place.tw, result.choice() ? "the level's unit" : "z", fit.tw);
  std::string text = "\n" + table.text();
  if (result.model.rho)
    text += fmt::format("Correlation of the first and the last: {} ({}).\n", number_text(place.rho, 3),
                        word_of(kSpreadStatusWords, fit.rho));
  return text;
}

// What is the same for everybody, and what its estimation does to the means.
std::string shared_text(const HierarchicalResult& result) {
  if (!result.without) return "";
  TextTable table({"the same for everybody", "", "95 % profile", "chi-square", "p", "status"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::left});
  for (const SharedEstimate& one : result.shared)
    table.add({std::string(title_of(one.parameter, result.choice())), four_digits(one.value), range_of(one.ends),
               number_text(one.lr, 2), p_value_text(one.p),
               status_with_interval(word_of(kSharedStatusWords, one.status), one.ends.status)});
  TextTable means({"condition", "JND", "95 % profile", "without these", "95 % profile"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right});
  for (std::size_t c = 0; c < result.fit.conditions.size(); ++c) {
    const ConditionMean &with = result.fit.conditions[c], &without = result.without->conditions[c];
    means.add({printable(result.answers.conditions[c]), four_digits(std::exp(with.mu)), jnd_range(with.ends),
               four_digits(std::exp(without.mu)), jnd_range(without.ends)});
  }
  std::string text = "\n" + table.text() +
                     dim("chi-square, p: of none. A share and a correlation cannot be below 0: p is half of that of "
                         "chi-square.") +
                     "\n\n" + means.text();
  if (!result.without->maximum.converged) text += warn("Without these the search did not settle.") + "\n";
  return text;
}

std::string sureness_text(const HierarchicalResult& result) {
  if (!result.answers.graded) return "";
  TextTable table({"criteria of sureness", "from the criterion", "95 % profile", "status"},
                  {Align::left, Align::right, Align::right, Align::left});
  for (const SharedEstimate& one : result.sureness)
    table.add({std::string(title_of(one.parameter, false)), number_text(one.value, 3), range_of(one.ends),
               status_with_interval(word_of(kSharedStatusWords, one.status), one.ends.status)});
  std::string text = "\n" + table.text();
  for (std::size_t c = 0; c < result.narrower.size(); ++c)
    text += fmt::format("{}{} {}", c == 0 ? "Intervals of ln JND narrower than without the sureness: " : ", ",
                        printable(result.answers.conditions[c]),
                        std::isnan(result.narrower[c]) ? "-" : percent_text(result.narrower[c]));
  return text + ".\n";
}

// What the model takes for granted, as far as it still does.
std::string assumptions_of(const HierarchicalResult& result) {
  const bool own_tv = result.model.own_tv;
  if (!result.fit.shared.has(SharedParameter::drift_ln_s)) return hierarchical_assumptions(own_tv);
  return fmt::format(
      "Assumed: ln JND differs between people, and their criteria do, as normal distributions do, by {}, and both change "
      "from the first half of the trials to the second by as much for everybody.",
      spreads_assumed(own_tv));
}

template <typename Style>
std::string styled_lines(std::string_view words, const Style& style) {
  constexpr std::size_t kColumns = 104;
  std::string text;
  for (const std::string& line : wrapped_words(std::string(words), kColumns)) text += style(line) + "\n";
  return text;
}

std::string people_text(const HierarchicalResult& result) {
  TextTable table({"participant", "condition", "JND", "sd of its ln", "from these answers alone", "status"},
                  {Align::left, Align::left, Align::right, Align::right, Align::right, Align::left});
  const std::size_t conditions = result.answers.conditions.size();
  const bool alike = are_alike(result.fit.tu, result.fit.tv);
  for (std::size_t i = 0; i < result.people.size(); ++i) {
    const PersonEstimate& one = result.people[i];
    table.add({printable(result.answers.participants[i / conditions]),
               printable(result.answers.conditions[i % conditions]), four_digits(std::exp(one.mean)),
               number_text(alike ? kNaN : one.sd, 3), four_digits(std::exp(one.alone)),
               std::string(word_of(kSlopeStatusWords, one.status))});
  }
  return "\n" + table.text() +
         styled_lines("JND: given everybody's answers, which draws those with few answers towards the group.", dim) +
         styled_lines(alike ? kPeopleAlike : kPersonRange, dim);
}

std::string meanings_text(const HierarchicalResult& result) {
  std::string text;
  for (const std::string& one : result.cautions()) text += styled_lines(printable(one), warn);
  if (std::any_of(result.sureness.begin(), result.sureness.end(),
                  [](const SharedEstimate& one) { return one.status == SharedStatus::not_identified; }))
    text +=
        warn(
            "not_identified, of sureness: nobody gave both answers, sure and unsure, on that side; they count as one.") +
        "\n";
  return text;
}

}  // namespace

std::vector<std::string> HierarchicalResult::cautions() const {
  std::vector<std::string> cautions = hierarchical_cautions(fit, answers.conditions, answers.pooled);
  if (std::string caution = lapse_caution(lapses); !caution.empty()) cautions.push_back(std::move(caution));
  return cautions;
}

std::string hierarchical_text(const HierarchicalResult& result) {
  const HierarchicalFit& fit = result.fit;
  const char* const what =
      result.choice()                                       ? "choices between two intervals"
      : result.model.response == ResponseModel::yes_no      ? "same-different, decided on the difference"
      : result.model.response == ResponseModel::independent ? "same-different, decided by each interval itself"
                                                            : "same-different, decided on the size of the difference";
  std::string text =
      bold(fmt::format("hierarchical model: {}, lapse {:g}; {}, {:.0f} trials", what, fit.maximum.shared.lapse,
                       counted(static_cast<std::int64_t>(fit.participants), "participant"), fit.trials)) +
      "\n";
  text += conditions_text(result);
  text += dim(result.choice() ? "JND: s, from the PSE to where the comparison is chosen in 84 % of the trials, of the "
                                "median person."
                              : "JND: the difference of which d' is 1, of the median person.") +
          "\n";
  text += differences_text(result) + spreads_text(result) + sureness_text(result) + shared_text(result);
  if (!result.people.empty()) text += people_text(result);
  if (result.check) text += predictive_text(*result.check, result.answers.conditions, result.origin());
  return text + styled_lines(assumptions_of(result), dim) + meanings_text(result);
}

}  // namespace jnd
