// Fields of what the counts of one cell say about sensitivity, model by model.
#pragma once

#include <string>

#include "analysis/detection/detection_row.h"
#include "data/blocks/common_fields.h"
#include "data/blocks/part_fields.h"

namespace jnd {

// found: gives the DetectionRow of a row.
template <typename Of, typename Get>
void add_detection_fields(Fields<Of>& fields, Get found) {
  using Y = YesNo;
  using P = DprimeProfile;
  using D = DifferencingFit;
  using L = Differencing;
  using I = IndependentObservation;
  using B = DprimeBootstrap;
  using Row = DetectionRow;
  const auto part = [found](auto member) {
    return [found, member](const Of& row) { return read(found, row).*member; };
  };
  const auto count = [found](int Counts::*member) {
    return [found, member](const Of& row) { return read(found, row).counts.*member; };
  };
  fields.insert(fields.end(),
                {Field<Of>("n_diff", "counted trials with different stimuli", count(&Counts::n_diff)),
                 common<Of>("hits", count(&Counts::hits)),
                 Field<Of>("n_same", "counted trials with equal stimuli", count(&Counts::n_same)),
                 common<Of>("false_alarms", count(&Counts::false_alarms)), common<Of>("status", part(&Row::status)),
                 Field<Of>("raw.hit_rate", "hits / n_diff",
                           [found](const Of& row) { return read(found, row).none.raw_hit_rate; }),
                 Field<Of>("raw.false_alarm_rate", "false_alarms / n_same",
                           [found](const Of& row) { return read(found, row).none.raw_false_alarm_rate; })});
  const auto add_yes_no = [&](const std::string& key, Y Row::*model) {
    add_parts(fields, "yes_no." + key, "yes-no model of corrected rates", {}, part(model), "hit_rate", &Y::hit_rate,
              "false_alarm_rate", &Y::false_alarm_rate, "z_hit", &Y::z_hit, "z_false_alarm", &Y::z_false_alarm,
              "dprime", &Y::dprime, "criterion", &Y::criterion, "ln_beta", &Y::ln_beta, "se", &Y::se, "ci_low",
              &Y::ci_low, "ci_high", &Y::ci_high);
  };
  add_yes_no("none.", &Row::none);
  add_yes_no("loglinear.", &Row::loglinear);
  add_yes_no("half.", &Row::half);
  add_parts(fields, "yes_no.profile.", "yes-no model of the counts", {}, part(&Row::profile), "dprime", &P::dprime,
            "ci_low", &P::ci_low, "ci_high", &P::ci_high, "log_likelihood", &P::log_likelihood, "status", &P::status);
  const FieldTraits test = {.shown = Shown::p_value};
  add_parts(fields, "yes_no.profile.", "two-sided p of d' = 0", test, part(&Row::profile), "p_value", &P::p_value);
  add_parts(
      fields, "differencing.", "differencing model of the counts", {},
      [found](const Of& row) { return read(found, row).differencing.fit; }, "status", &D::status, "dprime", &D::dprime,
      "tau", &D::tau, "se_dprime", &D::se_dprime, "se_tau", &D::se_tau, "log_likelihood", &D::log_likelihood);
  add_parts(fields, "differencing.", "its profile-likelihood intervals", {}, part(&Row::differencing), "ci_low",
            &L::ci_low, "ci_high", &L::ci_high, "tau_ci_low", &L::tau_low, "tau_ci_high", &L::tau_high);
  add_parts(fields, "differencing.", "one-sided p of d' = 0", test, part(&Row::differencing), "p_value", &L::p_value);
  add_parts(fields, "differencing_loglinear.", "differencing model of log-linear rates", {},
            part(&Row::differencing_loglinear), "status", &D::status, "dprime", &D::dprime, "tau", &D::tau);
  const auto add_independent = [&](const std::string& key, I Row::*model, Y Row::*scores) {
    add_parts(fields, "independent." + key, "d' of independent observations", {}, part(model), "unit_slope",
              &I::unit_slope, "exact", &I::exact);
    // Under no_sensitivity the likelihood-ratio observer has no d'; the unit slope is sign-reflected.
    add_parts(fields, "independent." + key, "whether there is an exact d'", {}, part(scores), "status",
              [](const Y& of) {
                return of.status == RateStatus::ok && !(of.dprime > 0) ? "no_sensitivity" : to_string(of.status);
              });
  };
  add_independent("loglinear.", &Row::independent_loglinear, &Row::loglinear);
  add_independent("half.", &Row::independent_half, &Row::half);
  add_parts(fields, "bootstrap.", "bootstrap of the log-linear d'", {}, part(&Row::bootstrap), "mean", &B::mean, "sd",
            &B::sd, "q025", &B::q025, "q975", &B::q975);
}

}  // namespace jnd
