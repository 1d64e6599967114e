// `jnd calc sdt` for a person.
#include <cmath>

#include <fmt/format.h>

#include "runner/calc/calc_detection.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Align = TextTable::Align;

std::string number(double value) {
  return number_text(value, 3);
}

std::string interval(double low, double high) {
  return std::isnan(low) ? "-" : number(low) + " .. " + number(high);
}

std::string yes_no_table(const std::vector<NamedDetectionRow>& rows) {
  TextTable table({"id", "hits", "false alarms", "d'", "95 % profile", "p", "c", "ln beta", "se", "status"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right, Align::left});
  for (const auto& [id, row] : rows)
    table.add({printable(id), fmt::format("{}/{}", row.counts.hits, row.counts.n_diff),
               fmt::format("{}/{}", row.counts.false_alarms, row.counts.n_same), number(row.loglinear.dprime),
               interval(row.profile.ci_low, row.profile.ci_high), p_value_text(row.profile.p_value),
               number(row.loglinear.criterion), number(row.loglinear.ln_beta), number(row.loglinear.se),
               std::string(to_string(row.status))});
  return table.text();
}

std::string model_table(const std::vector<NamedDetectionRow>& rows) {
  TextTable table({"id", "yes-no raw", "half", "bootstrap 95 %", "differencing raw", "95 % profile", "p one-sided",
                   "log-linear", "independent", "exact"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right, Align::right});
  for (const auto& [id, row] : rows)
    table.add({printable(id), number(row.none.dprime), number(row.half.dprime),
               interval(row.bootstrap.q025, row.bootstrap.q975), number(row.differencing.fit.dprime),
               interval(row.differencing.ci_low, row.differencing.ci_high), p_value_text(row.differencing.p_value),
               number(row.differencing_loglinear.dprime), number(row.independent_loglinear.unit_slope),
               number(row.independent_loglinear.exact)});
  return table.text();
}

}  // namespace

std::string detection_text(const std::vector<NamedDetectionRow>& rows) {
  int missing = 0, no_information = 0;
  for (const auto& [id, row] : rows) {
    missing += row.status == RateStatus::missing;
    no_information += row.status == RateStatus::no_information;
  }
  std::string text = bold("yes-no model, log-linear correction") + "\n" + yes_no_table(rows);
  text +=
      dim("Profile-likelihood interval and two-sided test of d' = 0 on the raw counts; se: Gourevitch and Galanter.");
  text += "\n\n" + bold("d' of the same counts under other corrections and models") + "\n" + model_table(rows);
  text += dim(
      "Differencing: maximum likelihood on raw counts, then of log-linear rates. Independent observation, log-linear\n"
      "rates: unit slope, and the exact likelihood-ratio observer. d' of different models are different quantities.");
  text += "\n";
  if (missing > 0) text += warn(fmt::format("{} of {} rows lack a class: no d'.", missing, rows.size())) + "\n";
  if (no_information > 0)
    text += warn(fmt::format("{} of {} rows hold one and the same answer throughout: their d' is the arithmetic of the "
                             "correction, not an observation.",
                             no_information, rows.size())) +
            "\n";
  return text;
}

}  // namespace jnd
