// jnd device test external: the conformance test of a laboratory's own rig, and its output.
#pragma once

#include <string>

namespace jnd {

struct ExternalTestOptions {
  std::string rig_file, command;  // exactly one
  bool json = false;
  bool yes = false;  // a real rig may present without being asked for
};

// Returns the exit code. Throws InputError and UsageError.
int external_rig_test(const ExternalTestOptions& options);

}  // namespace jnd
