// Studies to damage, and what must hold of whatever comes out of them.
#pragma once

#include <map>
#include <vector>

#include "data/copies/recover.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"
#include "tests/data/telemetry_fixture.h"

namespace jnd {

inline constexpr Stamp kLater{1'700'100'000'000'000'000, 77};

// Two whole sessions, and one that is still open and has telemetry which goes over many pages.
inline void fill_study(Study& study) {
  run_whole_session(study, tutorial(), 1);
  run_whole_session(study, tutorial(), 2, SessionKind::pilot);
  const auto log = study.open_session(new_session(3));
  const std::vector<Trial> trials = make_plan(tutorial(), 3, kSeed).trials;
  for (int i = 0; i < 3; ++i)
    append_with_telemetry(*log, trials[static_cast<std::size_t>(i)], {press(150 + i), press(60 + i)});
}

inline std::filesystem::path filled_study(const TemporaryFolder& folder) {
  const auto path = folder / "study.jnd";
  fill_study(*new_study(path));
  return path;
}

struct StudyContent {
  std::map<std::string, std::vector<Event>> events;                                      // by session
  std::map<std::pair<std::string, std::int64_t>, std::vector<TelemetryBlob>> telemetry;  // by session and seq
};

inline StudyContent content_of(const std::filesystem::path& path) {
  const auto study = Study::open(path, Study::Access::read_only);
  StudyContent content;
  for (const SessionInfo& session : study->sessions()) {
    content.events[session.id] = study->events(session.id);
    for (const Event& event : content.events[session.id])
      if (auto blobs = study->telemetry(session.id, event.seq); !blobs.empty())
        content.telemetry[{session.id, event.seq}] = std::move(blobs);
  }
  return content;
}

inline bool same_event(const Event& a, const Event& b) {
  return a.session == b.session && a.seq == b.seq && a.kind == b.kind && a.stamp.utc_ns == b.stamp.utc_ns &&
         a.stamp.monotonic_ns == b.stamp.monotonic_ns && a.version == b.version && a.body == b.body && a.hash == b.hash;
}

inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

// How many events of a session are the same in `now`, from the first one on; fails where one differs or is new.
inline std::size_t kept_of(const StudyContent& before, const StudyContent& now, const std::string& session) {
  const auto found = now.events.find(session);
  if (found == now.events.end()) return 0;
  const std::vector<Event>& original = before.events.at(session);
  REQUIRE(found->second.size() <= original.size());
  for (std::size_t i = 0; i < found->second.size(); ++i) REQUIRE(same_event(found->second[i], original[i]));
  return found->second.size();
}

}  // namespace jnd
