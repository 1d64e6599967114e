// Whether participants kept to what they were told to do in every interval: what was measured, held against the limits
// of the protocol's prescription.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/protocol.h"
#include "protocols/vocabulary.h"

namespace jnd {

// What a limit may be on, and its largest value. A depth is in m, a speed in m/s; of a joint whose stiffness is in N/rad
// in rad and rad/s.
struct PrescribedMeasure {
  std::string_view name, unit;
  double most = 0;
};
inline constexpr std::array<PrescribedMeasure, 4> kPrescribedMeasures = {
    {{"contacts", "", 100}, {"peak_force", "N", 100}, {"depth", "m", 3}, {"mean_speed", "m/s", 100}}};

// What holds in a condition: its own, or that of all trials; null where nothing is prescribed.
const Prescription* prescription_of(const Protocol& protocol, const Condition& condition) noexcept;
// Whether trials of any condition are held against limits.
bool judges_exploration(const Protocol& protocol) noexcept;

// What was broken, in one line, as TrialRecord::breach has it: "second interval: peak_force 4.2 N, above 4 N". Of the
// fingers the one counts that pressed hardest: with the greatest peak force, and in a condition without force deepest.
// Of a rig that is none of our devices its own words count: "contacts", "peak_force", "peak_depth" and "mean_speed" of
// Presentation::measured; what it does not measure is "contacts not measured". Empty: all limits were kept, or there are
// none. trial.condition is a place in Protocol::conditions.
std::string breach_of(const Trial& trial, const std::vector<Presentation>& presentations, const Protocol& protocol);

// "peak_force 1 to 4 N".
std::string limit_text(const Prescription::Limit& limit, Unit unit);

// Whether such a line says that a limit was broken, and not only that something was not measured.
bool breaks_limit(std::string_view breach) noexcept;

// Whether a rule of the protocol has trials come again that met a limit: how often one came would say something of what it
// presents.
bool rule_repeats(const Protocol& protocol) noexcept;

}  // namespace jnd
