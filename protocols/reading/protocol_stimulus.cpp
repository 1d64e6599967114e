// Reads what the trials vary, and in which unit: the member "stimulus".
#include <fmt/format.h>

#include "protocols/reading/protocol_reading.h"

namespace jnd {
namespace {

// None where the unit is not known, or is not the rig's: then nothing is said of the members that depend on it.
std::optional<Unit> read_unit(JsonReader& reader, ProtocolReading& reading) {
  const JsonNode* written = reader.member("unit");
  for (const char* const larger : {"N/mm", "kN/m"}) {
    if (written == nullptr || written->kind != JsonNode::Kind::string || written->text != larger) continue;
    reading.error(*written, in_quotes(larger) + " is not known", "write \"N/m\" and multiply every stiffness by 1000");
    return std::nullopt;
  }
  const auto unit = reader.one_of<Unit>("unit", {{"N/m", Unit::n_per_m}, {"N/rad", Unit::n_per_rad}});
  if (written == nullptr || !reading.sound(written->path)) return std::nullopt;
  if (!reading.knows_rig()) return unit;
  const RigRequest& rig = reading.protocol.rig;
  if (unit == fitting_unit(rig)) return unit;
  reading.error(*written, fmt::format("{} is not the unit of {}", in_quotes(to_string(unit)), in_quotes(rig.device)),
                unit == Unit::n_per_rad
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

std::optional<double> read_twofold(JsonReader& reader, const Twofold& member, std::optional<Unit> unit,
                                   ProtocolReading& reading) {
  if (!unit) {
    const auto in_m = reader.optional_number(member.key_m, member.limits_m);
    const auto in_rad = reader.optional_number(member.key_rad, member.limits_rad);
    return in_m ? in_m : in_rad;
  }
  const bool in_m = *unit == Unit::n_per_m;
  const std::string_view key = in_m ? member.key_m : member.key_rad;
  const std::string_view other = in_m ? member.key_rad : member.key_m;
  const NumberLimits& limits = in_m ? member.limits_m : member.limits_rad;
  const JsonNode* misplaced = reader.member(other);
  if (misplaced != nullptr) {
    reading.error(*misplaced,
                  fmt::format("{} belongs to stiffnesses in {}", in_quotes(other),
                              to_string(in_m ? Unit::n_per_rad : Unit::n_per_m)),
                  fmt::format("these are in {}: write {}, in {}", to_string(*unit), in_quotes(key), limits.unit));
  }
  if (member.required && misplaced == nullptr) return reader.number(key, limits);
  return reader.optional_number(key, limits);
}

}  // namespace

Unit fitting_unit(const RigRequest& rig) {
  return acts_on_pulp(rig) ? Unit::n_per_m : Unit::n_per_rad;
}

NumberLimits stiffness_limits(Unit unit) {
  if (unit == Unit::n_per_m) return {.min = 1, .max = 20000, .unit = to_string(unit)};
  return {.min = 0.1, .max = 500, .unit = to_string(unit)};
}

namespace {

// Of a rig that is none of ours: any quantity, in any unit.
void read_named_quantity(JsonReader& reader, ProtocolReading& reading) {
  StimulusSpec& stimulus = reading.protocol.stimulus;
  stimulus.quantity = reader.text("quantity", {.max_length = 32});
  const std::string unit = reader.text("unit", {.max_length = 16});
  if (!unit.empty()) stimulus.unit = Unit::named(unit);
  reader.refuse({"expected_press_m", "expected_press_rad", "viscosity_n_s_per_m", "viscosity_n_s_per_rad"},
                fmt::format("belongs to our own devices, not to {}", in_quotes(reading.protocol.rig.device)),
                "remove it: parameters of a condition say what the rig is to do");
}

// The value that the Weber fraction is of: of pairs it is named, otherwise it is the standard.
void read_reference(JsonReader& reader, ProtocolReading& reading) {
  StimulusSpec& stimulus = reading.protocol.stimulus;
  if (reading.has_pairs() || reading.explores()) {
    stimulus.reference = reader.number("reference", value_limits(reading.protocol));
  } else if (reader.member("reference") != nullptr) {
    reader.error("reference", "has no meaning beside standards", "remove it: each standard is its own reference");
  }
}

void read_on_saturation(JsonReader& reader, ProtocolReading& reading) {
  const bool built_in = reading.protocol.rig.built_in();
  if (!reading.explores() && built_in) {
    reading.protocol.stimulus.on_saturation =
        reader.one_of<OnSaturation>("on_saturation", {{"flag", OnSaturation::flag}, {"repeat", OnSaturation::repeat}});
  } else if (reader.member("on_saturation") != nullptr) {
    reader.error("on_saturation", built_in ? "has no meaning without trials" : "belongs to our own devices",
                 built_in ? "remove it: saturation is recorded" : "remove it");
  }
}

}  // namespace

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
  if (!reading.protocol.rig.built_in()) {
    read_named_quantity(reader, reading);
    read_reference(reader, reading);
    read_on_saturation(reader, reading);
    return reader.finish();
  }
  stimulus.quantity = reader.one_of<std::string>("quantity", {{"stiffness", "stiffness"}});
  const std::optional<Unit> unit = read_unit(reader, reading);
  stimulus.unit = unit.value_or(stimulus.unit);
  read_reference(reader, reading);
  stimulus.expected_press = read_twofold(reader, kPress, unit, reading).value_or(stimulus.expected_press);
  stimulus.damping_n_s_per_m = read_twofold(reader, kViscosity, unit, reading).value_or(0);
  read_on_saturation(reader, reading);
  reader.finish();
}

}  // namespace jnd
