#include "data/verify/verify_deep.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include "data/files/draft.h"
#include "data/log/event_body.h"
#include "data/log/exploration_body.h"
#include "data/log/telemetry.h"
#include "data/log/trace_blob.h"
#include "data/study/study_impl.h"
#include "data/study/study_lock.h"
#include "data/verify/verify_course.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_text.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"

namespace jnd {

namespace {

using TellProblem = std::function<void(const std::string&)>;

// Of every device (devices/loop/control_loop.h, devices/loop/governor.h). A tick lasts one period, and one more for
// each that was skipped because the loop woke too late.
constexpr std::int64_t kPeriod_ns = 1'000'000;
constexpr std::int64_t kSoftStart_ns = 200'000'000;
constexpr double kRounding_n = 1e-12;
// Sums in another order of operations; every comparison is relative to the larger value.
constexpr double kTolerance = 1e-9;

bool agree(double a, double b) {
  return a == b || std::abs(a - b) <= kTolerance * std::max({std::abs(a), std::abs(b), 1e-6});
}

// The same sums as devices/loop/interval_summary.cpp makes while the loop runs.
struct Recomputed {
  std::int64_t ticks = 0;
  double peak_force_n = 0, deepest = 0, dwell_s = 0, saturated_s = 0, travel = 0, travel_s = 0;
  int contacts = 0;
  std::int64_t fit_samples = 0;
  double sum_xf = 0, sum_xx = 0;
  bool touching = false;
  double previous = 0;

  void add(const TickRecord& tick, std::int64_t begin_ns) {
    ++ticks;
    peak_force_n = std::max(peak_force_n, tick.measured_n);
    const double x = tick.penetration;
    if (!(x > 0)) {
      touching = false;
      return;
    }
    const std::int64_t periods = 1 + tick.lateness_ns / kPeriod_ns;
    const double duration_s = 1e-9 * static_cast<double>(kPeriod_ns * periods);
    if (touching) {
      travel += std::abs(x - previous);
      travel_s += duration_s;
    } else {
      ++contacts;
    }
    touching = true;
    previous = x;
    dwell_s += duration_s;
    deepest = std::max(deepest, x);
    const bool reduced = tick.asked_n - tick.given_n > kRounding_n;
    if (reduced) saturated_s += duration_s;
    if (reduced || tick.time_ns - begin_ns < kSoftStart_ns) return;
    ++fit_samples;
    sum_xf += x * tick.measured_n;
    sum_xx += x * x;
  }
};

class Comparison {
 public:
  Comparison(const FingerPresentation& finger, const TellProblem& problem) : finger_(finger), problem_(problem) {}

  void number(const char* what, double said, double computed) {
    ++compared;
    if (!agree(said, computed))
      problem_(fmt::format("of the stimulus delivered by the {} device of finger {} it says {} {}; its ticks give {}",
                           to_string(finger_.channel), finger_.finger + 1, what, said, computed));
  }

  std::int64_t compared = 0;

 private:
  const FingerPresentation& finger_;
  const TellProblem& problem_;
};

bool same_devices(const Presentation& presentation, const Telemetry& telemetry) {
  return telemetry_channels(presentation) == telemetry.channels;
}

// By device. Time that runs backwards within a device's ticks is said once.
std::vector<Recomputed> recompute(const Telemetry& telemetry, const TellProblem& problem) {
  std::vector<Recomputed> devices(telemetry.channels.size());
  std::vector<std::int64_t> last_ns(devices.size(), INT64_MIN);
  const std::int64_t begin_ns = telemetry.ticks.empty() ? 0 : telemetry.ticks.front().time_ns;
  bool backwards = false;
  for (const TickRecord& tick : telemetry.ticks) {
    const auto place = static_cast<std::size_t>(tick.channel);
    backwards = backwards || tick.time_ns < last_ns[place];
    last_ns[place] = tick.time_ns;
    devices[place].add(tick, begin_ns);
  }
  if (backwards) problem("the time of its ticks runs backwards");
  return devices;
}

// Compares what an event says of one interval with its ticks. Returns how many numbers were compared. cues: of the
// trial's condition.
std::int64_t check_delivery(const Presentation& presentation, const Telemetry& telemetry, const Cues& cues, Unit unit,
                            const TellProblem& problem) {
  if (telemetry.unit != unit) problem("its ticks are in another unit than the study");
  if (!same_devices(presentation, telemetry)) {
    problem("its ticks are of other devices than it names");
    return 0;
  }
  const std::vector<Recomputed> devices = recompute(telemetry, problem);
  std::int64_t compared = 0;
  // Ticks that are lost leave nothing to compare.
  if (telemetry.dropped > 0) return 0;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const FingerPresentation& finger = presentation.fingers[i];
    const Recomputed& own = devices[i];
    Comparison comparison(finger, problem);
    comparison.number("ticks", static_cast<double>(presentation.ticks), static_cast<double>(own.ticks));
    comparison.number("a peak force in N of", finger.peak_force_n, own.peak_force_n);
    comparison.number("a deepest penetration of", finger.deepest_penetration, own.deepest);
    comparison.number("contacts:", finger.contacts, own.contacts);
    comparison.number("seconds in contact:", finger.dwell_s, own.dwell_s);
    comparison.number("a mean speed of", finger.mean_speed, own.travel_s > 0 ? own.travel / own.travel_s : 0);
    comparison.number("a saturated share of", finger.saturated_share,
                      own.dwell_s > 0 ? own.saturated_s / own.dwell_s : 0);
    const bool force = finger.channel == Channel::cutaneous ? cues.force : cues.kinaesthetic;
    comparison.number("samples fitted:", static_cast<double>(finger.fit_samples),
                      force ? static_cast<double>(own.fit_samples) : 0);
    // A joint whose study is in N/m works with the ratio of two lever arms, which no tick knows.
    const bool ratio = finger.channel == Channel::kinaesthetic && unit == Unit::n_per_m;
    if (finger.stiffness && force && !ratio)
      comparison.number("a stiffness of", *finger.stiffness, own.sum_xx > 0 ? own.sum_xf / own.sum_xx : 0);
    compared += comparison.compared;
  }
  return compared;
}

// The same of free interaction, whose pieces have their ticks in one blob.
std::int64_t check_delivery(const std::vector<Presentation>& pieces, const Telemetry& telemetry, Unit unit,
                            const TellProblem& problem) {
  if (telemetry.unit != unit) problem("its ticks are in another unit than the study");
  if (pieces.empty() || !same_devices(pieces.front(), telemetry)) {
    problem("its ticks are of other devices than it names");
    return 0;
  }
  const std::vector<Recomputed> devices = recompute(telemetry, problem);
  std::int64_t compared = 0;
  if (telemetry.dropped > 0) return 0;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    double ticks = 0, peak_force_n = 0, deepest = 0;
    for (const Presentation& piece : pieces) {
      if (i >= piece.fingers.size()) continue;
      ticks += static_cast<double>(piece.ticks);
      peak_force_n = std::max(peak_force_n, piece.fingers[i].peak_force_n);
      deepest = std::max(deepest, piece.fingers[i].deepest_penetration);
    }
    Comparison comparison(pieces.front().fingers[i], problem);
    comparison.number("ticks", ticks, static_cast<double>(devices[i].ticks));
    comparison.number("a peak force in N of", peak_force_n, devices[i].peak_force_n);
    comparison.number("a deepest penetration of", deepest, devices[i].deepest);
    compared += comparison.compared;
  }
  return compared;
}

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class DeepVerifier {
 public:
  explicit DeepVerifier(const Study& study) : study_(study) {}

  DeepReport run() {
    read_file();
    look_beside();
    try {
      const Protocol protocol = parse_protocol(study_.info().protocol_bytes, study_.info().protocol_name);
      for (const SessionInfo& session : study_.sessions()) check_session(protocol, session);
    } catch (const InputError& error) {
      of_file("The stored protocol cannot be read: {}", error.what());
    }
    return std::move(report_);
  }

 private:
  void problem(const Event& event, const std::string& what, Reveals reveals = Reveals::plan) {
    const std::string where = fmt::format("Session {}, event {} ({})", event.session, event.seq, event.kind);
    report_.problems.push_back({where, fmt::format("{}: {}.", where, what), reveals});
  }

  template <typename... Arguments>
  void of_file(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    report_.problems.push_back(
        {"The file", fmt::format(text, std::forward<Arguments>(arguments)...), Reveals::nothing});
  }

  // Through SQLite's own handle: closing another descriptor of this file would drop the locks of this process.
  void read_file() {
    const Study::Impl& impl = study_.impl();
    const std::scoped_lock lock(impl.mutex);
    sqlite3_file* file = nullptr;
    sqlite3_int64 size = 0;
    if (sqlite3_file_control(impl.database().getHandle(), "main", SQLITE_FCNTL_FILE_POINTER, &file) != SQLITE_OK ||
        file == nullptr || file->pMethods == nullptr || file->pMethods->xFileSize(file, &size) != SQLITE_OK)
      throw StorageError(fmt::format("{}: cannot be read", impl.path.string()));
    std::vector<char> piece(1U << 20U);
    for (sqlite3_int64 at = 0; at < size; at += static_cast<sqlite3_int64>(piece.size())) {
      const auto length = static_cast<int>(std::min(size - at, static_cast<sqlite3_int64>(piece.size())));
      if (file->pMethods->xRead(file, piece.data(), length, at) != SQLITE_OK)
        of_file("The file: bytes {} to {} cannot be read from the disk.", at, at + length - 1);
      else
        report_.bytes += length;
    }
    const auto pages = [&](const char* pragma) {
      return with_storage_errors(impl.path, [&] { return impl.database().execAndGet(pragma).getInt64(); });
    };
    const std::int64_t expected = pages("PRAGMA page_count") * pages("PRAGMA page_size");
    const bool log = fs::exists(impl.path.string() + "-wal");
    if (size != expected && !log) of_file("The file: has {} bytes; its header says {}.", size, expected);
  }

  void look_beside() {
    const fs::path& path = study_.impl().path;
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return;
    if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0)
      of_file("The file: others may write to it (mode {:o}); chmod 600 ends that.",
              static_cast<unsigned>(status.st_mode) & 0777U);
    else if ((status.st_mode & (S_IRGRP | S_IROTH)) != 0)
      report_.findings.push_back(fmt::format("others may read the file (mode {:o}); chmod 600 ends that",
                                             static_cast<unsigned>(status.st_mode) & 0777U));
    const auto beside = [&](const char* suffix) {
      std::error_code ignored;
      return fs::exists(path.string() + suffix, ignored);
    };
    if (in_use(path)) {
      report_.findings.emplace_back("a session or another command is writing to this study just now");
    } else {
      if (beside(".lock"))
        report_.findings.push_back(fmt::format("{}.lock was left by a program that was killed; the next one removes it",
                                               path.filename().string()));
      if (beside("-wal") || beside("-journal"))
        report_.findings.emplace_back(
            "a program that wrote to this study was killed; what it had saved is here, and the next one that writes "
            "puts it into the file");
    }
    for (const fs::path& draft : left_drafts(path))
      report_.findings.push_back(
          fmt::format("{} was left by a program that was killed before it had finished it", draft.filename().string()));
  }

  void check_session(const Protocol& protocol, const SessionInfo& session) {
    const std::vector<Event> events = study_.events(session.id);
    if (events.empty()) return;
    try {
      const Plan plan = make_plan(protocol, session.participant_number, seed_of(events.front()), session.number);
      check_course(protocol, plan, events, [this](const Event& event, const std::string& what, Reveals reveals) {
        problem(event, what, reveals);
      });
      ++report_.sessions;
      for (const Event& event : events) check_telemetry(protocol, event);
    } catch (const std::invalid_argument& error) {
      problem(events.front(), fmt::format("there is no plan: {}", error.what()));
    } catch (const Json::exception& error) {
      problem(events.front(), fmt::format("an event of this session cannot be read: {}", error.what()));
    } catch (const StorageError& error) {
      problem(events.front(), fmt::format("an event of this session cannot be read: {}", error.what()));
    }
  }

  static std::uint64_t seed_of(const Event& opened) {
    const auto text = json_from(opened.body).at("seed").get<std::string>();
    const std::optional<std::uint64_t> seed = seed_from(text);
    if (!seed) throw StorageError(fmt::format("the seed \"{}\" is not a number of 64 bits", text));
    return *seed;
  }

  void check_telemetry(const Protocol& protocol, const Event& event) {
    const bool exploration = event.kind == event_kind::kExploration;
    if (event.kind != event_kind::kTrialCompleted && !exploration) return;
    const std::vector<TelemetryBlob> blobs = study_.telemetry(event.session, event.seq);
    if (blobs.empty()) return;
    const Json body = json_from(event.body);
    const Unit unit = protocol.stimulus.unit;
    for (const TelemetryBlob& blob : blobs) {
      if (is_trace(blob.bytes)) continue;  // nothing of the event was computed from it
      const Telemetry telemetry = decode_telemetry(blob.bytes);
      const auto tell = [&](const std::string& what) {
        problem(event, exploration ? what : fmt::format("interval {}: {}", blob.interval + 1, what));
      };
      ++report_.intervals;
      if (exploration) {
        report_.numbers += check_delivery(exploration_from(body, unit).presentations, telemetry, unit, tell);
        continue;
      }
      const TrialRecord record = trial_record_from(body);
      const auto condition = static_cast<std::size_t>(record.trial.condition);
      if (condition >= protocol.conditions.size() || blob.interval < 0 ||
          static_cast<std::size_t>(blob.interval) >= record.presentations.size())
        continue;  // verify says so
      report_.numbers += check_delivery(record.presentations[static_cast<std::size_t>(blob.interval)], telemetry,
                                        protocol.conditions[condition].cues, unit, tell);
    }
  }

  const Study& study_;
  DeepReport report_;
};

}  // namespace

DeepReport verify_deep(const Study& study) {
  return DeepVerifier(study).run();
}

}  // namespace jnd
