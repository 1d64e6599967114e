#include "analysis/selftest/scaling_quantities.h"

#include "analysis/numerics/special_values.h"
#include "analysis/selftest/reference_numbers.h"

namespace jnd {

namespace {

using nlohmann::json;

// The number under the key; NaN where there is none.
double scaling_number(const json& object, const char* key) {
  return reference_number(object.value(key, json()));
}

struct ScalingQuantities {
  SelftestQuantity means{"magnitudes: geometric means, equal moduli (relative)", 1e-9};
  SelftestQuantity laws{"magnitudes: exponents, errors, intervals (relative)", 1e-9};
  SelftestQuantity refused{"magnitudes: answers that are refused", 0};
  SelftestQuantity settings{"adjustment: PSE, JND, start effect (relative)", 1e-9};
  SelftestQuantity group{"adjustment: group (relative)", 1e-9};
};

void compare_list(SelftestQuantity& quantity, const std::vector<double>& ours, const json& reference) {
  quantity.absolute(static_cast<double>(ours.size()), static_cast<double>(reference.size()));
  for (std::size_t i = 0; i < ours.size() && i < reference.size(); ++i)
    quantity.relative(ours[i], reference_number(reference.at(i)));
}

// By their distances from the middle, whose size is what they are known to: one that ends near 0 has no digits of its own.
void compare_interval(SelftestQuantity& quantity, double middle, double low, double high, const json& reference) {
  quantity.relative(low - middle, reference_number(reference.at(0)) - middle);
  quantity.relative(high - middle, reference_number(reference.at(1)) - middle);
}

void compare_mean(SelftestQuantity& quantity, const MeanInterval& ours, const json& reference) {
  quantity.absolute(ours.n, scaling_number(reference, "n"));
  quantity.relative(ours.mean, scaling_number(reference, "mean"));
  quantity.relative(ours.sd, scaling_number(reference, "sd"));
  quantity.relative(ours.se, scaling_number(reference, "se"));
  compare_interval(quantity, ours.mean, ours.ci_low, ours.ci_high, reference.at("ci"));
}

void compare_law(SelftestQuantity& quantity, const PowerLaw& ours, const json& reference) {
  quantity.relative(ours.exponent, scaling_number(reference, "exponent"));
  quantity.relative(ours.intercept, scaling_number(reference, "intercept"));
  quantity.relative(ours.se, scaling_number(reference, "se"));
  compare_interval(quantity, ours.exponent, ours.ci_low, ours.ci_high, reference.at("ci"));
  quantity.relative(ours.r2, scaling_number(reference, "r2"));
  quantity.relative(ours.residual_sd, scaling_number(reference, "residual_sd"));
}

void compare_refused(SelftestQuantity& quantity, const MagnitudeScale& ours, const json& reference) {
  quantity.absolute(static_cast<double>(ours.refused.size()), static_cast<double>(reference.size()));
  for (std::size_t i = 0; i < ours.refused.size() && i < reference.size(); ++i) {
    const RefusedAnswer& one = ours.refused[i];
    quantity.absolute(static_cast<double>(one.participant), reference.at(i).at(0));
    quantity.absolute(static_cast<double>(one.stimulus), reference.at(i).at(1));
    quantity.absolute(static_cast<double>(one.repeat), reference.at(i).at(2));
    quantity.absolute(one.answer, reference.at(i).at(3));
  }
}

void compare_magnitudes(ScalingQuantities& q, const json& input, const json& expected) {
  const MagnitudeScale ours = magnitude_scale(reference_magnitudes(input));
  if (expected.at("status") == "refused") {
    compare_refused(q.refused, ours, expected.at("not_positive"));
    return;
  }
  q.means.relative(ours.grand_geometric_mean, scaling_number(expected, "grand_geometric_mean"));
  for (std::size_t p = 0; p < ours.participants.size(); ++p) {
    const ParticipantMagnitudes& one = ours.participants[p];
    compare_list(q.means, one.cells, expected.at("cell_geometric_means").at(p));
    compare_list(q.means, one.normalised, expected.at("normalised").at(p));
    q.means.relative(one.geometric_mean, reference_number(expected.at("participant_geometric_mean").at(p)));
    compare_law(q.laws, one.law, expected.at("participants").at(p));
  }
  compare_list(q.means, ours.group_geometric_means, expected.at("group_geometric_means"));
  compare_list(q.means, ours.group_ln_se, expected.at("group_ln_se"));
  compare_law(q.laws, ours.group, expected.at("group"));
  compare_mean(q.laws, ours.exponents, expected.at("exponents"));
}

void compare_settings(SelftestQuantity& quantity, const Adjustment& ours, const json& reference) {
  quantity.absolute(ours.settings.n, scaling_number(reference, "n"));
  quantity.relative(ours.settings.mean, scaling_number(reference, "pse"));
  quantity.relative(ours.constant_error, scaling_number(reference, "constant_error"));
  quantity.relative(ours.settings.sd, scaling_number(reference, "sd"));
  quantity.relative(ours.jnd, scaling_number(reference, "jnd"));
  quantity.relative(ours.weber, scaling_number(reference, "weber"));
  quantity.relative(ours.settings.se, scaling_number(reference, "se"));
  compare_interval(quantity, ours.settings.mean, ours.settings.ci_low, ours.settings.ci_high, reference.at("pse_ci"));
  quantity.relative(ours.mean_from_above, scaling_number(reference, "mean_from_above"));
  quantity.relative(ours.mean_from_below, scaling_number(reference, "mean_from_below"));
  quantity.relative(ours.start_effect, scaling_number(reference, "start_effect"));
  quantity.relative(ours.variable_error, scaling_number(reference, "variable_error"));
  quantity.relative(ours.jnd_within_side, scaling_number(reference, "jnd_within_side"));
  quantity.relative(ours.start_t, scaling_number(reference, "start_t"));
  quantity.relative(ours.start_p, scaling_number(reference, "start_p"));
  if (reference.contains("start_df")) quantity.absolute(ours.start_df, scaling_number(reference, "start_df"));
}

void compare_adjustments(ScalingQuantities& q, const json& input, const json& expected) {
  const std::vector<Adjustment> ours = reference_adjustments(input);
  for (std::size_t p = 0; p < ours.size(); ++p)
    compare_settings(q.settings, ours[p], expected.at("participants").at(p));
  const AdjustmentGroup group = adjustment_group(ours);
  const json& reference = expected.at("group");
  compare_mean(q.group, group.pse, reference.at("pse"));
  compare_mean(q.group, group.constant_error, reference.at("constant_error"));
  q.group.relative(group.constant_error_test.t, scaling_number(reference, "constant_error_t"));
  q.group.relative(group.constant_error_test.p, scaling_number(reference, "constant_error_p"));
  compare_mean(q.group, group.jnd, reference.at("jnd"));
  compare_mean(q.group, group.ln_jnd, reference.at("ln_jnd"));
  q.group.relative(group.jnd_geometric_mean, scaling_number(reference, "jnd_geometric_mean"));
  compare_list(q.group, {group.jnd_geometric_ci_low, group.jnd_geometric_ci_high}, reference.at("jnd_geometric_ci"));
  if (reference.contains("start_effect")) compare_mean(q.group, group.start_effect, reference.at("start_effect"));
  q.group.relative(group.start_effect_test.t, scaling_number(reference, "start_effect_t"));
  q.group.relative(group.start_effect_test.p, scaling_number(reference, "start_effect_p"));
}

}  // namespace

MagnitudeEstimates reference_magnitudes(const json& input) {
  return {input.at("stimuli"), input.at("estimates")};
}

std::vector<Adjustment> reference_adjustments(const json& input) {
  std::vector<Adjustment> participants;
  for (const json& one : input.at("participants")) {
    std::vector<Setting> settings;
    for (std::size_t k = 0; k < one.at("setting").size(); ++k)
      settings.push_back({one.at("setting").at(k), one.at("start").at(k) > 0 ? StartSide::above : StartSide::below});
    participants.push_back(adjustment(settings, input.at("standard")));
  }
  return participants;
}

std::vector<SelftestQuantity> scaling_quantities() {
  ScalingQuantities q;
  for (const json& one : reference_numbers("scaling").at("cases")) {
    const json &input = one.at("input"), &expected = one.at("expected");
    if (input.contains("stimuli"))
      compare_magnitudes(q, input, expected);
    else
      compare_adjustments(q, input, expected);
  }
  return {q.means, q.laws, q.refused, q.settings, q.group};
}

}  // namespace jnd
