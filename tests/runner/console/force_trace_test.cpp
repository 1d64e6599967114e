// What a technician sees of the forces: each device's own, of the last seconds, presentation by presentation.
#include "runner/console/force_trace.h"

#include <cmath>

#include "runner/screen/force_pane.h"
#include "runner/screen/screen_text.h"
#include "tests/catch.h"

namespace jnd {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;

// A press of both fingers: the thumb twice as deep as the index.
void press(TelemetryRing& ring, std::int64_t from_ns, int ticks, double depth_m, double stiffness) {
  for (int i = 0; i < ticks; ++i)
    for (int finger = 0; finger < 2; ++finger) {
      TickRecord tick;
      tick.time_ns = from_ns + i * kTick_ns;
      tick.channel = finger;
      tick.penetration = depth_m * std::sin(3.14159265 * i / ticks) / (finger + 1);
      tick.asked_n = stiffness * tick.penetration;
      tick.measured_n = 0.5 * tick.asked_n;
      ring.push(tick);
    }
}

std::string text_of(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    for (const Span& one : row) text += one.text;
    text += '\n';
  }
  return text;
}

TEST_CASE("a trace has each device's force and depth, and the peaks of one presentation") {
  TelemetryRing ring{100'000};
  ForceTrace trace({"thumb", "index"}, true);
  press(ring, 0, 1000, 0.004, 500);
  trace.take(ring);
  REQUIRE(trace.devices().size() == 2);
  CHECK(trace.devices()[0].samples.size() == 100);  // one every 10 ms
  CHECK(trace.now_ns() == 990'000'000);
  CHECK(peak_text(trace.devices()[0], true) == "peak 1.00 N, 4.0 mm deep");
  CHECK(peak_text(trace.devices()[1], true) == "peak 0.50 N, 2.0 mm deep");
  // What was taken is not there again; the next presentation has peaks of its own and is joined to nothing.
  trace.take(ring);
  CHECK(trace.devices()[0].samples.size() == 100);
  trace.presentation_over();
  press(ring, 2'000'000'000, 1000, 0.002, 500);
  trace.take(ring);
  CHECK(peak_text(trace.devices()[0], true) == "peak 0.50 N, 2.0 mm deep");
  int begins = 0;
  for (const ForceTrace::Sample& sample : trace.devices()[0].samples) begins += sample.begins ? 1 : 0;
  CHECK(begins == 2);
  // Old ones are forgotten, of all devices.
  press(ring, 7'500'000'000, 1000, 0.002, 500);
  trace.take(ring);
  for (const ForceTrace::Device& device : trace.devices()) CHECK(device.samples.front().time_ns >= 3'490'000'000);
  CHECK(peak_text(ForceTrace({"joint"}, false).devices()[0], false) == "peak 0.00 N, 0.000 rad deep");
}

TEST_CASE("a device that nobody named, and ticks that were dropped, break nothing") {
  TelemetryRing ring{10};
  ForceTrace trace({"thumb"}, true);
  press(ring, 0, 1000, 0.004, 500);  // ten of two thousand have room
  trace.take(ring);
  CHECK(trace.devices()[0].samples.size() == 1);
}

TEST_CASE("the pane has a line for each device, and curves where there is room") {
  TelemetryRing ring{100'000};
  ForceTrace trace({"thumb", "index"}, true);
  const Area area{80, true, 24};
  CHECK(text_of(force_rows(area, trace, 12)) == "thumbno force yet\nindexno force yet\n");
  press(ring, 0, 500, 0.004, 500);  // up to the deepest
  press(ring, 500'000'000, 250, 0.004, 500);
  trace.take(ring);
  const std::string whole = text_of(force_rows(area, trace, 12));
  CHECK(whole.find("force N") != std::string::npos);
  CHECK(whole.find("depth mm") != std::string::npos);
  CHECK(whole.find("-5") != std::string::npos);
  CHECK(whole.find("thumb 0.1") != std::string::npos);
  CHECK(whole.find("N asked") != std::string::npos);
  for (int room = 0; room <= 30; ++room)
    for (const int columns : {60, 79, 80, 120, 200}) {
      const std::vector<Row> rows = force_rows({columns, room % 2 == 0, 24}, trace, room);
      CHECK(static_cast<int>(rows.size()) <= std::max(room, 0));
      for (const Row& row : rows)
        for (const Span& one : row) CHECK(one.column + columns_of(one.text) <= columns);
      CHECK((text_of(rows).find("force N") != std::string::npos) == (columns >= 80 && room >= 9));
    }
}

}  // namespace
}  // namespace jnd
