// `jnd calc fit` for a person.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runner/calc/calc_psychometric.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Align = TextTable::Align;

std::string number(double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return fmt::format("{:.5g}", value);
}

std::string interval(const ConfidenceBounds& bounds) {
  return std::isnan(bounds.low) ? "-" : number(bounds.low) + " .. " + number(bounds.high);
}

std::string with_error(const PsychometricEstimate& estimate) {
  return std::isnan(estimate.se) ? number(estimate.value)
                                 : number(estimate.value) + " ± " + fmt::format("{:.2g}", estimate.se);
}

std::string p_text(double p) {
  if (std::isnan(p)) return "-";
  return p < 0.0001 ? "< 0.0001" : fmt::format("{:.4f}", p);
}

std::string rate_text(const char* name, const std::optional<double>& rate, double most) {
  return rate ? fmt::format("{} {:g}", name, *rate) : fmt::format("{} free (0 .. {:g})", name, most);
}

std::string heading(const PsychometricModel& model) {
  return fmt::format("{} function, {}, {}, {}", to_string(model.function),
                     rate_text("guess", model.guess, kLargestGuess), rate_text("lapse", model.lapse, kLargestLapse),
                     model.estimator == PsychometricEstimator::ml
                         ? std::string("maximum likelihood")
                         : fmt::format("prior Beta({:g}, {:g}) on the lapse", model.prior.a, model.prior.b));
}

// What each status means, once for all rows that have it.
std::string remarks(const std::vector<PsychometricAnswer>& answers) {
  using Status = PsychometricStatus;
  static constexpr std::pair<Status, const char*> kMeanings[] = {
      {Status::lapse_at_bound, "the free lapse is at the end of its range; the errors take it as known"},
      {Status::guess_at_bound, "the free guess is at the end of its range; the errors take it as known"},
      {Status::not_increasing, "no slope above 0 fits better than one rate for all levels: there is no threshold"},
      {Status::separated, "a step fits best: the slope is infinite and the JND below what these levels can show"},
      {Status::no_information, "one and the same answer throughout"},
      {Status::not_identified, "too few different levels for the free parameters"}};
  std::string text;
  for (const auto& [status, meaning] : kMeanings)
    for (const PsychometricAnswer& answer : answers)
      if (answer.fit.status == status) {
        text += warn(fmt::format("{}: {}.", to_string(status), meaning)) + "\n";
        break;
      }
  return text;
}

}  // namespace

std::string psychometric_text(const std::vector<PsychometricAnswer>& answers) {
  if (answers.empty()) return "";
  const PsychometricModel& model = answers.front().fit.model;
  const bool bootstrap = answers.front().bootstrap.has_value();
  const std::string confidence =
      fmt::format("{:g} % {}", 100 * answers.front().intervals.confidence, bootstrap ? "bootstrap" : "profile");
  const auto [location, second] = parameter_names(model.function);
  TextTable thresholds({"group", "PSE", confidence, "JND", confidence, "slope", "deviance", "df", "p",
                        bootstrap ? "p bootstrap" : "", "status"},
                       {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                        Align::right, Align::right, Align::right, Align::left});
  TextTable parameters({"group", std::string(location), confidence, std::string(second), confidence, "lapse", "guess",
                        "log-likelihood", "trials"},
                       {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                        Align::right, Align::right});
  for (const PsychometricAnswer& answer : answers) {
    const PsychometricFit& fit = answer.fit;
    const std::string group = printable(answer.group.value_or("all"));
    thresholds.add({group, number(fit.pse.value), interval(answer.intervals.pse), number(fit.jnd.value),
                    interval(answer.intervals.jnd), number(fit.slope.value), number(fit.deviance),
                    std::to_string(fit.degrees_of_freedom), p_text(fit.deviance_p),
                    answer.bootstrap ? p_text(answer.bootstrap->deviance_p) : "", std::string(to_string(fit.status))});
    parameters.add({group, with_error(fit.location), interval(answer.intervals.location), with_error(fit.second),
                    interval(answer.intervals.second), model.lapse ? number(*model.lapse) : with_error(fit.lapse),
                    model.guess ? number(*model.guess) : with_error(fit.guess), number(fit.log_likelihood),
                    std::to_string(fit.trials)});
  }
  std::string text = bold(heading(model)) + "\n" + thresholds.text();
  text +=
      dim("PSE: F = 0.5; JND: from there to F = 0.75; slope dF/dx at the PSE; all without guess and lapse.") + "\n\n";
  text += parameters.text() + dim("± standard error from the observed information.") + "\n";
  return text + remarks(answers);
}

std::string psychometric_text(const PsychometricComparison& comparison) {
  const auto words = [](PsychometricSharing sharing) {
    std::string text(to_string(sharing));
    for (char& c : text)
      if (c == '_') c = ' ';
    return text;
  };
  TextTable models({"model", "parameters", "log-likelihood", "status"},
                   {Align::left, Align::right, Align::right, Align::left});
  for (const SharingFit& fit : comparison.fits)
    models.add({words(fit.sharing), std::to_string(fit.parameters),
                std::isnan(fit.log_likelihood) ? "-" : fmt::format("{:.3f}", fit.log_likelihood),
                std::string(to_string(fit.status))});
  TextTable tests({"test", "against", "chi-square", "df", "p", "status"},
                  {Align::left, Align::left, Align::right, Align::right, Align::right, Align::left});
  for (const SharingTest& test : comparison.tests)
    tests.add({words(test.general), words(test.simpler),
               std::isnan(test.chi_square) ? "-" : fmt::format("{:.3f}", test.chi_square), std::to_string(test.df),
               p_text(test.p), std::string(to_string(test.status))});
  return bold(fmt::format("Do the {} groups differ?", comparison.groups)) + "\n" + models.text() + "\n" + tests.text() +
         dim("Likelihood ratios of nested models, maximum likelihood; location: PSE; a free lapse or guess is common "
             "to "
             "all groups.") +
         "\n";
}

}  // namespace jnd
