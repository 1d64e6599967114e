// Traces of a laboratory's own rig: every sample comes back to the bit, and no damaged blob does anything but say so.
#include "data/log/trace_blob.h"

#include <bit>

#include <rapidcheck.h>

#include "data/log/blob_bytes.h"
#include "data/log/telemetry.h"
#include "protocols/input/sha256.h"
#include "tests/catch.h"
#include "tests/data/telemetry_fixture.h"

namespace jnd {
namespace {

double any_value() {
  return std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>());
}

Trace any_trace() {
  Trace trace;
  const int channels = *rc::gen::inRange(1, 6);
  for (int i = 0; i < channels; ++i)
    trace.channels.push_back({std::string(static_cast<std::size_t>(*rc::gen::inRange(0, 41)), 'n'), i == 0 ? "N" : ""});
  const int samples = *rc::gen::inRange(0, 60);
  for (int i = 0; i < samples; ++i)
    trace.samples.push_back({any_value(), any_value(), *rc::gen::inRange(0, channels), any_value()});
  trace.dropped = *rc::gen::inRange<std::int64_t>(0, 1'000'000);
  return trace;
}

bool same_trace(const Trace& a, const Trace& b) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  return a.channels == b.channels && a.dropped == b.dropped &&
         std::equal(a.samples.begin(), a.samples.end(), b.samples.begin(), b.samples.end(),
                    [&](const Trace::Sample& x, const Trace::Sample& y) {
                      return bits(x.heard_s) == bits(y.heard_s) && bits(x.rig_s) == bits(y.rig_s) &&
                             x.channel == y.channel && bits(x.value) == bits(y.value);
                    });
}

bool is_refused(const std::string& bytes) {
  try {
    (void)decode_trace(bytes);
    return false;
  } catch (const StorageError&) {
    return true;
  }
}

Trace small_trace() {
  return {.channels = {{"force", "N"}, {"grip", "N"}},
          .samples = {{0.001, 7.25, 0, 1.5}, {0.001, 7.25, 1, -2}, {0.006, 7.255, 0, 1.75}},
          .dropped = 2};
}

}  // namespace

TEST_CASE("any trace comes back to the bit, and is told from ticks", "[data]") {
  REQUIRE(rc::check([] {
    const Trace trace = any_trace();
    const TelemetryBlob blob = encode_trace(2, trace);
    RC_ASSERT(blob.interval == 2);
    RC_ASSERT(blob.ticks == static_cast<std::int64_t>(trace.samples.size()));
    RC_ASSERT(blob.dropped == trace.dropped);
    RC_ASSERT(blob.sha256 == sha256_hex(blob.bytes));
    RC_ASSERT(is_trace(blob.bytes));
    RC_ASSERT(same_trace(decode_trace(blob.bytes), trace));
  }));
  CHECK_FALSE(is_trace(encode_telemetry(0, press(3)).bytes));
  CHECK(is_refused(encode_telemetry(0, press(3)).bytes));
}

TEST_CASE("a trace that was cut or changed is refused", "[data]") {
  const std::string whole = encode_trace(0, small_trace()).bytes;
  for (std::size_t size = 0; size < whole.size(); ++size) CHECK(is_refused(whole.substr(0, size)));
  const std::string raw = decompressed_blob(whole, 100'000);
  for (std::size_t size = 0; size < raw.size(); ++size) CHECK(is_refused(compressed_blob(raw.substr(0, size))));
  CHECK(is_refused(compressed_blob(raw + "x")));
  const auto changed = [&raw](std::size_t at, char value) {
    std::string bytes = raw;
    bytes[at] = value;
    return compressed_blob(bytes);
  };
  CHECK(is_refused(changed(0, 'J')));
  CHECK(is_refused(changed(8, 2)));                       // of a later version
  CHECK(is_refused(changed(12, 65)));                     // channels
  CHECK(is_refused(changed(16, 4)));                      // samples
  CHECK(is_refused(changed(32, 41)));                     // a name's length
  CHECK(is_refused(changed(raw.size() - 3 * 8 - 1, 9)));  // a sample's channel
  CHECK_THROWS_AS(blob_beginning("no frame", 8), StorageError);
}

TEST_CASE("what cannot be kept is not encoded", "[data]") {
  Trace trace = small_trace();
  trace.samples[1].channel = 2;
  CHECK_THROWS_WITH(encode_trace(0, trace), Catch::Contains("names channel 2"));
  trace = small_trace();
  trace.channels[0].name = std::string(41, 'x');
  CHECK_THROWS_WITH(encode_trace(0, trace), Catch::Contains("41 bytes"));
  trace = small_trace();
  trace.channels.resize(65);
  CHECK_THROWS_AS(encode_trace(0, trace), StorageError);
}

}  // namespace jnd
