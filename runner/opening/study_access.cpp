#include "runner/opening/study_access.h"

#include <random>

#include <fmt/format.h>

#include "analysis/numerics/words.h"
#include "data/copies/rescued_copy.h"
#include "data/fields/number_text.h"
#include "data/log/event_body.h"
#include "data/results/study_results.h"
#include "data/study/blinding.h"
#include "data/verify/verify.h"
#include "devices/contact/object_json.h"
#include "protocols/input/resources.h"
#include "protocols/reading/protocol_difference.h"
#include "protocols/reading/protocol_json.h"
#include "runner/opening/protocol_fitness.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

RigSpec rig_spec_of(const Protocol& protocol) {
  if (!protocol.rig.built_in()) {  // it describes itself, or needs no description
    RigSpec spec;
    spec.name = protocol.rig.device;
    return spec;
  }
  return load_rig_spec(find_resource(Resource::device_spec, protocol.rig.device));
}

RigDescription rig_of(const Protocol& protocol) {
  RigDescription rig{.spec = rig_spec_of(protocol)};
  if (!protocol.rig.object.empty())
    rig.object = load_object(find_resource(Resource::object, protocol.rig.object)).shape;
  if (protocol.explore)
    for (const std::string& name : protocol.explore->objects)
      rig.objects[name] = load_object(find_resource(Resource::object, name)).shape;
  return rig;
}

Protocol load_checked_protocol(const std::string& name_or_path) {
  ProtocolCheck check = check_fitness(find_resource(Resource::protocol, name_or_path));
  if (!check.errors.empty()) throw InputError(std::move(check.errors));
  return std::move(*check.protocol);
}

namespace {

// Another file than the study's: the same document in other bytes is recorded, anything else is refused with what
// differs.
void accept_or_refuse(Study& study, const std::filesystem::path& path, const Protocol& protocol, Stamp stamp) {
  const StudyInfo& info = study.info();
  const ProtocolDifference difference = difference_of(info.protocol_bytes, protocol.bytes);
  if (!difference.same_meaning) {
    std::string message = fmt::format(
        "the study {} was made with another protocol ('{}', SHA-256 {}...), not with this one ('{}', {}...); "
        "go on with the protocol it was made with, or start a new study file",
        path.string(), info.protocol_name, info.protocol_sha256.substr(0, 12), protocol.name,
        protocol.sha256.substr(0, 12));
    for (const std::string& line : difference.lines) message += "\n  " + line;
    throw InputError(message);
  }
  for (const Event& event : study.study_events())
    if (event.kind == event_kind::kReworded && event.body.find(protocol.sha256) != std::string::npos) return;
  study.add_study_event(event_kind::kReworded, {{"sha256", protocol.sha256}, {"name", protocol.name}}, stamp);
}

}  // namespace

void require_sound(const std::filesystem::path& study) {
  const std::size_t problems = verify(*Study::open(study, Study::Access::read_only)).problems.size();
  if (problems > 0)
    throw BrokenChain(fmt::format(
        "{}: jnd verify finds {} in it, so nothing is written into it. Go on with a backup, or with what jnd "
        "recover makes of this file",
        study.string(), counted(static_cast<std::int64_t>(problems), "problem")));
}

std::unique_ptr<Study> open_or_create_study(const std::filesystem::path& path, const Protocol& protocol,
                                            std::optional<std::uint64_t> seed, Stamp stamp) {
  refuse_rescued(path);
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    if (!seed) {
      std::random_device device;
      seed = (std::uint64_t{device()} << 32U) | device();
    }
    return Study::create(path, protocol.name, protocol.bytes, *seed, stamp);
  }
  std::unique_ptr<Study> study = Study::open(path, Study::Access::read_write);
  const StudyInfo& info = study->info();
  if (info.protocol_sha256 != protocol.sha256) accept_or_refuse(*study, path, protocol, stamp);
  if (seed && *seed != info.seed)
    throw UsageError(
        fmt::format("the study {} has seed {}, not {}; leave --seed out to go on with it, or start a new study file",
                    path.string(), seed_text(*study, protocol, "sealed while it is blinded"), *seed));
  return study;
}

Protocol protocol_of(const Study& study) {
  return parse_protocol(study.info().protocol_bytes, study.info().protocol_name + ".json");
}

SessionKind kind_to_analyse(const Study& study, const std::optional<std::string>& named) {
  const std::vector<SessionKind> kinds = kinds_in(study);
  if (named) {
    const std::optional<SessionKind> kind = session_kind_from(*named);
    if (!kind)
      throw UsageError(fmt::format("'{}' is not a kind of session; there are real, pilot and simulated", *named));
    return *kind;
  }
  return kinds.empty() ? SessionKind::real : kinds.front();
}

void say_other_kinds(const Study& study, SessionKind analysed) {
  for (const SessionKind kind : kinds_in(study))
    if (kind != analysed)
      fmt::print("{}\n", warn(fmt::format("This study also has {} sessions; they are not in these numbers (--kind {}).",
                                          to_string(kind), to_string(kind))));
}

DifferenceSource source_to_analyse(const Protocol& protocol, const std::optional<std::string>& named) {
  if (!named) return registered_source(protocol);
  // Mixed is what an analysis finds, not what can be asked for.
  const std::optional<DifferenceSource> source = value_of(kDifferenceSourceWords, *named);
  if (source && *source != DifferenceSource::mixed) return *source;
  throw UsageError(fmt::format("'{}': --by takes nominal or delivered", *named));
}

}  // namespace jnd
