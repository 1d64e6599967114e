#include "analysis/selftest/task_quantities.h"

#include <string>

#include "analysis/choice/choice_dprime.h"
#include "analysis/choice/choice_rates.h"
#include "analysis/ratings/identification.h"
#include "analysis/ratings/rating_roc.h"
#include "analysis/ratings/sureness.h"
#include "analysis/selftest/reference_numbers.h"

namespace jnd {

namespace {

using nlohmann::json;

// ---- choice: tasks with a right answer

void compare_two_rates(SelftestQuantity& quantity, const TwoRates& ours, const json& reference) {
  quantity.absolute(ours.z_difference, reference_number(reference.at("z_difference")));
  quantity.absolute(ours.dprime_differencing, reference_number(reference.at("dprime_differencing")));
  quantity.absolute(ours.dprime_independent, reference_number(reference.at("dprime_independent")));
  if (reference.contains("pc_unbiased"))
    quantity.absolute(ours.pc_unbiased, reference_number(reference.at("pc_unbiased")));
}

RatesTask rates_task_of(const json& name) {
  if (name == "abx") return RatesTask::abx;
  return name == "reminder_2afc" ? RatesTask::reminder_two_intervals : RatesTask::reminder_one_interval;
}

// ---- ratings: answers in ordered categories

struct RatingQuantities {
  SelftestQuantity information{"identification, bits", 1e-12};
  SelftestQuantity adjacent{"identification, adjacent d' and errors", 1e-7};
  SelftestQuantity equal{"rating ROC, equal variances", 1e-7};
  SelftestQuantity unequal{"rating ROC, unequal variances", 1e-6};
  SelftestQuantity trapezoids{"rating ROC, trapezoids and DeLong's error", 1e-12};
  SelftestQuantity sureness_sigma{"sureness, sigma and interval (relative)", 1e-6};
  SelftestQuantity sureness_criteria{"sureness, criteria", 1e-6};
  SelftestQuantity likelihood{"log-likelihood of ordered categories", 1e-8};

  // In the order in which they are printed.
  std::vector<SelftestQuantity> all() const {
    return {information, adjacent, equal, unequal, trapezoids, sureness_sigma, sureness_criteria, likelihood};
  }
};

void compare_identification(RatingQuantities& q, const json& input, const json& reference) {
  const Identification ours = identification(input.at("confusion"));
  q.information.absolute(ours.information_bits, reference_number(reference.at("information_bits")));
  q.information.absolute(ours.stimulus_entropy_bits, reference_number(reference.at("stimulus_entropy_bits")));
  q.information.absolute(ours.response_entropy_bits, reference_number(reference.at("response_entropy_bits")));
  q.information.absolute(ours.miller_madow_bits, reference_number(reference.at("miller_madow_bits")));
  q.information.absolute(ours.table_corrected_bits, reference_number(reference.at("table_corrected_bits")));
  q.information.absolute(ours.relative, reference_number(reference.at("relative")));
  const json& ml = reference.at("ml");
  q.likelihood.absolute(ours.ml.log_likelihood, reference_number(ml.at("loglik")));
  for (std::size_t i = 0; i < ml.at("adjacent").size(); ++i) {
    q.adjacent.absolute(ours.adjacent_loglinear.at(i), reference_number(reference.at("adjacent_loglinear").at(i)));
    q.adjacent.absolute(ours.ml.adjacent.at(i).dprime, reference_number(ml.at("adjacent").at(i).at("dprime")));
    q.adjacent.absolute(ours.ml.adjacent.at(i).se, reference_number(ml.at("adjacent").at(i).at("se")));
  }
}

void compare_estimate(SelftestQuantity& quantity, const RatingEstimate& ours, const json& reference,
                      const std::string& key) {
  quantity.absolute(ours.value, reference_number(reference.at(key)));
  quantity.absolute(ours.se, reference_number(reference.at(key + "_se")));
}

void compare_rating(RatingQuantities& q, const json& input, const json& reference) {
  const RatingRoc ours = rating_roc(input.at("noise"), input.at("signal"));
  const json &equal = reference.at("equal_variance"), &unequal = reference.at("unequal_variance");
  q.likelihood.absolute(ours.equal.log_likelihood, reference_number(equal.at("loglik")));
  compare_estimate(q.equal, ours.equal.dprime, equal, "dprime");
  compare_estimate(q.equal, ours.equal.area, equal, "A_z");
  q.likelihood.absolute(ours.unequal.log_likelihood, reference_number(unequal.at("loglik")));
  compare_estimate(q.unequal, ours.unequal.mu, unequal, "mu");
  compare_estimate(q.unequal, ours.unequal.ln_sigma, unequal, "ln_sigma");
  compare_estimate(q.unequal, ours.unequal.zroc_slope, unequal, "zroc_slope");
  compare_estimate(q.unequal, ours.unequal.d_a, unequal, "d_a");
  compare_estimate(q.unequal, ours.unequal.area, unequal, "A_z");
  q.trapezoids.absolute(ours.area_trapezoid.value, reference_number(reference.at("auc_trapezoid")));
  q.trapezoids.absolute(ours.area_trapezoid.se, reference_number(reference.at("auc_delong_se")));
}

void compare_sureness(RatingQuantities& q, const json& input, const json& reference) {
  std::vector<SurenessLevel> levels;
  for (std::size_t i = 0; i < input.at("dK").size(); ++i)
    levels.push_back({input.at("dK").at(i), input.at("counts").at(i)});
  const Sureness ours = sureness(levels);
  q.likelihood.absolute(ours.log_likelihood, reference_number(reference.at("loglik")));
  q.sureness_sigma.relative(ours.sigma, reference_number(reference.at("sigma")));
  q.sureness_sigma.relative(ours.sigma_low, reference_number(reference.at("sigma_ci").at(0)));
  q.sureness_sigma.relative(ours.sigma_high, reference_number(reference.at("sigma_ci").at(1)));
  for (std::size_t j = 0; j < reference.at("criteria").size(); ++j)
    q.sureness_criteria.absolute(ours.criteria.at(j), reference_number(reference.at("criteria").at(j)));
}

}  // namespace

std::vector<SelftestQuantity> choice_quantities() {
  SelftestQuantity dprime{"m-AFC, oddity, ABX, duo-trio d' and error", 1e-8};
  SelftestQuantity interval{"m-AFC, oddity, ABX, duo-trio interval", 1e-7};
  SelftestQuantity likelihood{"m-AFC, oddity, ABX, duo-trio log-likelihood", 1e-10};
  SelftestQuantity rates{"ABX and reminder d' of rates", 1e-8};
  for (const json& one : reference_numbers("choice").at("counts")) {
    const json &input = one.at("input"), &reference = one.at("expected");
    const ChoiceTask task = choice_task_from(input.at("task").get<std::string>()).value();
    const ChoiceDprime ours = choice_dprime_of_counts(task, input.at("correct"), input.at("n"));
    dprime.absolute(ours.dprime, reference_number(reference.at("dprime")));
    dprime.absolute(ours.se, reference_number(reference.at("se")));
    likelihood.absolute(ours.log_likelihood, reference_number(reference.at("loglik")));
    interval.absolute(ours.ci_low, reference_number(reference.at("dprime_ci").at(0)));
    interval.absolute(ours.ci_high, reference_number(reference.at("dprime_ci").at(1)));
  }
  for (const json& one : reference_numbers("choice").at("rates")) {
    const json &input = one.at("input"), &reference = one.at("expected");
    const RatesDprime ours =
        dprime_of_rates(rates_task_of(input.at("task")),
                        {input.at("n_signal"), input.at("hits"), input.at("n_noise"), input.at("false_alarms")});
    compare_two_rates(rates, ours.raw, reference.at("raw"));
    compare_two_rates(rates, ours.loglinear, reference.at("loglinear"));
  }
  return {dprime, interval, likelihood, rates};
}

std::vector<SelftestQuantity> ratings_quantities() {
  RatingQuantities quantities;
  const json& cases = reference_numbers("ratings");
  for (const json& one : cases.at("identification"))
    compare_identification(quantities, one.at("input"), one.at("expected"));
  for (const json& one : cases.at("rating")) compare_rating(quantities, one.at("input"), one.at("expected"));
  for (const json& one : cases.at("sureness")) compare_sureness(quantities, one.at("input"), one.at("expected"));
  return quantities.all();
}

}  // namespace jnd
