// The ticks of one interval as a CSV file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "data/fields/csv_writer.h"
#include "data/log/telemetry.h"
#include "data/log/trace_blob.h"
#include "protocols/protocol.h"

namespace jnd {

struct TelemetryRow {
  const Telemetry* telemetry = nullptr;
  const TickRecord* tick = nullptr;
};

// limit_names: of the bits of TickRecord::limits, lowest first; data does not know the governor.
std::vector<CsvColumn<TelemetryRow>> telemetry_columns(const Protocol& protocol,
                                                       const std::vector<std::string>& limit_names);

// The rows in the order in which they were recorded. `telemetry` must outlive them.
std::vector<TelemetryRow> telemetry_rows(const Telemetry& telemetry);

// The samples of a rig's own trace, one row for each.
struct TraceRow {
  const Trace* trace = nullptr;
  const Trace::Sample* sample = nullptr;
};
std::vector<CsvColumn<TraceRow>> trace_columns();
// `trace` must outlive them.
std::vector<TraceRow> trace_rows(const Trace& trace);

// "telemetry/trial-007-attempt-1-interval-1.csv"; again: 2 and up where that name is taken. what: "trial", or
// "exploration" of free interaction;
// a rig's own trace is "telemetry/trial-007-attempt-1-interval-1-trace.csv".
std::string telemetry_file(std::string_view what, bool trace, int index, int attempt, int interval, int again = 1);

}  // namespace jnd
