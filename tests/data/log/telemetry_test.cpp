// Telemetry, traces and trials: what is written comes back, and damage is said.
#include "data/log/telemetry.h"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <rapidcheck.h>
#include <zstd.h>

#include "data/log/blob_bytes.h"
#include "data/log/event_body.h"
#include "data/log/storage_error.h"
#include "data/log/trace_blob.h"
#include "data/log/trial_body.h"
#include "data/study/study_impl.h"
#include "data/verify/verify.h"
#include "protocols/input/sha256.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"
#include "tests/data/telemetry_fixture.h"

namespace jnd {
namespace {

// Telemetry: every tick comes back to the bit, and no damaged blob does anything but say so.

// Any double at all, NaNs and infinities among them: a fault records what it met.
double any_bits() {
  return std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>());
}

constexpr std::int64_t kLongest_ns = std::int64_t{1} << 62;

Telemetry any_telemetry() {
  Telemetry telemetry;
  telemetry.unit = *rc::gen::element(Unit::n_per_m, Unit::n_per_rad);
  telemetry.dropped = *rc::gen::inRange<std::int64_t>(0, std::numeric_limits<std::int64_t>::max());
  const int channels = *rc::gen::inRange(1, 5);
  for (int i = 0; i < channels; ++i)
    telemetry.channels.push_back(
        {*rc::gen::inRange(0, 2), *rc::gen::element(Channel::cutaneous, Channel::kinaesthetic)});
  const int ticks = *rc::gen::inRange(0, 40);
  for (int i = 0; i < ticks; ++i) {
    TickRecord tick;
    tick.time_ns = *rc::gen::inRange<std::int64_t>(0, kLongest_ns);
    tick.lateness_ns = *rc::gen::inRange<std::int64_t>(0, kLongest_ns);
    tick.channel = *rc::gen::inRange(0, channels);
    tick.limits = *rc::gen::arbitrary<std::uint32_t>();
    for (double* value : {&tick.penetration, &tick.asked_n, &tick.given_n, &tick.measured_n, &tick.vibration_g,
                          &tick.travel, &tick.finger_m[0], &tick.finger_m[1], &tick.finger_m[2]})
      *value = any_bits();
    telemetry.ticks.push_back(tick);
  }
  return telemetry;
}

TEST_CASE("any telemetry comes back to the bit", "[data]") {
  REQUIRE(rc::check([] {
    const Telemetry telemetry = any_telemetry();
    const TelemetryBlob blob = encode_telemetry(1, telemetry);
    RC_ASSERT(blob.interval == 1);
    RC_ASSERT(blob.ticks == static_cast<std::int64_t>(telemetry.ticks.size()));
    RC_ASSERT(blob.dropped == telemetry.dropped);
    RC_ASSERT(blob.sha256 == sha256_hex(blob.bytes));
    RC_ASSERT(same_to_the_bit(decode_telemetry(blob.bytes), telemetry));
  }));
}

// Whether the bytes are refused; anything but a StorageError is a failure of its own.
bool refused(const std::string& bytes) {
  try {
    decode_telemetry(bytes);
    return false;
  } catch (const StorageError&) {
    return true;
  }
}

TEST_CASE("a blob that was cut or has any bit changed is refused", "[data]") {
  REQUIRE(rc::check([] {
    const std::string whole = encode_telemetry(0, any_telemetry()).bytes;
    std::string cut = whole.substr(0, *rc::gen::inRange<std::size_t>(0, whole.size()));
    RC_ASSERT(refused(cut));
    std::string flipped = whole;
    const auto bit = *rc::gen::inRange<std::size_t>(0, whole.size() * 8);
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
    // The frame's checksum covers what is inside. Bits of the frame's own header may be without meaning: then the
    // content is unchanged.
    if (!refused(flipped)) RC_ASSERT(same_to_the_bit(decode_telemetry(flipped), decode_telemetry(whole)));
    RC_ASSERT(refused(whole + "x"));
    RC_ASSERT(refused(whole + whole));
  }));
}

std::string compressed(const std::string& raw) {
  std::string bytes(ZSTD_compressBound(raw.size()), '\0');
  bytes.resize(ZSTD_compress(bytes.data(), bytes.size(), raw.data(), raw.size(), 1));
  return bytes;
}

std::string decompressed(const std::string& bytes) {
  std::string raw(ZSTD_getFrameContentSize(bytes.data(), bytes.size()), '\0');
  raw.resize(ZSTD_decompress(raw.data(), raw.size(), bytes.data(), bytes.size()));
  return raw;
}

TEST_CASE("content that is well compressed but no telemetry is refused, whatever it claims", "[data]") {
  // As a program with a fault, or someone who means harm, would write it: the frame and its checksum are right.
  REQUIRE(rc::check([] {
    std::string raw = decompressed(encode_telemetry(0, any_telemetry()).bytes);
    const auto at = *rc::gen::inRange<std::size_t>(0, std::min<std::size_t>(raw.size(), 80));
    raw[at] = static_cast<char>(*rc::gen::arbitrary<std::uint8_t>());
    try {
      const Telemetry read = decode_telemetry(compressed(raw));
      for (const TickRecord& tick : read.ticks) {
        RC_ASSERT(tick.channel >= 0);
        RC_ASSERT(static_cast<std::size_t>(tick.channel) < read.channels.size());
      }
      RC_ASSERT(read.dropped >= 0);
    } catch (const StorageError&) {
    }
  }));
  const std::string raw = decompressed(encode_telemetry(0, press(10)).bytes);
  const auto with = [&](std::size_t at, std::uint8_t value) {
    std::string changed = raw;
    changed[at] = static_cast<char>(value);
    return compressed(changed);
  };
  CHECK_FALSE(refused(compressed(raw)));
  CHECK(refused(compressed("")));
  CHECK(refused(compressed("jndticks")));
  CHECK(refused(with(0, 'J')));
  CHECK_THROWS_WITH(decode_telemetry(with(8, 2)), Catch::Contains("version 2") && Catch::Contains("up to 1"));
  CHECK(refused(with(8, 0)));
  CHECK(refused(with(12, 2)));     // unit
  CHECK(refused(with(16, 1)));     // one device less than there is
  CHECK(refused(with(17, 1)));     // 258 devices
  CHECK(refused(with(20, 1)));     // reserved
  CHECK(refused(with(24, 21)));    // one record more than there is
  CHECK(refused(with(31, 0xFF)));  // 2^63 records
  CHECK(refused(with(39, 0xFF)));  // dropped: more than fits
  CHECK(refused(with(44, 2)));     // channel of the first device
  CHECK(refused(compressed(raw + "x")));
  CHECK(refused(""));
  CHECK(refused("not a zstd frame at all"));
}

TEST_CASE("times that no clock gives are refused, because their differences would overflow", "[data]") {
  for (const std::int64_t time : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, kLongest_ns + 1,
                                  std::numeric_limits<std::int64_t>::max()}) {
    CAPTURE(time);
    Telemetry early = press(3), late = press(3);
    early.ticks[2].time_ns = time;
    late.ticks[2].lateness_ns = time;
    CHECK_THROWS_WITH(decode_telemetry(encode_telemetry(0, early).bytes), Catch::Contains("time that cannot be"));
    CHECK_THROWS_WITH(decode_telemetry(encode_telemetry(0, late).bytes), Catch::Contains("time that cannot be"));
  }
  Telemetry last = press(3);
  last.ticks[2].time_ns = last.ticks[2].lateness_ns = kLongest_ns;
  CHECK_FALSE(refused(encode_telemetry(0, last).bytes));
}

TEST_CASE("a blob that would unpack to more than any telemetry is given up, in bounded memory", "[data]") {
  const std::string bomb = compressed(std::string(500'000'000, '\0'));
  CHECK(bomb.size() < 100'000);
  CHECK_THROWS_WITH(decode_telemetry(bomb), Catch::Contains("larger than any telemetry"));
}

TEST_CASE("records of devices that there are not are refused before they are stored", "[data]") {
  Telemetry telemetry = press(3);
  telemetry.ticks[1].channel = 2;
  CHECK_THROWS_WITH(encode_telemetry(0, telemetry), Catch::Contains("device 2"));
  telemetry.ticks[1].channel = -1;
  CHECK_THROWS_AS(encode_telemetry(0, telemetry), StorageError);
  telemetry = press(1);
  telemetry.channels.resize(kMaxTelemetryChannels + 1);
  CHECK_THROWS_AS(encode_telemetry(0, telemetry), StorageError);
}

TEST_CASE("an event says of its telemetry what verify needs, and says it back", "[data]") {
  Telemetry lossy = press(5);
  lossy.dropped = 7;
  const std::vector<TelemetryBlob> blobs = {encode_telemetry(0, press(4)), encode_telemetry(1, lossy)};
  const auto body = telemetry_body(blobs);
  REQUIRE(body.size() == 2);
  CHECK(body[1] == nlohmann::ordered_json{{"interval", 1}, {"sha256", blobs[1].sha256}, {"ticks", 10}, {"dropped", 7}});
  std::vector<TelemetryBlob> named = named_telemetry({{"telemetry", body}});
  for (std::size_t i = 0; i < 2; ++i) named.at(i).bytes = blobs[i].bytes;
  CHECK(named == blobs);
  CHECK(named_telemetry(nlohmann::ordered_json::object()).empty());
  CHECK_THROWS_AS(named_telemetry({{"telemetry", {{{"interval", 1}}}}}), StorageError);
  CHECK_THROWS_AS(named_telemetry({{"telemetry", {3}}}), StorageError);
}

TEST_CASE("the devices of a presentation are those of its telemetry", "[data]") {
  Presentation presentation;
  presentation.fingers.resize(3);
  presentation.fingers[1].channel = Channel::kinaesthetic;
  presentation.fingers[2].finger = 1;
  CHECK(telemetry_channels(presentation) ==
        std::vector<TelemetryChannel>{{0, Channel::cutaneous}, {0, Channel::kinaesthetic}, {1, Channel::cutaneous}});
}

TEST_CASE("a log in memory keeps telemetry by event, and refuses blobs that the event does not name", "[data]") {
  MemoryLog log;
  const std::vector<TelemetryBlob> blobs = {encode_telemetry(0, press(4))};
  log.append(event_kind::kRealtime, {{"policy", "fifo"}}, {1, 1});
  log.append(event_kind::kDeviceFault, {{"index", 3}, {"telemetry", telemetry_body(blobs)}}, {2, 2}, blobs);
  CHECK(log.telemetry(1).empty());
  CHECK(log.telemetry(2) == blobs);
  CHECK_THROWS_WITH(log.append(event_kind::kDeviceFault, {{"index", 3}}, {3, 3}, blobs), Catch::Contains("telemetry"));
  CHECK(log.events().size() == 2);
}

TEST_CASE("telemetry is stored with its event or not at all", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  const auto study = new_study(path);
  const auto log = study->open_session(new_session(1));
  const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
  append_with_telemetry(*log, trials[0], {press(100), press(50)});
  const std::vector<TelemetryBlob> blobs = study->telemetry("P01-simulated", 2);
  REQUIRE(blobs.size() == 2);
  CHECK(blobs[1].ticks == 100);
  CHECK(same_to_the_bit(decode_telemetry(blobs[0].bytes), press(100)));
  CHECK(same_to_the_bit(decode_telemetry(blobs[1].bytes), press(50)));
  CHECK(study->telemetry("P01-simulated", 1).empty());

  // The event does not name it; the same interval twice; an event that is refused by itself.
  CHECK_THROWS_WITH(log->append(event_kind::kBreakTaken, {{"after_trial", 1}}, {1, 1}, blobs),
                    Catch::Contains("must name the telemetry"));
  const std::vector<TelemetryBlob> twice = {blobs[0], blobs[0]};
  CHECK_THROWS_WITH(
      log->append(event_kind::kBreakTaken, {{"after_trial", 1}, {"telemetry", telemetry_body(twice)}}, {1, 1}, twice),
      Catch::Contains("once"));
  CHECK_THROWS_WITH(append_with_telemetry(*log, trials[0], {press(1), press(1)}), Catch::Contains("completed already"));
  CHECK(log->events().size() == 2);
  append_with_telemetry(*log, trials[1], {press(10), press(10)});
  log->append(event_kind::kBreakTaken, {{"after_trial", 1}, {"duration_s", 1.0}}, {9, 9}, {});
  const VerifyReport report = verify(*study);
  CHECK(report.problems == std::vector<Problem>{});
  CHECK(report.telemetry == 4);
}

TEST_CASE("a disk that fills up while telemetry is written takes back the whole event", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1, SessionKind::real));
  const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
  append_with_telemetry(*log, trials[0], {press(10), press(10)});
  SQLite::Database& database = study->impl().database();
  const int pages = database.execAndGet("PRAGMA page_count").getInt();
  database.exec("PRAGMA max_page_count = " + std::to_string(pages + 3));
  CHECK_THROWS_WITH(append_with_telemetry(*log, trials[1], {press(4000), press(4000)}),
                    Catch::Contains("disk is full"));
  CHECK(log->events().size() == 2);
  CHECK(study->telemetry("P01-real", 3).empty());
  database.exec("PRAGMA max_page_count = 1000000");
  append_with_telemetry(*log, trials[1], {press(4000), press(4000)});
  CHECK(study->telemetry("P01-real", 3).size() == 2);
  study->close_session("P01-real", {9, 9});
  CHECK(verify(*study).problems.empty());
}

// The reader that data/README.md gives to people, run as they would.
TEST_CASE("the lines of Python in the README read what was stored", "[data]") {
  if (std::system("command -v python3 >/dev/null && command -v zstd >/dev/null") != 0) {
    WARN("python3 or zstd is not installed: the README's reader was not run");
    return;
  }
  const std::string readme = bytes_of(std::string(JND_SOURCE_DIR) + "/data/README.md");
  const auto inside = readme.find("b\"jndticks\"");
  REQUIRE(inside != std::string::npos);
  const auto begin = readme.rfind("```python\n", inside) + 10, end = readme.find("```", inside);
  const TemporaryFolder folder;
  std::ofstream(folder / "read.py") << readme.substr(begin, end - begin);
  {
    const auto study = new_study(folder / "study.jnd");
    const auto log = study->open_session(new_session(1));
    append_with_telemetry(*log, make_plan(tutorial(), 1, kSeed).trials[0], {press(100), press(3)});
    study->close();
  }
  const std::string command = "cd '" + folder.path().string() + "' && python3 read.py study.jnd > out.txt 2> err.txt";
  const int status = std::system(command.c_str());
  CAPTURE(bytes_of(folder / "err.txt"));
  REQUIRE(status == 0);
  const std::string out = bytes_of(folder / "out.txt");
  const Telemetry expected = press(100);
  CHECK_THAT(out, Catch::Contains("P01-simulated 2 0 200 ticks") && Catch::Contains("P01-simulated 2 1 6 ticks"));
  double peak = 0;
  for (const TickRecord& tick : expected.ticks) peak = std::max(peak, tick.given_n);
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", peak);
  CHECK_THAT(out, Catch::Contains(std::string("peak force ") + text));
}

// Traces of a laboratory's own rig: every sample comes back to the bit, and no damaged blob does anything but say so.

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

// The one-pass reader of answered trials against the records that were written.

TEST_CASE("a trial is read back from its body as it was written", "[data]") {
  const Plan plan = make_plan(tutorial(), 3, kSeed);
  TrialBodyReader reader(tutorial().stimulus.unit);
  for (const Trial& trial : plan.trials) {
    const int answer = trial.index % 3 == 0 ? kClassSame : kClassDifferent;
    TrialRecord record = record_of(tutorial(), trial, answer);
    record.answer.entered_by = trial.index % 2 == 0 ? EnteredBy::participant : EnteredBy::operator_;
    const CountedTrial read = reader.read(body_text(to_body(record)));
    CHECK(read.index == trial.index);
    CHECK(read.practice == trial.practice);
    CHECK(read.series == trial.series);
    CHECK(read.condition == trial.condition);
    CHECK(read.same() == (trial.target == kClassSame));
    CHECK(read.said_different() == (answer == kClassDifferent));
    CHECK(read.by_participant == (trial.index % 2 == 0));
    CHECK(read.response_time_s == record.answer.response_time_s);
    CHECK(read.duration_s == record.duration_s);
    CHECK(read.saturated_share == largest_saturated_share(record));
    CHECK(read.asked == trial.stimuli);
    for (std::size_t i = 0; i < 2; ++i) {
      double stiffness = 0, work = 0, peak = 0;
      int fits = 0;
      for (const FingerPresentation& finger : record.presentations[i].fingers) {
        if (finger.stiffness) stiffness += *finger.stiffness;
        fits += finger.stiffness ? 1 : 0;
        work += finger.work_j;
        peak = std::max(peak, finger.peak_force_n);
      }
      const auto fingers = static_cast<double>(record.presentations[i].fingers.size());
      CHECK(read.delivered(i).has_value() == (fits > 0));
      if (fits > 0) CHECK(*read.delivered(i) == Approx(stiffness / fits).epsilon(1e-15));
      CHECK(read.cues[i].work_j == Approx(work / fingers).epsilon(1e-15));
      CHECK(read.cues[i].peak_force_n == peak);
    }
  }
}

TEST_CASE("what was not measured is not a number, and what is needed is asked for by name", "[data]") {
  TrialBodyReader reader(Unit::n_per_m);
  const std::string bare =
      R"({"series_place":1,"condition_place":2,"target":1,"said":1,"answer":"different","stimulus_1_n_per_m":900,"stimulus_2_n_per_m":400})";
  const CountedTrial trial = reader.read(bare);
  CHECK(trial.series == 1);
  CHECK(trial.condition == 2);
  CHECK(trial.said_different());
  CHECK_FALSE(trial.delivered(0).has_value());
  CHECK(std::isnan(trial.cues[1].work_j));

  const CountedTrial unfitted = reader.read(
      R"({"series_place":0,"condition_place":0,"target":0,"said":0,"answer":"same","presentations":[{"fingers":[)"
      R"({"stiffness_n_per_m":null,"work_j":0.5,"peak_force_n":2},{"stiffness_n_per_m":600,"work_j":1.5}]},{"fingers":[]}]})");
  CHECK(*unfitted.delivered(0) == 600);
  CHECK(unfitted.cues[0].work_j == 1);
  CHECK(unfitted.cues[0].peak_force_n == 2);
  CHECK_FALSE(unfitted.delivered(1).has_value());

  CHECK_THROWS_WITH(reader.read(R"({"series_place":1,"condition_place":2,"target":1,"said":1})"),
                    Catch::Contains("has no answer"));
  CHECK_THROWS_AS(reader.read(R"({"series_place":"one"})"), StorageError);
  CHECK_THROWS_AS(reader.read(R"({"series_place":1)"), StorageError);
  CHECK_THROWS_AS(reader.read("[]"), StorageError);
  CHECK_THROWS_AS(reader.read(""), StorageError);
}

}  // namespace
}  // namespace jnd
