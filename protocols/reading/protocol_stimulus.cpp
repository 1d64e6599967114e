// Reads what the trials vary, and in which unit: the member "stimulus".
#include <fmt/format.h>

#include "protocols/reading/protocol_reading.h"

namespace jnd {
namespace {

// None where the unit is not known, or is not the rig's: then nothing is said of the members that depend on it.
std::optional<StiffnessUnit> read_unit(JsonReader& reader, ProtocolReading& reading) {
  const JsonNode* written = reader.member("unit");
  for (const char* const larger : {"N/mm", "kN/m"}) {
    if (written == nullptr || written->kind != JsonNode::Kind::string || written->text != larger) continue;
    reading.error(*written, in_quotes(larger) + " is not known", "write \"N/m\" and multiply every stiffness by 1000");
    return std::nullopt;
  }
  const auto unit =
      reader.one_of<StiffnessUnit>("unit", {{"N/m", StiffnessUnit::n_per_m}, {"N/rad", StiffnessUnit::n_per_rad}});
  if (written == nullptr || !reading.sound(written->path)) return std::nullopt;
  if (!reading.knows_rig()) return unit;
  const RigRequest& rig = reading.protocol.rig;
  if (unit == fitting_unit(rig)) return unit;
  reading.error(*written, fmt::format("{} is not the unit of {}", in_quotes(to_string(unit)), in_quotes(rig.device)),
                unit == StiffnessUnit::n_per_rad
                    ? "its contacts are described in \"N/m\"; \"N/rad\" belongs to the rig \"mckibben\""
                    : "force at the fingertip per angle of the joint: write \"N/rad\"");
  return std::nullopt;
}

// A member that has two names, one for each unit.
struct Twofold {
  std::string_view key_m, key_rad;
  NumberLimits limits_m, limits_rad;
  bool required = false;
};

std::optional<double> read_twofold(JsonReader& reader, const Twofold& member, std::optional<StiffnessUnit> unit,
                                   ProtocolReading& reading) {
  if (!unit) {
    const auto in_m = reader.optional_number(member.key_m, member.limits_m);
    const auto in_rad = reader.optional_number(member.key_rad, member.limits_rad);
    return in_m ? in_m : in_rad;
  }
  const bool in_m = *unit == StiffnessUnit::n_per_m;
  const std::string_view key = in_m ? member.key_m : member.key_rad;
  const std::string_view other = in_m ? member.key_rad : member.key_m;
  const NumberLimits& limits = in_m ? member.limits_m : member.limits_rad;
  const JsonNode* misplaced = reader.member(other);
  if (misplaced != nullptr) {
    reading.error(*misplaced,
                  fmt::format("{} belongs to stiffnesses in {}", in_quotes(other),
                              to_string(in_m ? StiffnessUnit::n_per_rad : StiffnessUnit::n_per_m)),
                  fmt::format("these are in {}: write {}, in {}", to_string(*unit), in_quotes(key), limits.unit));
  }
  if (member.required && misplaced == nullptr) return reader.number(key, limits);
  return reader.optional_number(key, limits);
}

}  // namespace

StiffnessUnit fitting_unit(const RigRequest& rig) {
  return acts_on_pulp(rig) ? StiffnessUnit::n_per_m : StiffnessUnit::n_per_rad;
}

NumberLimits stiffness_limits(StiffnessUnit unit) {
  if (unit == StiffnessUnit::n_per_m) return {.min = 1, .max = 20000, .unit = to_string(unit)};
  return {.min = 0.1, .max = 500, .unit = to_string(unit)};
}

void read_stimulus(const JsonNode& node, ProtocolReading& reading) {
  constexpr Twofold kPress{.key_m = "expected_press_m",
                           .key_rad = "expected_press_rad",
                           .limits_m = {.min = 0.0005, .max = 0.03, .unit = "m"},
                           .limits_rad = {.min = 0.01, .max = 0.6, .unit = "rad"},
                           .required = true};
  constexpr Twofold kViscosity{.key_m = "viscosity_n_s_per_m",
                               .key_rad = "viscosity_n_s_per_rad",
                               .limits_m = {.min = 0, .max = 50, .unit = "N s/m"},
                               .limits_rad = {.min = 0, .max = 5, .unit = "N s/rad"}};
  StimulusSpec& stimulus = reading.protocol.stimulus;
  JsonReader reader(node, reading.errors, reading.file);
  stimulus.quantity = reader.one_of<std::string>("quantity", {{"stiffness", "stiffness"}});
  const std::optional<StiffnessUnit> unit = read_unit(reader, reading);
  stimulus.unit = unit.value_or(stimulus.unit);
  stimulus.reference = reader.number("reference", stiffness_limits(stimulus.unit));
  stimulus.expected_press = read_twofold(reader, kPress, unit, reading).value_or(stimulus.expected_press);
  stimulus.damping_n_s_per_m = read_twofold(reader, kViscosity, unit, reading).value_or(0);
  if (!reading.explores()) {
    stimulus.on_saturation =
        reader.one_of<OnSaturation>("on_saturation", {{"flag", OnSaturation::flag}, {"repeat", OnSaturation::repeat}});
  } else if (reader.member("on_saturation") != nullptr) {
    reader.error("on_saturation", "has no meaning without trials", "remove it: saturation is recorded");
  }
  reader.finish();
}

}  // namespace jnd
