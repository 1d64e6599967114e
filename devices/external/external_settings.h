// Where an external rig is to be found: the object "external" of a rig file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "protocols/input/json_document.h"

namespace jnd {

// How long a rig may take, s. A rig file sets the first two; only tests set the others.
struct RigTimeOuts {
  double hello_s = 10;               // from its start to its hello
  double prepare_s = 10;             // from "prepare" to "ready", in all
  double ready_s = 0.1;              // the same of a rig whose hello gives no longer time: then comes its turn
  double late_s = 0;                 // how much later it may be ready all the same
  double silent_s = 2;               // to answer an `alive`; then it is started anew
  double presenting_silent_s = 0.1;  // the same from "present" to "done"; then it is stopped
  double stop_s = 0.2;               // from "stop" to "done"
  double bye_s = 1;                  // from "bye", or the end of its input, to its own end
};

// Exactly one of command, socket and port is given.
struct ExternalSettings {
  std::vector<std::string> command;  // program and arguments: a child process, spoken to by its standard streams
  std::filesystem::path folder;      // where it runs; empty: where this program does
  std::filesystem::path socket;      // of the Unix domain, that the rig listens on
  std::string host = "127.0.0.1";    // of this machine: "127.0.0.1" or "::1"
  int port = 0;                      // TCP; 0: none
  std::string token;                 // over TCP: what the rig's hello has to carry
  RigTimeOuts time_outs;
};

// For messages: the command line, or the address; printable ASCII.
std::string in_words(const ExternalSettings& settings);

// Mistakes go to diagnostics; the settings are then not to be used. folder: of the rig file, which relative paths start
// from and commands run in.
ExternalSettings read_external_settings(const JsonNode& node, const std::filesystem::path& folder,
                                        std::vector<Diagnostic>& diagnostics, const std::string& file);

}  // namespace jnd
