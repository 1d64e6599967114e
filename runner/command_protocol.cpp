// jnd new and jnd check: protocols before anyone takes part.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "devices/hid/streamed_tracker.h"
#include "protocols/device_lint.h"
#include "protocols/duration.h"
#include "protocols/json_reader.h"
#include "protocols/plan.h"
#include "protocols/protocol_json.h"
#include "protocols/read_file.h"
#include "runner/commands.h"
#include "runner/json_output.h"
#include "runner/precision_json.h"
#include "runner/precision_text.h"
#include "runner/resources.h"
#include "runner/study_access.h"
#include "runner/terminal.h"

namespace jnd {

namespace {

// False where the file exists. O_EXCL: never over somebody's file, even if two programs do this at once.
bool write_new_file(const std::filesystem::path& path, const std::string& bytes) {
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0 && errno == EEXIST) return false;
  if (descriptor < 0) throw InputError(fmt::format("{} cannot be written: {}", path.string(), std::strerror(errno)));
  const ssize_t written = write(descriptor, bytes.data(), bytes.size());
  close(descriptor);
  if (written == static_cast<ssize_t>(bytes.size())) return true;
  unlink(path.c_str());
  throw InputError(fmt::format("{} could not be written in full; nothing was left behind", path.string()));
}

}  // namespace

int command_new(const NewOptions& options) {
  const std::filesystem::path from = find_resource(Resource::protocol, options.from);
  const std::filesystem::path file = options.file.ends_with(".json") ? options.file : options.file + ".json";
  if (!write_new_file(file, read_input_file(from)))
    throw UsageError(fmt::format("{} exists already; choose another name", file.string()));
  fmt::print("{} written, a copy of {}.\n", printable(file.string()), printable(options.from));
  // The protocol names its schema by a relative path, so that editors help with it.
  const std::filesystem::path schema = from.parent_path() / "protocol.schema.json";
  if (std::filesystem::exists(schema) &&
      write_new_file(file.parent_path() / schema.filename(), read_input_file(schema)))
    fmt::print("  protocol.schema.json is beside it: editors that know JSON Schema help while you type\n");
  fmt::print("  edit it, then:  jnd check {}\n", printable(file.string()));
  return exit_code::kDone;
}

namespace {

// Few enough for an answer at once; `jnd plan --precision` draws more.
constexpr int kDraws = 10'000;
constexpr int kExperiments = 1'000;

struct CheckedFile {
  ProtocolCheck check;
  std::optional<PlannedPrecision> precision;  // of a protocol without errors that has one
  int trials = 0;
  double duration_s = 0;
};

PlannedPrecision planned_precision(const Protocol& protocol) {
  PrecisionQuestion question = precision_question(protocol);
  question.draws = kDraws;
  question.experiments = kExperiments;
  PlannedPrecision planned{precision(question), {}};
  for (const Condition& condition : protocol.conditions)
    planned.sources.push_back(planned_jnd(protocol, condition.name).source);
  return planned;
}

// The objects of free interaction must be there: their files are found by their names.
void look_for_objects(const Protocol& protocol, const std::string& file, ProtocolCheck& check) {
  if (!protocol.explore) return;
  const std::vector<std::string> shipped = shipped_names(Resource::object);
  const JsonNode root = parse_json(protocol.bytes, file);
  for (std::size_t i = 0; i < protocol.explore->objects.size(); ++i) {
    const std::string& name = protocol.explore->objects[i];
    if (std::find(shipped.begin(), shipped.end(), name) != shipped.end()) continue;
    const JsonNode* const explore = root.find("explore");
    check.errors.push_back(diagnostic_at(explore->find("objects")->items[i], file,
                                         fmt::format("there is no object {}", in_quotes(name)),
                                         fmt::format("there are {}", fmt::join(shipped, ", "))));
  }
}

CheckedFile check_file(const std::string& name_or_path) {
  const std::filesystem::path path = find_resource(Resource::protocol, name_or_path);
  CheckedFile result;
  result.check = check_protocol(read_input_file(path), path.string());
  if (!result.check.protocol) return result;
  const Protocol& protocol = *result.check.protocol;
  const DeviceLint lint = lint_against_device(protocol, rig_spec_of(protocol), path.string());
  result.check.errors.insert(result.check.errors.end(), lint.errors.begin(), lint.errors.end());
  result.check.warnings.insert(result.check.warnings.end(), lint.warnings.begin(), lint.warnings.end());
  look_for_objects(protocol, path.string(), result.check);
  result.trials = main_trial_count(make_plan(protocol, 1, 1));
  result.duration_s = expected_duration_s(protocol);
  if (result.check.errors.empty() && has_precision(protocol)) result.precision = planned_precision(protocol);
  return result;
}

// What the rig file has to name, where the fingers' poses come from outside this program.
void print_tracker(const Protocol& protocol) {
  const std::string& tracker = protocol.rig.tracker;
  if (!is_streamed(tracker)) return;
  const char* const is = tracker == "hid"
                             ? "a tracker over USB; where there are several, the rig file gives its serial number"
                         : tracker == "process" ? "a program that writes poses; the rig file names it"
                                                : "a file of poses; the rig file names it";
  fmt::print("  tracker: {}, {} (jnd run --rig FILE)\n", tracker, is);
}

void print_check(const std::string& name, const CheckedFile& result) {
  for (const Diagnostic& error : result.check.errors) fmt::print("error: {}\n", printable(to_text(error)));
  for (const Diagnostic& warning : result.check.warnings)
    fmt::print("{}: {}\n", warn("warning"), printable(to_text(warning)));
  if (!result.check.errors.empty()) {
    fmt::print("{}: {} error{}, {} warning{}\n", printable(name), result.check.errors.size(),
               result.check.errors.size() == 1 ? "" : "s", result.check.warnings.size(),
               result.check.warnings.size() == 1 ? "" : "s");
    return;
  }
  const Protocol& protocol = *result.check.protocol;
  if (protocol.explore) {
    fmt::print(
        "{}: {}\n  {}\n  {} conditions x {:g} s with {} object{}, {} question{}, about {} a session\n  SHA-256 {}\n",
        printable(name), bold("ok"), printable(protocol.title), protocol.conditions.size(),
        protocol.explore->duration_s, protocol.explore->objects.size(),
        protocol.explore->objects.size() == 1 ? "" : "s", protocol.questions.size(),
        protocol.questions.size() == 1 ? "" : "s", duration_text(result.duration_s), protocol.sha256);
    print_tracker(protocol);
    return;
  }
  if (protocol.design.procedure) {
    const AdaptiveProcedure& procedure = *protocol.design.procedure;
    const bool at_most = procedure.reversals > 0;
    fmt::print(
        "{}: {}\n  {}\n  {} conditions x {} track{} = {}{} trials a participant, {:.0f} % of them catch trials, "
        "{}about "
        "{} a "
        "session\n  SHA-256 {}\n",
        printable(name), bold("ok"), printable(protocol.title), protocol.conditions.size(), procedure.starts.size(),
        procedure.starts.size() == 1 ? "" : "s", at_most ? "at most " : "", result.trials, 100 * procedure.catch_share,
        at_most ? "at most " : "", duration_text(result.duration_s), protocol.sha256);
    print_tracker(protocol);
    return;
  }
  fmt::print(
      "{}: {}\n  {}\n  {} conditions x {} series x {} trials a cell = {} trials a participant, about {} a session\n  "
      "SHA-256 {}\n",
      printable(name), bold("ok"), printable(protocol.title), protocol.conditions.size(), protocol.series.size(),
      protocol.design.trials_per_cell, result.trials, duration_text(result.duration_s), protocol.sha256);
  print_tracker(protocol);
  if (result.precision) fmt::print("\n{}", precision_summary(*result.precision, protocol, name));
}

void print_check_json(const CheckedFile& result) {
  nlohmann::ordered_json out;
  const bool ok = result.check.errors.empty();
  out["ok"] = ok;
  out["errors"] = nlohmann::ordered_json::array();
  for (const Diagnostic& error : result.check.errors) out["errors"].push_back(to_json(error));
  out["warnings"] = nlohmann::ordered_json::array();
  for (const Diagnostic& warning : result.check.warnings) out["warnings"].push_back(to_json(warning));
  out["trials"] = ok ? nlohmann::ordered_json(result.trials) : nlohmann::ordered_json(nullptr);
  out["duration_s"] = ok ? nlohmann::ordered_json(result.duration_s) : nlohmann::ordered_json(nullptr);
  out["precision"] =
      result.precision ? precision_json(*result.precision, *result.check.protocol) : nlohmann::ordered_json(nullptr);
  if (ok && result.check.protocol->design.procedure)
    out["trials_at_most"] = result.check.protocol->design.procedure->reversals > 0;
  if (ok) out["tracker"] = result.check.protocol->rig.tracker;
  if (ok) out["sha256"] = result.check.protocol->sha256;
  fmt::print("{}\n", json_line(out));
}

}  // namespace

int command_check(const CheckOptions& options) {
  bool all_ok = true;
  for (const std::string& name : options.protocols) {
    const CheckedFile result = check_file(name);
    all_ok = all_ok && result.check.errors.empty();
    if (options.json)
      print_check_json(result);
    else
      print_check(name, result);
  }
  return all_ok ? exit_code::kDone : exit_code::kInvalidInput;
}

}  // namespace jnd
