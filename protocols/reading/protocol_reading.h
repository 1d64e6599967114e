// The parts of the protocol loader; used by protocol_json.cpp only.
//
// Reading fills a Protocol section by section and checks every value on its own; lint_design and its neighbours then
// look for contradictions between values. Each part goes on after an error, so that all mistakes are found in one pass.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/input/json_reader.h"
#include "protocols/protocol.h"
#include "protocols/tasks/task.h"

namespace jnd {

struct ProtocolReading {
  const JsonNode& root;
  const std::string& file;
  Protocol& protocol;
  std::vector<Diagnostic>& errors;
  std::vector<Diagnostic>& warnings;

  bool sound(std::string_view path) const { return is_sound(errors, path); }
  // Has the rig's device been read, so that what depends on it can be checked?
  bool knows_rig() const { return !protocol.rig.device.empty() && sound("$.rig.device"); }
  const Task& task() const { return task_of(protocol.task.kind); }
  // Do the answers set the levels? Then there are no series in the file.
  bool adaptive() const;
  // The procedure, once it has been read; else null.
  const AdaptiveProcedure* procedure() const {
    return protocol.design.procedure ? &*protocol.design.procedure : nullptr;
  }
  // Are there series of pairs instead of standards and levels?
  bool has_pairs() const { return task().has_pairs(); }
  // Free interaction instead of trials? What belongs to trials has then no meaning.
  bool explores() const { return !task().has_trials(); }
  void error(const JsonNode& at, std::string message, std::string suggestion = "") {
    errors.push_back(diagnostic_at(at, file, std::move(message), std::move(suggestion)));
  }
  // At the value of that path, or at the nearest value that contains it.
  void error_at(std::string_view path, std::string message, std::string suggestion = "");
  void warn_at(std::string_view path, std::string message, std::string suggestion = "");
};

// The node of a path such as "$.series[1].pair"; null where there is none.
const JsonNode* node_at(const JsonNode& root, std::string_view path);
// A Diagnostic at that path, or at the nearest value that contains it.
Diagnostic diagnostic_at_path(const JsonNode& root, const std::string& file, std::string_view path, std::string message,
                              std::string suggestion);

// protocol_rig.cpp: what the stimuli are presented with. Sets the stimulus's unit to the rig's.
void read_rig(const JsonNode& node, ProtocolReading& reading);
// Has the rig a 3RRS device, or a McKibben finger? Of a known rig.
bool acts_on_pulp(const RigRequest& rig);
bool acts_on_joint(const RigRequest& rig);

// protocol_stimulus.cpp: what is varied. After the rig.
void read_stimulus(const JsonNode& node, ProtocolReading& reading);
Unit fitting_unit(const RigRequest& rig);
NumberLimits stiffness_limits(Unit unit);

// protocol_task.cpp: what a trial asks, and what is compared with what. After the rig and the stimulus.
void read_task(JsonReader& outer, ProtocolReading& reading);
void read_comparisons(JsonReader& outer, ProtocolReading& reading);
void lint_task(ProtocolReading& reading);
// {"from", "to", "step"}: values at equal distances, the first and the last among them, at most 400. Each is the number
// that its decimals say: 0.55 is not 0.5 + 0.05.
std::vector<double> read_steps(const JsonNode& node, const NumberLimits& limits, ProtocolReading& reading);
// After the design: what a series presents at most, and the value that its participants have an idea of.
void set_extremes(Protocol& protocol);
// What a value of the study's quantity may be.
NumberLimits value_limits(const Protocol& protocol);

// protocol_trial.cpp: how a trial goes. After the task.
void read_trial(const JsonNode& node, ProtocolReading& reading);
// What participants are told to do in every interval: of all trials, or of a condition.
Prescription read_prescription(const JsonNode& node, ProtocolReading& reading);

// protocol_factors.cpp: conditions, series and the design that crosses them.
void read_conditions(const JsonNode& list, ProtocolReading& reading);
void read_series(const JsonNode& list, ProtocolReading& reading);
void read_design(const JsonNode& node, ProtocolReading& reading);
// protocol_procedure.cpp: how the answers set the levels. Sets the one series and the trials of a cell.
void read_procedure(const JsonNode& node, ProtocolReading& reading);
// protocol_posterior.cpp: levels and utility of the Bayesian procedure; grid and prior of the response model; and, once the
// series are known, whether that makes a model.
void read_posterior(JsonReader& reader, AdaptiveProcedure& procedure, ProtocolReading& reading);
void read_response_model(JsonReader& reader, AdaptiveProcedure& procedure, ProtocolReading& reading);
void lint_response_model(const JsonNode& node, const AdaptiveProcedure& procedure, ProtocolReading& reading);
void warn_about_response_model(const AdaptiveProcedure& procedure, ProtocolReading& reading);
inline constexpr std::string_view kProcedurePath = "$.design.procedure";
// The path of one of its members.
std::string procedure_path(std::string_view member);
// Where a file says how far the levels of its procedure reach.
std::string limits_path(const AdaptiveProcedure& procedure);
// A name that CSV files, streams of random numbers and command lines can carry: [A-Za-z0-9_+-]{1,16}.
std::optional<std::string> read_name(JsonReader& reader, std::string_view key, ProtocolReading& reading);
// Places of conditions and series by name; an unknown name is reported.
std::optional<int> condition_place(const JsonNode& name, ProtocolReading& reading);
std::optional<int> series_place(const JsonNode& name, ProtocolReading& reading);

// protocol_groups.cpp: groups of participants. After the conditions; the other two are members of other sections.
void read_groups(const JsonNode& list, ProtocolReading& reading);
void read_allotment(JsonReader& design, ProtocolReading& reading);
void read_between_test(JsonReader& tests, ProtocolReading& reading);
void lint_groups(ProtocolReading& reading);

// protocol_session.cpp: what surrounds the trials.
void read_practice(const JsonNode& node, ProtocolReading& reading);
void read_breaks(const JsonNode& list, ProtocolReading& reading);

// protocol_explore.cpp: free interaction. Reports the members of outer that only trials have.
void read_explore(const JsonNode& node, ProtocolReading& reading);
void refuse_trials(JsonReader& outer);
void lint_explore(ProtocolReading& reading);
// The name of a virtual object, which is also the name of its file: [a-z0-9-]{1,32}, so that it cannot leave a folder.
bool is_object_name(std::string_view name) noexcept;

// protocol_questions.cpp: what is asked and filled in.
void read_questions(const JsonNode& list, ProtocolReading& reading);
void read_checklist(const JsonNode& list, ProtocolReading& reading);
void lint_question_ids(ProtocolReading& reading);
std::string read_id(JsonReader& reader, std::string_view key);

// protocol_people.cpp: what people are told, in which language, and how an interrupted session goes on.
void read_instructions(const JsonNode& list, ProtocolReading& reading);
void read_resume(const JsonNode& node, ProtocolReading& reading);
void read_language(JsonReader& reader, ProtocolReading& reading);
// After everything that has texts.
void read_translations(const JsonNode& node, ProtocolReading& reading);
void warn_about_translations(ProtocolReading& reading);

// protocol_analysis.cpp: what is registered about the results, and where the design comes from.
void read_source(const JsonNode& node, ProtocolReading& reading);
void read_published(const JsonNode& list, ProtocolReading& reading);
void read_assumed(const JsonNode& list, ProtocolReading& reading);
void read_analysis(const JsonNode& node, ProtocolReading& reading);

// protocol_lint.cpp: contradictions (errors) between sections.
void lint_protocol(ProtocolReading& reading);
// protocol_warnings.cpp: what a reviewer would ask about. Only for protocols without errors.
void warn_about_protocol(ProtocolReading& reading);
// Levels that could hardly move, or go below 0.
void warn_about_procedure(const AdaptiveProcedure& procedure, ProtocolReading& reading);

}  // namespace jnd
