// Single trials in the table of another program: each row becomes a trial with finite numbers, or one is refused with its
// place, whichever options name the columns.
#include <cmath>
#include <string>

#include "protocols/input/input_error.h"
#include "runner/calc/trials_input.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace jnd;

const TrialUse kFuzzedUse = {"the comparison was chosen", {{"comparison", "standard"}}, true, true};

void read(std::string_view text, const TrialOptions& options, const TrialUse& use) {
  try {
    const TrialTable table = parse_trials(std::string(text), "fuzz.csv", options, use);
    fuzz::require(!table.trials.empty() && !table.units.empty(), "trials of somebody");
    for (const CsvTrial& trial : table.trials) {
      fuzz::require(trial.unit < table.units.size(), "a trial is of a unit that there is");
      fuzz::require(std::isfinite(trial.level), "a level is finite");
      fuzz::require(std::abs(trial.order) == (options.order.empty() ? 0 : 1), "an order where one is asked for");
    }
    std::size_t counted = 0;
    for (const auto& unit : count_trials(table)) {
      for (const TrialCount& level : unit) {
        fuzz::require(level.n > 0 && level.k >= 0 && level.k <= level.n, "counts");
        counted += static_cast<std::size_t>(level.n);
      }
    }
    fuzz::require(counted == table.trials.size(), "every trial is counted once");
    for (const TrialUnit& unit : table.units) fuzz::require_printable(printable_lines(unit.name()), "a name");
  } catch (const InputError& error) {
    fuzz::require_printable(printable_lines(error.what()), "a message");
  } catch (const UsageError& error) {
    fuzz::require_printable(printable_lines(error.what()), "a message");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  TrialOptions options;
  options.trials = true;
  options.level = "level";
  options.answer = "answer";
  read(text, options, kSameDifferentUse);
  options.participant = "who";
  options.condition = "condition";
  options.standard = "standard";
  options.order = "order";
  read(text, options, kFuzzedUse);
  return 0;
}
