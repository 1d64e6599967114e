#include "runner/opening/protocol_fitness.h"

#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "devices/contact/object_json.h"
#include "devices/rigs/rig_factory.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/read_file.h"
#include "protocols/input/resources.h"
#include "protocols/reading/protocol_reading.h"
#include "protocols/rigs/device_lint.h"
#include "protocols/rigs/rig_description.h"
#include "runner/opening/study_access.h"

namespace jnd {

namespace {

// Errors as they are where they name a file of their own, such as a device's; else at `place` in the protocol.
std::vector<Diagnostic> placed(const InputError& error, const JsonNode& root, const std::string& file,
                               std::string_view place) {
  std::vector<Diagnostic> diagnostics;
  for (const Diagnostic& one : error.diagnostics()) {
    const std::string spoken = std::string(place) + " ";  // the place stands before the message anyway
    diagnostics.push_back(
        one.file.empty()
            ? diagnostic_at_path(root, file, place,
                                 one.message.starts_with(spoken) ? one.message.substr(spoken.size()) : one.message,
                                 one.suggestion)
            : one);
  }
  return diagnostics;
}

// Runs `look`; what it refuses is added to `diagnostics`. False where it refused.
template <typename Look>
bool looked(const Look& look, const JsonNode& root, const std::string& file, std::string_view place,
            std::vector<Diagnostic>& diagnostics) {
  try {
    look();
    return true;
  } catch (const InputError& error) {
    for (Diagnostic& one : placed(error, root, file, place)) diagnostics.push_back(std::move(one));
    return false;
  }
}

// The member of the protocol that a rig's refusal speaks of: "$.rig.tracker \"x\" cannot ..." is about $.rig.tracker.
std::string place_named_in(std::string_view message) {
  const std::size_t begin = message.find("$.");
  if (begin == std::string_view::npos) return "$.rig";
  const std::size_t end = message.find_first_not_of("$._[]0123456789abcdefghijklmnopqrstuvwxyz", begin);
  std::string place(message.substr(begin, end - begin));
  while (place.ends_with('.')) place.pop_back();
  return place;
}

class Fitness {
 public:
  Fitness(const Protocol& protocol, const std::string& file, ProtocolCheck& check)
      : protocol_(protocol), file_(file), root_(parse_json(protocol.bytes, file)), check_(check) {}

  void look() {
    if (!protocol_.rig.built_in()) return rehearse();
    RigSpec spec;
    if (!looked([&] { spec = rig_spec_of(protocol_); }, root_, file_, "$.rig.device", check_.errors)) return;
    const DeviceLint lint = lint_against_device(protocol_, spec, file_);
    check_.errors.insert(check_.errors.end(), lint.errors.begin(), lint.errors.end());
    check_.warnings.insert(check_.warnings.end(), lint.warnings.begin(), lint.warnings.end());
    look_for_objects();
    if (check_.errors.empty()) rehearse();
  }

 private:
  void look_for_object(const std::string& name, const std::string& place) {
    looked([&] { (void)load_object(find_resource(Resource::object, name)); }, root_, file_, place, check_.errors);
  }

  void look_for_objects() {
    if (!protocol_.rig.object.empty()) look_for_object(protocol_.rig.object, "$.rig.object");
    if (!protocol_.explore) return;
    for (std::size_t i = 0; i < protocol_.explore->objects.size(); ++i)
      look_for_object(protocol_.explore->objects[i], fmt::format("$.explore.objects[{}]", i));
  }

  // The rig as a rehearsal makes it, with the participant whom the protocol gets where a user names none.
  void rehearse() {
    std::vector<Diagnostic>& refused = is_streamed(protocol_.rig.tracker) ? check_.warnings : check_.errors;
    try {
      const ParticipantProfile profile = load_profile(find_resource(Resource::profile, default_profile(protocol_)));
      SimulatedClock clock(0);
      (void)make_simulated_rig(protocol_, rig_of(protocol_), profile, 1, 1, clock);
      (void)make_simulated_participant(profile, protocol_, 1, 1, clock);
    } catch (const InputError& error) {
      for (Diagnostic& one : placed(error, root_, file_, place_named_in(error.what())))
        refused.push_back(std::move(one));
    }
  }

  const Protocol& protocol_;
  const std::string& file_;
  JsonNode root_;
  ProtocolCheck& check_;
};

}  // namespace

ProtocolCheck check_fitness(const std::filesystem::path& path) {
  return check_fitness_of(read_input_file(path), path.string());
}

ProtocolCheck check_fitness_of(std::string bytes, const std::string& file) {
  ProtocolCheck check = check_protocol(std::move(bytes), file);
  if (check.protocol) Fitness(*check.protocol, file, check).look();
  return check;
}

}  // namespace jnd
