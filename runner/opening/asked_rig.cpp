#include "runner/opening/asked_rig.h"

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "devices/external/conformance.h"
#include "devices/external/rig_probe.h"
#include "devices/rigs/laboratory_rig.h"
#include "devices/rigs/rig_file.h"
#include "protocols/input/input_error.h"
#include "runner/keys/interrupt.h"

namespace jnd {

AskedRig ask_external_rig(const ExternalSettings& settings, const Protocol* protocol) {
  AskedRig asked;
  Conformance conformance;
  try {
    conformance = check_rig_hello(settings, interrupt_requested());
  } catch (const ProbeInterrupted&) {
    throw Stopped();
  }
  asked.checks = std::move(conformance.checks);
  if (protocol == nullptr) return asked;
  if (protocol->rig.device != kExternalRig)
    asked.problems = {
        fmt::format("the protocol asks for the rig {}, and the rig file names an external one", protocol->rig.device)};
  else if (!conformance.hello)
    asked.problems = {"the rig does not say what it can present: " + asked.checks.back().found};
  else {
    const RigDemand demand = rig_demand(*protocol);
    asked.problems = rig_problems(demand, *conformance.hello);
    asked.cautions = rig_cautions(demand, *conformance.hello);
  }
  return asked;
}

AskedRig ask_rig_of(const std::string& rig_file, const Protocol& protocol) {
  const RigFile file = load_rig_file(rig_file);
  if (!file.external)
    throw InputError(
        fmt::format("{} names no external rig: jnd doctor --rig looks whether its devices are there", rig_file));
  return ask_external_rig(*file.external, &protocol);
}

}  // namespace jnd
