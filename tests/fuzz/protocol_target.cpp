// Protocol files: every input is a protocol or a list of mistakes. An accepted one has a plan, its diagnostics can be
// printed, and its bytes are kept.
#include <string>

#include "protocols/input/input_error.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "runner/terminal/terminal.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

// A plan of a million trials is right, and slow.
bool small(const jnd::Protocol& protocol) {
  return protocol.design.trials_per_cell <= 64 && protocol.design.participants <= 64 &&
         (!protocol.practice || protocol.practice->trials * protocol.practice->max_rounds <= 256);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace jnd;
  const std::string bytes(fuzz::text_of(data, size));
  const ProtocolCheck check = check_protocol(bytes, "fuzz.json");
  for (const Diagnostic& error : check.errors) fuzz::require_printable(printable_lines(to_text(error)), "an error");
  for (const Diagnostic& warning : check.warnings)
    fuzz::require_printable(printable_lines(to_text(warning)), "a warning");
  fuzz::require(check.protocol.has_value() || !check.errors.empty(), "refused without a reason");
  if (!check.protocol || !check.errors.empty()) return 0;
  const Protocol& protocol = *check.protocol;
  fuzz::require(protocol.bytes == bytes, "the bytes are kept");
  if (!small(protocol)) return 0;
  const Plan plan = make_plan(protocol, 1, 7);
  fuzz::require(!plan.trials.empty() || !plan.explorations.empty(), "a plan has something to do");
  for (const Trial& trial : plan.trials)
    fuzz::require(trial.condition >= 0 && trial.condition < static_cast<int>(protocol.conditions.size()),
                  "a trial's condition is the protocol's");
  return 0;
}
