// Single trials in the table of another program: each row becomes a trial with finite numbers, or one is refused with its
// place, whichever options name the columns.
#include <cmath>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "protocols/input/input_error.h"
#include "runner/calc/trials_input.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace jnd;

const TrialUse kFuzzedUse = {"the comparison was chosen", {{"comparison", "standard"}}, true, true};

// A text as a file in memory, for as long as this lives.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view text) : descriptor_(memfd_create("trials", MFD_CLOEXEC)) {
    fuzz::require(write(descriptor_, text.data(), text.size()) == static_cast<ssize_t>(text.size()),
                  "a file in memory");
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

void read(std::string_view text, const TrialOptions& options, const TrialUse& use) {
  const MemoryFile file(text);
  try {
    const TrialTable table = read_trials(file.path(), options, use);
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
