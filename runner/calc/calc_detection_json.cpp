// The JSON line of a row of `jnd calc sdt`.
#include "runner/calc/calc_detection.h"
#include "runner/terminal/json_output.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;

ordered_json yes_no_json(const YesNo& result) {
  return {{"hit_rate", json_number(result.hit_rate)}, {"false_alarm_rate", json_number(result.false_alarm_rate)},
          {"z_hit", json_number(result.z_hit)},       {"z_false_alarm", json_number(result.z_false_alarm)},
          {"dprime", json_number(result.dprime)},     {"criterion", json_number(result.criterion)},
          {"ln_beta", json_number(result.ln_beta)},   {"se", json_number(result.se)},
          {"ci_low", json_number(result.ci_low)},     {"ci_high", json_number(result.ci_high)}};
}

ordered_json profile_json(const DprimeProfile& profile) {
  return {{"dprime", json_number(profile.dprime)},   {"ci_low", json_number(profile.ci_low)},
          {"ci_high", json_number(profile.ci_high)}, {"log_likelihood", json_number(profile.log_likelihood)},
          {"p_value", json_number(profile.p_value)}, {"status", to_string(profile.status)}};
}

ordered_json differencing_json(const Differencing& result) {
  return {{"status", to_string(result.fit.status)},    {"dprime", json_number(result.fit.dprime)},
          {"tau", json_number(result.fit.tau)},        {"se_dprime", json_number(result.fit.se_dprime)},
          {"se_tau", json_number(result.fit.se_tau)},  {"log_likelihood", json_number(result.fit.log_likelihood)},
          {"ci_low", json_number(result.ci_low)},      {"ci_high", json_number(result.ci_high)},
          {"tau_ci_low", json_number(result.tau_low)}, {"tau_ci_high", json_number(result.tau_high)},
          {"p_value", json_number(result.p_value)}};
}

// Under no_sensitivity the likelihood-ratio observer has no d'; the unit slope is sign-reflected.
ordered_json independent_json(const IndependentObservation& result, const YesNo& scores) {
  const bool reflected = scores.status == RateStatus::ok && !(scores.dprime > 0);
  return {{"unit_slope", json_number(result.unit_slope)},
          {"exact", json_number(result.exact)},
          {"status", reflected ? "no_sensitivity" : to_string(scores.status)}};
}

}  // namespace

ordered_json detection_json(const NamedDetectionRow& named) {
  const DetectionRow& row = named.row;
  ordered_json out = {{"id", named.id},
                      {"n_diff", row.counts.n_diff},
                      {"hits", row.counts.hits},
                      {"n_same", row.counts.n_same},
                      {"false_alarms", row.counts.false_alarms},
                      {"status", to_string(row.status)}};
  out["raw"] = {{"hit_rate", json_number(row.none.raw_hit_rate)},
                {"false_alarm_rate", json_number(row.none.raw_false_alarm_rate)}};
  out["yes_no"] = {{"none", yes_no_json(row.none)},
                   {"loglinear", yes_no_json(row.loglinear)},
                   {"half", yes_no_json(row.half)},
                   {"profile", profile_json(row.profile)}};
  out["differencing"] = differencing_json(row.differencing);
  out["differencing_loglinear"] = {{"status", to_string(row.differencing_loglinear.status)},
                                   {"dprime", json_number(row.differencing_loglinear.dprime)},
                                   {"tau", json_number(row.differencing_loglinear.tau)}};
  out["independent"] = {{"loglinear", independent_json(row.independent_loglinear, row.loglinear)},
                        {"half", independent_json(row.independent_half, row.half)}};
  out["bootstrap"] = {{"mean", json_number(row.bootstrap.mean)},
                      {"sd", json_number(row.bootstrap.sd)},
                      {"q025", json_number(row.bootstrap.q025)},
                      {"q975", json_number(row.bootstrap.q975)}};
  return out;
}

}  // namespace jnd
