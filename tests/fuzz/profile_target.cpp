// Profiles of simulated participants: accepted, or refused with messages that can be printed.
#include <string>

#include "devices/participants/simulated_participant.h"
#include "protocols/input/input_error.h"
#include "runner/terminal/terminal.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace jnd;
  try {
    const ParticipantProfile profile = parse_profile(std::string(fuzz::text_of(data, size)), "fuzz.json");
    fuzz::require(profile.lapse_rate >= 0 && profile.lapse_rate <= 1, "a rate is a share");
    fuzz::require(!profile.name.empty(), "an accepted profile has a name");
  } catch (const InputError& error) {
    fuzz::require(!error.diagnostics().empty(), "refused without a reason");
    fuzz::require_printable(printable_lines(error.what()), "a message");
  }
  return 0;
}
