// The lines of a session's events, and readers that are slow, stuck or gone.
#include "runner/events/event_feed.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <set>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/temporary_folder.h"
#include "tests/text_checks.h"
#include "tests/wait_until.h"

namespace jnd {
namespace {

struct FeedPipe {
  FeedPipe() {
    int ends[2] = {-1, -1};
    REQUIRE(pipe2(ends, O_CLOEXEC) == 0);
    reads = OwnedFile(ends[0]);
    writes = OwnedFile(ends[1]);
  }
  std::string where() const { return std::to_string(writes.get()); }
  // Everything, once nobody writes any more.
  std::string rest() {
    writes.close();
    std::string text;
    std::array<char, 4096> bytes{};
    for (ssize_t count = 0; (count = read(reads.get(), bytes.data(), bytes.size())) > 0;)
      text.append(bytes.data(), static_cast<std::size_t>(count));
    return text;
  }
  OwnedFile reads, writes;
};

std::vector<nlohmann::json> parsed(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

TrialOutline outline_of(int plan_number) {
  TrialOutline outline;
  outline.plan_number = plan_number;
  outline.condition_code = "A";
  outline.attempt = 2;
  return outline;
}

void one_trial(EventFeed& feed, int number) {
  const CueSignal cue{.kind = "sound", .say = "First."};
  feed.trial(outline_of(number));
  CHECK_FALSE(feed.cue(CuePlace::first, cue));
  feed.interval_over();
  feed.cue(CuePlace::second, cue);
  feed.interval_over();
  feed.cue(CuePlace::question, cue);
  Answer answer;
  answer.response_time_s = 1.25;
  feed.answered(outline_of(number), answer);
}

std::string said_of(const std::string& where) {
  try {
    const EventFeed feed(where);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

}  // namespace

TEST_CASE("Every event is a line with its time and number, in order", "[event_feed]") {
  FeedPipe pipe;
  {
    EventFeed feed(pipe.where());
    feed.happened(moment::kBegan);
    one_trial(feed, 5);
    feed.voided(outline_of(6), "saturated");
    feed.voided(outline_of(7), "sensor_stuck");
    feed.voided(outline_of(8), "device_lost");
    feed.happened(moment::kEnded);
    CHECK(feed.dropped() == 0);
  }
  const std::vector<nlohmann::json> lines = parsed(pipe.rest());
  std::vector<std::string> events;
  std::set<std::string> keys;
  double time_s = 0;
  for (const nlohmann::json& line : lines) {
    events.push_back(line["event"]);
    CHECK(line["n"] == events.size());
    CHECK(line["time_s"].get<double>() >= time_s);
    time_s = line["time_s"];
    for (const auto& [key, value] : line.items()) keys.insert(key);
  }
  CHECK(events == std::vector<std::string>{"hello", "session.began", "trial.began", "interval.began", "interval.ended",
                                           "interval.began", "interval.ended", "question", "answered", "trial.voided",
                                           "trial.voided", "trial.voided", "session.ended", "bye"});
  CHECK(lines[2]["trial"] == 5);
  CHECK(lines[2]["attempt"] == 2);
  CHECK(lines[5]["interval"] == 2);
  CHECK(lines[8]["response_s"] == 1.25);
  // What would tell something of a stimulus is told as what does not.
  CHECK(lines[9]["reason"] == "rule");
  CHECK(lines[10]["reason"] == "device_fault");
  CHECK(lines[11]["reason"] == "device_lost");
  CHECK(lines.back()["dropped"] == 0);
  // Every word that there is; none for a stimulus, a condition, an answer.
  CHECK(keys == std::set<std::string>{"attempt", "clock", "dropped", "event", "interval", "n", "practice", "program",
                                      "reason", "response_s", "time_s", "trial", "version"});
}

TEST_CASE("A reader that does not read delays nothing; what it misses is counted", "[event_feed]") {
  FeedPipe pipe;
  constexpr int kTrials = 3000;  // of seven lines each: more than pipe and queue hold
  std::int64_t dropped = 0;
  {
    EventFeed feed(pipe.where());
    for (int i = 0; i < kTrials; ++i) one_trial(feed, i);
    CHECK(feed.dropped() > 0);
    feed.finish();
    dropped = feed.dropped();
    feed.happened(moment::kEnded);  // after the end: nothing
    CHECK(feed.dropped() == dropped);
  }
  const std::string text = pipe.rest();
  // Whole lines, and a last one that may be cut off.
  const auto whole = std::count(text.begin(), text.end(), '\n');
  CHECK(whole + dropped == 7 * kTrials + 2);
}

TEST_CASE("A reader that reads late gets what waited, and sees by the numbers what it missed", "[event_feed]") {
  FeedPipe pipe;
  std::string text;
  std::atomic<bool> seen{false};
  {
    EventFeed feed(pipe.where());
    for (int i = 0; i < 3000; ++i) one_trial(feed, i);
    std::thread reader([&] {
      std::array<char, 4096> bytes{};
      for (ssize_t count = 0; (count = read(pipe.reads.get(), bytes.data(), bytes.size())) > 0;) {
        seen = text.append(bytes.data(), static_cast<std::size_t>(count)).find("goes_on") != std::string::npos;
        seen.notify_one();
      }
    });
    // Until there is room again, and until all that waited has come.
    for (std::int64_t before = -1; before != feed.dropped();) {
      before = feed.dropped();
      feed.happened(moment::kGoesOn);
    }
    seen.wait(false);
    feed.finish();
    pipe.writes.close();
    reader.join();
  }
  const std::vector<nlohmann::json> lines = parsed(text);
  CHECK(lines.size() > 1);
  CHECK(lines.back()["event"] == "bye");
  CHECK(lines.back()["n"].get<std::int64_t>() > static_cast<std::int64_t>(lines.size()));
}

TEST_CASE("A reader that is gone ends nothing", "[event_feed]") {
  FeedPipe pipe;
  EventFeed feed(pipe.where());
  char first = 0;
  REQUIRE(read(pipe.reads.get(), &first, 1) == 1);  // the feed's own thread has nothing left to write
  pipe.reads.close();
  feed.happened("paused");
  CHECK(wait_until([&] { return feed.dropped() == 1; }));  // while that thread counts
  for (int i = 0; i < 10; ++i) one_trial(feed, i);
  feed.finish();
  CHECK(feed.dropped() == 72);
}

TEST_CASE("Events go to a socket, and a reader that closes it ends nothing", "[event_feed]") {
  const TemporaryFolder folder;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  (folder / "events.sock").string().copy(address.sun_path, sizeof address.sun_path - 1);
  const OwnedFile listening(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  REQUIRE(bind(listening.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  REQUIRE(listen(listening.get(), 1) == 0);
  EventFeed feed((folder / "events.sock").string());
  OwnedFile reader(accept(listening.get(), nullptr, nullptr));
  one_trial(feed, 1);
  std::string text;
  std::array<char, 4096> bytes{};
  while (text.find("answered") == std::string::npos) {
    const ssize_t count = read(reader.get(), bytes.data(), bytes.size());
    REQUIRE(count > 0);
    text.append(bytes.data(), static_cast<std::size_t>(count));
  }
  reader.close();
  for (int i = 0; i < 100; ++i) one_trial(feed, i);
  feed.finish();
  CHECK(feed.dropped() > 0);
}

TEST_CASE("A place where nobody can read is refused, with what to do", "[event_feed]") {
  const TemporaryFolder folder;
  CHECK(contains(said_of("987"), "no file descriptor of that number is open"));
  CHECK(contains(said_of("1"), "is for the console"));
  const OwnedFile reads(open("/dev/null", O_RDONLY | O_CLOEXEC));
  CHECK(contains(said_of(std::to_string(reads.get())), "cannot be written to"));
  CHECK(contains(said_of((folder / "none.sock").string()), "start the program that listens there first"));
  CHECK(contains(said_of(std::string(300, 'x')), "give a path of 1 to 107 bytes"));
}

}  // namespace jnd
