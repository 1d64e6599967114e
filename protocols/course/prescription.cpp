#include "protocols/course/prescription.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace jnd {
namespace {

constexpr std::string_view kAbove = ", above ", kBelow = ", below ", kNotMeasured = " not measured";
constexpr std::array kOrdinals = {"first", "second", "third"};

const FingerPresentation* hardest(const Presentation& presentation, const Cues& cues) noexcept {
  const bool force = cues.force || cues.kinaesthetic;
  const auto weaker = [force](const FingerPresentation& a, const FingerPresentation& b) {
    return force && a.peak_force_n != b.peak_force_n ? a.peak_force_n < b.peak_force_n
                                                     : a.deepest_penetration < b.deepest_penetration;
  };
  const auto found = std::max_element(presentation.fingers.begin(), presentation.fingers.end(), weaker);
  return found == presentation.fingers.end() ? nullptr : &*found;
}

// None where it was not measured.
std::optional<double> measured(std::string_view measure, const Presentation& presentation, const Condition& condition,
                               const RigRequest& rig) {
  if (!rig.built_in()) {
    const auto found = presentation.measured.find(measure == "depth" ? "peak_depth" : std::string(measure));
    return found == presentation.measured.end() ? std::nullopt : std::optional(found->second);
  }
  const FingerPresentation* const finger = hardest(presentation, condition.cues);
  if (finger == nullptr) return std::nullopt;
  if (measure == "contacts") return finger->contacts;
  if (measure == "peak_force") return finger->peak_force_n;
  if (measure == "depth") return finger->deepest_penetration;
  return finger->mean_speed;
}

std::string with_unit(double value, const PrescribedMeasure& measure, Unit unit) {
  if (measure.unit.empty()) return fmt::format("{:.4g}", value);
  std::string symbol(measure.unit);
  if (unit == Unit::n_per_rad && symbol.front() == 'm') symbol.replace(0, 1, "rad");  // of a joint: depths are angles
  return fmt::format("{:.4g} {}", value, symbol);
}

const PrescribedMeasure& measure_of(const Prescription::Limit& limit) {
  return *std::find_if(kPrescribedMeasures.begin(), kPrescribedMeasures.end(),
                       [&](const PrescribedMeasure& one) { return one.name == limit.measure; });
}

}  // namespace

std::string limit_text(const Prescription::Limit& limit, Unit unit) {
  return fmt::format("{} {:g} to {}", limit.measure, limit.low, with_unit(limit.high, measure_of(limit), unit));
}

const Prescription* prescription_of(const Protocol& protocol, const Condition& condition) noexcept {
  const auto& found = condition.prescription ? condition.prescription : protocol.timeline.prescription;
  return found ? &*found : nullptr;
}

bool judges_exploration(const Protocol& protocol) noexcept {
  return std::any_of(protocol.conditions.begin(), protocol.conditions.end(), [&](const Condition& condition) {
    const Prescription* const prescription = prescription_of(protocol, condition);
    return prescription != nullptr && !prescription->limits.empty();
  });
}

std::string breach_of(const Trial& trial, const std::vector<Presentation>& presentations, const Protocol& protocol) {
  const Condition& condition = protocol.conditions.at(static_cast<std::size_t>(trial.condition));
  const Prescription* const prescription = prescription_of(protocol, condition);
  if (prescription == nullptr) return {};
  std::string line;
  const std::size_t intervals = protocol.task.together ? 1 : presentations.size();
  for (std::size_t i = 0; i < intervals && i < kOrdinals.size(); ++i) {
    for (const Prescription::Limit& limit : prescription->limits) {
      const PrescribedMeasure& measure = measure_of(limit);
      const std::optional<double> value = measured(limit.measure, presentations[i], condition, protocol.rig);
      if (value && *value >= limit.low && *value <= limit.high) continue;
      const auto text = [&](double number) { return with_unit(number, measure, trial.unit); };
      line += line.empty() ? "" : "; ";
      if (intervals > 1) line += fmt::format("{} interval: ", kOrdinals[i]);
      line += limit.measure;
      if (!value)
        line += kNotMeasured;
      else if (*value < limit.low)
        line += fmt::format(" {}{}{}", text(*value), kBelow, text(limit.low));
      else
        line += fmt::format(" {}{}{}", text(*value), kAbove, text(limit.high));
    }
  }
  return line;
}

bool rule_repeats(const Protocol& protocol) noexcept {
  return protocol.stimulus.on_saturation == OnSaturation::repeat ||
         std::any_of(protocol.conditions.begin(), protocol.conditions.end(), [&](const Condition& condition) {
           const Prescription* const prescription = prescription_of(protocol, condition);
           return prescription != nullptr && prescription->on_breach == OnSaturation::repeat;
         });
}

bool breaks_limit(std::string_view breach) noexcept {
  return breach.find(kAbove) != std::string_view::npos || breach.find(kBelow) != std::string_view::npos;
}

}  // namespace jnd
