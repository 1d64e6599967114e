// The commands of the program, one function each; runner/command_line.cpp turns arguments into these options.
// Each returns the exit code and prints to stdout. They throw InputError, StorageError and UsageError.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace jnd {

struct NewOptions {
  std::string file;               // to write
  std::string from = "tutorial";  // a shipped protocol
};
int command_new(const NewOptions& options);

struct CheckOptions {
  std::vector<std::string> protocols;
  bool json = false;
};
int command_check(const CheckOptions& options);

struct PlanOptions {
  std::string protocol;
  std::optional<std::string> study;  // its protocol and seed, instead of those here
  int participant = 1;
  int session = 1;  // of that participant, or of everybody's
  std::optional<int> cohort;
  std::optional<std::uint64_t> seed;  // 1 where not given
  bool json = false;
};
int command_plan(const PlanOptions& options);

struct RunOptions {
  std::string protocol;
  std::string study;
  std::string participant;               // asked for where empty
  std::optional<std::uint64_t> seed;     // of a new study; drawn where not given
  std::optional<std::string> responder;  // a profile that answers instead of a person
  bool participant_presses = false;      // who presses the answer keys
  std::string rig = "simulated";         // simulated, hid, or a rig file
  bool fast = false;
  bool plain = false;                             // a line at a time
  std::optional<std::string> kind;                // real or pilot; what the rig is for where not given
  std::optional<std::string> language;            // of the participant's texts
  bool beside = false;                            // another participant's session may stay unfinished
  std::string accept_gap;                         // why a too long interruption does not matter
  std::optional<std::string> override_readiness;  // why a bad finding does not matter
  std::string buttons;                            // a mapping of learn-buttons; empty: only keys answer
  std::string record = "full";                    // off, events, full
  std::string realtime = "prefer";                // off, prefer, require
};
int command_run(const RunOptions& options);

struct SimulateOptions {
  std::string protocol;
  std::optional<std::string> study;
  int participants = 1;
  std::optional<std::uint64_t> seed;
  std::string profile;  // empty: the one that fits the protocol
  int threads = 0;      // 0: as many as the machine has processors
  bool no_study = false;
  bool json = false;
  std::string record = "events";  // off, events, full
};
int command_simulate(const SimulateOptions& options);

struct StudyOptions {
  std::string study;
  bool deep = false;  // of verify
  bool json = false;
};
int command_status(const StudyOptions& options);
int command_verify(const StudyOptions& options);

struct AnalyzeOptions {
  std::string study;
  std::optional<std::string> kind;    // real, pilot or simulated
  std::optional<std::string> by;      // nominal or delivered; without it, what the protocol registers
  std::string models = "registered";  // or "all": every model, method and correction beside the registered one
  bool cells = false;
  bool json = false;
  std::string csv;       // a folder for the results as CSV; empty: none
  bool replace = false;  // that folder, where an earlier one is there
  std::string methods;   // the file for the methods in words; empty: methods.md beside the study
  bool no_methods = false;
};
int command_analyze(const AnalyzeOptions& options);

struct ExportOptions {
  std::string study;
  std::string folder;
  std::optional<std::string> kind;
  std::optional<std::string> by;
  bool replace = false;
  bool telemetry = false;  // the ticks of every interval too
};
int command_export(const ExportOptions& options);

}  // namespace jnd
