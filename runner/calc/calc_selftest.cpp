// jnd calc selftest.
#include <fmt/format.h>

#include "analysis/selftest/selftest.h"
#include "runner/calc/calc.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

struct SelftestOptions {
  bool json = false;
};

int run_selftest(const SelftestOptions& options) {
  bool ok = true;
  nlohmann::ordered_json out = {{"quantities", nlohmann::ordered_json::array()}};
  using Align = TextTable::Align;
  TextTable table({"quantity", "cases", "largest difference", "tolerance", ""},
                  {Align::left, Align::right, Align::right, Align::right, Align::left});
  for (const SelftestQuantity& quantity : selftest()) {
    ok = ok && quantity.ok();
    out["quantities"].push_back({{"name", quantity.name},
                                 {"cases", quantity.cases},
                                 {"largest_difference", json_number(quantity.largest_difference)},
                                 {"tolerance", quantity.tolerance},
                                 {"ok", quantity.ok()}});
    table.add({quantity.name, std::to_string(quantity.cases), fmt::format("{:.1e}", quantity.largest_difference),
               fmt::format("{:.0e}", quantity.tolerance), quantity.ok() ? "ok" : "FAILED"});
  }
  out["ok"] = ok;
  if (options.json) {
    fmt::print("{}\n", json_line(out));
  } else {
    fmt::print("{}{}\n", table.text(),
               ok ? "every quantity agrees with its reference on this machine"
                  : warn("This build of jnd disagrees with its references: do not publish its numbers."));
  }
  return ok ? exit_code::kDone : exit_code::kProblemFound;
}

}  // namespace

void add_calc_selftest(CommandTree& calc) {
  const auto [command, options] = calc.add("selftest", "Recompute independent reference numbers on this machine",
                                           "jnd calc selftest", run_selftest);
  command.add_flag("--json", options.json, "machine-readable");
}

}  // namespace jnd
