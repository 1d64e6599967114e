// Reads what the stimuli are presented with: the member "rig".
#include <algorithm>

#include <fmt/format.h>

#include "protocols/reading/protocol_reading.h"

namespace jnd {
namespace {

void read_fingers(const JsonNode& list, ProtocolReading& reading) {
  static const std::vector<std::string_view> kFingers = {"thumb", "index", "middle", "ring", "little"};
  std::vector<std::string>& fingers = reading.protocol.rig.fingers;
  for (const JsonNode& item : list.items) {
    const auto place = word_of(item, kFingers, {}, reading.errors, reading.file);
    if (!place) continue;
    const std::string finger(kFingers[*place]);
    if (std::find(fingers.begin(), fingers.end(), finger) != fingers.end())
      reading.error(item, in_quotes(finger) + " is named twice", "name two different fingers, or one");
    fingers.push_back(finger);
  }
  if (reading.knows_rig() && acts_on_joint(reading.protocol.rig) && list.items.size() > 1) {
    reading.error(list, fmt::format("{} fingers in a rig that drives a joint", list.items.size()),
                  fmt::format("{} has one McKibben finger: name one finger", in_quotes(reading.protocol.rig.device)));
  }
}

void read_tracker(JsonReader& reader, ProtocolReading& reading) {
  static const std::vector<std::string_view> kTrackers = {"hand", "encoder", "hid", "process", "replay"};
  static const std::vector<std::string_view> kOfFingers = {"hand", "hid", "process", "replay"};
  static const std::vector<std::string_view> kOfJoints = {"encoder"};
  RigRequest& rig = reading.protocol.rig;
  if (reading.knows_rig() && reader.node().find("tracker") == nullptr) {  // add one that fits
    const bool joint = acts_on_joint(rig);
    (void)reader.word("tracker", joint ? kOfJoints : kOfFingers, {}, true);
    return;
  }
  const auto place = reader.word("tracker", kTrackers, {}, true);
  if (!place) return;
  rig.tracker = kTrackers[*place];
  if (reading.knows_rig() && (rig.tracker == "encoder") != acts_on_joint(rig)) {
    reader.error(
        "tracker", fmt::format("{} does not tell where the finger of {} is", in_quotes(rig.tracker), rig.device),
        acts_on_joint(rig) ? "a McKibben finger measures its joint itself: write \"encoder\""
                           : "a 3RRS device has no encoder at the joint: write \"hid\", \"process\", \"replay\", "
                             "or \"hand\" for a simulated one");
  }
}

void read_mode(JsonReader& reader, ProtocolReading& reading) {
  RigRequest& rig = reading.protocol.rig;
  rig.mode = reader.one_of_or<RenderingMode>("mode",
                                             {{to_string(RenderingMode::wrench), RenderingMode::wrench},
                                              {to_string(RenderingMode::pd), RenderingMode::pd},
                                              {to_string(RenderingMode::pd_literal), RenderingMode::pd_literal}},
                                             RenderingMode::wrench);
  const JsonNode* mode = reader.node().find("mode");
  if (mode != nullptr && reading.sound(mode->path) && reading.knows_rig() && !acts_on_pulp(rig)) {
    reader.error("mode", "belongs to the 3RRS device, which this rig has not",
                 "remove it: a McKibben finger controls its force");
  }
}

void read_object(JsonReader& reader, ProtocolReading& reading) {
  RigRequest& rig = reading.protocol.rig;
  rig.object = reader.text_or("object", "", {.max_length = 200});
  if (!rig.object.empty() && !is_object_name(rig.object))
    reader.error("object", in_quotes(rig.object) + " cannot be the name of an object",
                 "1 to 32 lower-case letters, digits or -");
}

// What lies between the devices: a sphere, or another object in its place.
void read_sphere_or_object(JsonReader& reader, ProtocolReading& reading) {
  constexpr NumberLimits kRadius{.min = 0.005, .max = 0.2, .unit = "m"};
  RigRequest& rig = reading.protocol.rig;
  read_object(reader, reading);
  if (const JsonNode* object = reader.node().find("object")) {
    const JsonNode* radius = reader.member("sphere_radius_m");
    if (radius != nullptr && reading.sound(object->path)) {
      reading.error(*radius, fmt::format("a sphere beside the object {}", in_quotes(rig.object)),
                    "the object takes the sphere's place: remove one of the two");
    }
    return;
  }
  rig.sphere_radius_m = reader.number("sphere_radius_m", kRadius);
  if (reading.sound("$.rig.separation_m") && reading.sound("$.rig.sphere_radius_m") &&
      2 * rig.sphere_radius_m >= rig.separation_m) {
    reader.error("sphere_radius_m",
                 fmt::format("a sphere of {} m does not fit between devices {} m apart", plain(2 * rig.sphere_radius_m),
                             plain(rig.separation_m)),
                 "the fingers must be able to begin outside it: make it smaller than half of separation_m");
  }
}

// Devices that face each other. Free interaction names its objects elsewhere.
void read_surroundings(JsonReader& reader, ProtocolReading& reading) {
  constexpr NumberLimits kSeparation{.min = 0.02, .max = 0.5, .unit = "m"};
  RigRequest& rig = reading.protocol.rig;
  rig.separation_m = reader.number("separation_m", kSeparation);
  if (!reading.explores()) {
    read_sphere_or_object(reader, reading);
  } else {
    reader.refuse({"sphere_radius_m", "object"}, "has no meaning with the paradigm \"explore\"",
                  "$.explore.objects names what is touched");
  }
  if (const JsonNode* flexion = reader.member("contact_flexion_rad")) {
    reading.error(*flexion, "\"contact_flexion_rad\" belongs to a rig that drives a joint",
                  fmt::format("the fingers of {} meet their object in space: remove it", in_quotes(rig.device)));
  }
}

// A joint meets its object at an angle, and nothing else describes the object.
void read_joint(JsonReader& reader, ProtocolReading& reading) {
  RigRequest& rig = reading.protocol.rig;
  rig.contact_flexion_rad = reader.number("contact_flexion_rad", {.min = 0, .max = 0.5, .above = true, .unit = "rad"});
  for (const char* const key : {"separation_m", "sphere_radius_m", "object"}) {
    if (const JsonNode* node = reader.member(key)) {
      reading.error(
          *node, fmt::format("{} belongs to fingertip devices around a virtual object", in_quotes(key)),
          fmt::format("the joint of {} meets its object at contact_flexion_rad: remove it", in_quotes(rig.device)));
    }
  }
}

// What is written on a specimen: the operator finds it by that, so it is short and plain.
void read_codes(const JsonNode& list, Specimen& specimen, std::vector<std::string>& known, ProtocolReading& reading) {
  for (const JsonNode& item : list.items) {
    const auto code = text_of(item, {.max_length = 16}, reading.errors, reading.file);
    if (!code) continue;
    if (std::find(known.begin(), known.end(), *code) != known.end())
      reading.error(item, fmt::format("two specimens have the code {}", in_quotes(*code)), "codes must differ");
    known.push_back(*code);
    specimen.codes.push_back(*code);
  }
}

void read_specimens(const JsonNode& list, ProtocolReading& reading) {
  RigRequest& rig = reading.protocol.rig;
  std::vector<std::string> codes;
  for (const JsonNode& item : list.items) {
    Specimen specimen;
    JsonReader reader(item, reading.errors, reading.file);
    specimen.value = reader.number("value", {.min = -1e9, .max = 1e9});
    if (const JsonNode* own = reader.array("codes", 1, 20)) read_codes(*own, specimen, codes, reading);
    reader.finish();
    const auto same = [&](const Specimen& other) { return other.value == specimen.value; };
    if (reading.sound(item.path) && std::any_of(rig.specimens.begin(), rig.specimens.end(), same))
      reading.error(item, fmt::format("the value {} is named twice", plain(specimen.value)),
                    "give the codes of all specimens of that value in one list");
    rig.specimens.push_back(std::move(specimen));
  }
  // The order of the codes would tell the operator the order of the values.
  auto by_value = rig.specimens;
  std::sort(by_value.begin(), by_value.end(), [](const Specimen& a, const Specimen& b) { return a.value < b.value; });
  std::vector<std::string> first_codes;
  for (const Specimen& specimen : by_value)
    if (!specimen.codes.empty()) first_codes.push_back(specimen.codes.front());
  if (first_codes.size() < 3 || !reading.sound(list.path)) return;
  const bool rising = std::is_sorted(first_codes.begin(), first_codes.end());
  const bool falling = std::is_sorted(first_codes.rbegin(), first_codes.rend());
  if (rising || falling)
    reading.error(list, "the codes follow the values: whoever hands the specimens over could tell which is greater",
                  "give the codes in no order, such as 4, 7, 2");
}

// A program of the laboratory, or the operator's hands: what they can do says their rig file, or what lies on the table.
void read_other_rig(JsonReader& reader, ProtocolReading& reading) {
  RigRequest& rig = reading.protocol.rig;
  if (rig.device == kSpecimenRig) {
    if (const JsonNode* list = reader.array("specimens", 2, 200)) read_specimens(*list, reading);
  } else if (reader.member("specimens") != nullptr) {
    reader.error("specimens", fmt::format("belong to the rig {}", in_quotes(kSpecimenRig)), "remove them");
  }
  reader.refuse({"fingers", "tracker", "mode", "separation_m", "sphere_radius_m", "object", "contact_flexion_rad"},
                fmt::format("belongs to our own devices, not to {}", in_quotes(rig.device)),
                "remove it: parameters of a condition say what the rig is to do");
  reader.finish();
}

}  // namespace

bool acts_on_pulp(const RigRequest& rig) {
  return rig.device == "rrs3" || rig.device == "rrs3+mckibben";
}

bool acts_on_joint(const RigRequest& rig) {
  return rig.device == "mckibben" || rig.device == "rrs3+mckibben";
}

void read_rig(const JsonNode& node, ProtocolReading& reading) {
  RigRequest& rig = reading.protocol.rig;
  JsonReader reader(node, reading.errors, reading.file);
  rig.device = reader.one_of<std::string>("device", {{"rrs3", "rrs3"},
                                                     {"mckibben", "mckibben"},
                                                     {"rrs3+mckibben", "rrs3+mckibben"},
                                                     {std::string_view(kExternalRig), std::string(kExternalRig)},
                                                     {std::string_view(kSpecimenRig), std::string(kSpecimenRig)}});
  if (reading.explores() && reading.knows_rig() && rig.device != "rrs3")
    reader.error("device", fmt::format("{} cannot go round an object", in_quotes(rig.device)),
                 "free interaction needs fingertip devices alone: \"rrs3\"");
  if (!rig.built_in()) return read_other_rig(reader, reading);
  reader.refuse({"specimens"}, fmt::format("belong to the rig {}", in_quotes(kSpecimenRig)), "remove them");
  reading.protocol.stimulus.unit = fitting_unit(rig);
  if (const JsonNode* fingers = reader.array("fingers", 1, 2)) read_fingers(*fingers, reading);
  read_tracker(reader, reading);
  read_mode(reader, reading);
  if (!reading.knows_rig()) {  // what belongs to it cannot be said either
    for (const char* const key : {"separation_m", "sphere_radius_m", "object", "contact_flexion_rad"})
      reader.ignore(key);
  } else if (acts_on_joint(rig)) {
    read_joint(reader, reading);
  } else {
    read_surroundings(reader, reading);
  }
  reader.finish();
}

}  // namespace jnd
