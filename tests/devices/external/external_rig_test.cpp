// A rig that is a program: the shipped example, and one that goes wrong in every way. JND_CAMPAIGN sets how often.
#include "devices/external/external_rig.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/campaign.h"
#include "tests/catch.h"
#include "tests/temporary_folder.h"

using namespace jnd;

namespace {

const SteadyClock kSteady;
const std::filesystem::path kExamples = std::filesystem::path(JND_SOURCE_DIR) / "devices/external/examples";
const std::filesystem::path kHostile = std::filesystem::path(JND_SOURCE_DIR) / "tests/devices/external/hostile_rig.py";
constexpr double kLong_s = 600;  // nothing takes so long unless it hangs

ExternalSettings settings_for(std::vector<std::string> command) {
  ExternalSettings settings;
  settings.command = std::move(command);
  settings.time_outs.hello_s = settings.time_outs.prepare_s = kLong_s;
  return settings;
}

RenderRequest example_request() {
  RenderRequest request;
  request.quantity = "stiffness";
  request.unit = "N/m";
  request.value = 500;
  request.parameters = {{"finger", std::string("thumb")}};
  request.exploration.duration_s = 0.1;
  return request;
}

// Once more if it did not end as it should: on a busy machine 100 ms of silence happen, and the rig's own watchdog bites.
template <typename Good>
Rendered eventually(ExternalRig& rig, const RenderRequest& request, const Good& good,
                    const std::function<void(const RigEvent&)>& hear = {}) {
  const std::int64_t until_ns = kSteady.now_ns() + static_cast<std::int64_t>(1e9 * kLong_s);
  Rendered rendered;
  do {
    (void)rig.await_hello(kLong_s);
    rendered = rig.render(request, hear);
  } while (!good(rendered) && kSteady.now_ns() < until_ns);
  return rendered;
}
bool is_done(const Rendered& rendered) {
  return rendered.done.has_value();
}

std::string contents_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();  // where the file is that of a process that goes meanwhile: nothing
  return text.str();
}

// The processes that have this in their environment, zombies left out.
int processes_with(const std::string& token) {
  int found = 0;
  std::error_code error;
  for (std::filesystem::directory_iterator entry("/proc", error), end; !error && entry != end; entry.increment(error))
    if (contents_of(entry->path() / "environ").find(token) != std::string::npos) ++found;
  return found;
}

const std::vector<std::string> kFaults = {"none",
                                          "silent_from_the_start",
                                          "late_hello",
                                          "bad_hello",
                                          "late_alive",
                                          "babbles",
                                          "short_babble",
                                          "endless_babble",
                                          "telemetry_flood",
                                          "endless_line",
                                          "long_line",
                                          "not_utf8",
                                          "nan",
                                          "huge",
                                          "nul",
                                          "deep",
                                          "escape",
                                          "other_id",
                                          "earlier_id",
                                          "ready_of_another",
                                          "done_early",
                                          "unknown_channel",
                                          "second_hello",
                                          "alive_lies",
                                          "unasked_answer",
                                          "global_fault",
                                          "closes_output",
                                          "closes_input",
                                          "hangs",
                                          "deaf_until_stop",
                                          "ignores_term",
                                          "leaves_children",
                                          "stops_itself",
                                          "no_done_ever",
                                          "dies_before_hello",
                                          "dies_within_hello",
                                          "dies_after_hello",
                                          "dies_before_alive",
                                          "dies_within_alive",
                                          "dies_after_alive",
                                          "dies_before_ready",
                                          "dies_within_ready",
                                          "dies_after_ready",
                                          "dies_before_done",
                                          "dies_within_done",
                                          "dies_after_done",
                                          "silent_after_hello",
                                          "silent_after_alive",
                                          "silent_after_ready",
                                          "silent_after_done"};

// One rig with one fault. Returns what is wrong with this program; empty: nothing.
std::string endure(const std::string& fault, int seed) {
  const TemporaryFolder folder;
  const std::string token = fmt::format("JND_RIG_TOKEN={}-{}-{}", getpid(), fault, seed);
  std::string wrong;
  {
    ExternalSettings settings =
        settings_for({"env", token, "python3", kHostile.string(), fault, std::to_string(seed), folder.path().string()});
    settings.time_outs.prepare_s = 0.5;
    if (fault == "silent_from_the_start" || fault == "bad_hello") settings.time_outs.hello_s = 3;
    EmergencyStop stop;
    ExternalRig rig(settings, kSteady, stop);
    RenderRequest request = example_request();
    request.parameters.clear();
    request.time_out_s = 0.5;
    int counted = 0;
    const std::int64_t until_ns = kSteady.now_ns() + static_cast<std::int64_t>(1e9 * kLong_s);
    // Until the rig, started anew where it had to be, presents as it should: twice, for faults that come with the second.
    while (counted < 3 && kSteady.now_ns() < until_ns) {
      (void)rig.await_hello(kLong_s);
      const Rendered rendered = rig.render(request);
      if (rendered.done.has_value() == rendered.voided.has_value()) wrong += "neither or both of done and void; ";
      if (!rendered.done) continue;
      ++counted;
      const std::string said = "\n" + contents_of(folder / "done");
      if (said.find(fmt::format("\n{}\n", rendered.done->id)) == std::string::npos)
        wrong += fmt::format("{} was counted, and never done; ", rendered.done->id);
    }
    if (counted < 3) wrong += fmt::format("presents no more: {}; ", rig.missing());
    const ExternalReport report = rig.report();
    if (report.traffic.presented != counted) wrong += "its count is another; ";
    for (const RigLineRefused& refused : report.refused)
      for (const char letter : refused.line + refused.why)
        if (letter < ' ' || letter > '~') wrong += "a refused line is not printable; ";
  }
  if (const int left = processes_with(token); left > 0) wrong += fmt::format("{} processes are left; ", left);
  return wrong;
}

}  // namespace

TEST_CASE("the shipped rig presents what it is asked for") {
  EmergencyStop stop;
  ExternalRig rig(settings_for({"python3", (kExamples / "plain_rig.py").string()}), kSteady, stop);
  REQUIRE(rig.await_hello(kLong_s));
  CHECK(rig.hello()->name == "Plain rig");
  int heard = 0;
  const Rendered rendered = eventually(rig, example_request(), is_done, [&](const RigEvent&) { ++heard; });
  REQUIRE(rendered.done);
  CHECK(rendered.done->delivered == Approx(500));
  CHECK(rendered.contacts.size() == 1);
  CHECK(heard >= 3);  // ready, contact, done
  const Presentation presentation = presentation_of(rendered, StopSource::none);
  CHECK(presentation.fault == Fault::none);
  CHECK(presentation.duration_s >= 0.1);
  RenderRequest wrong = example_request();
  wrong.value = 1e6;
  const Rendered refused =
      eventually(rig, wrong, [](const Rendered& it) { return it.voided && it.voided->words.starts_with("1000000"); });
  REQUIRE(refused.voided);
  CHECK(refused.voided->words == "1000000 N/m is out of the rig's range, stiffness 100 to 1000 N/m");
}

TEST_CASE("the stop latch stops an external rig, and nothing is presented until it is cleared") {
  EmergencyStop stop;
  ExternalRig rig(settings_for({"python3", (kExamples / "plain_rig.py").string()}), kSteady, stop);
  REQUIRE(rig.await_hello(kLong_s));
  RenderRequest request = example_request();
  request.exploration.ends = RigExplorationEnd::stop;
  const Rendered stopped = eventually(
      rig, request,
      [&](const Rendered& it) {
        const bool good = it.voided && it.voided->failure == RigFailure::stopped && !it.contacts.empty();
        if (!good) stop.clear();
        return good;
      },
      [&](const RigEvent& event) {
        if (std::holds_alternative<RigContact>(event.what)) stop.latch(StopSource::key);
      });
  REQUIRE(stopped.voided);
  CHECK(stopped.voided->failure == RigFailure::stopped);
  CHECK(presentation_of(stopped, StopSource::key).fault == Fault::emergency_stop);
  const Rendered latched = rig.render(request);
  REQUIRE(latched.voided);
  CHECK_FALSE(latched.done);
  stop.clear();
  CHECK(eventually(rig, example_request(), is_done).done);
}

TEST_CASE("a rig that cannot be started is told, and how often it was tried") {
  EmergencyStop stop;
  ExternalRig rig(settings_for({"/no/such/rig"}), kSteady, stop);
  CHECK_FALSE(rig.await_hello(kLong_s));
  CHECK(rig.missing().find("/no/such/rig cannot be started: No such file or directory") == 0);
  while (rig.report().starts < 3 || rig.missing().find("it could not be started") == std::string::npos)
    (void)rig.wait(kSteady.now_ns() + 20'000'000);
  CHECK(rig.render(example_request()).voided->failure == RigFailure::ended);
}

TEST_CASE("what a rig says itself is in what is missing, but not while that is sealed") {
  EmergencyStop stop;
  ExternalRig rig(settings_for({"sh", "-c", "echo 'presenting 5''75 N/m' >&2; exit 3"}), kSteady, stop);
  // It is started again and again meanwhile.
  const auto await = [&rig](const auto& words, const char* part) {
    while (words().find(part) == std::string::npos) (void)rig.wait(kSteady.now_ns() + 20'000'000);
  };
  await([&] { return rig.missing(); }, "it said last: presenting 575 N/m");
  await([&] { return rig.report().trouble; }, "said last: presenting 575 N/m");  // for the log
  await(
      [&] {
        const std::string sealed = rig.missing_sealed();
        CHECK(sealed.find("575") == std::string::npos);
        return sealed;
      },
      "(exit code 3)");
}

TEST_CASE("a rig behind a Unix socket is connected to, and again after it went away") {
  const TemporaryFolder folder;
  const std::string path = (folder / "rig.sock").string();
  const int listening = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), address.sun_path);
  REQUIRE(bind(listening, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  REQUIRE(listen(listening, 4) == 0);
  ExternalSettings settings = settings_for({});
  settings.socket = path;
  EmergencyStop stop;
  ExternalRig rig(settings, kSteady, stop);
  // The example, with the connection for its standard streams.
  const auto serve = [&] {
    const int connection = accept(listening, nullptr, nullptr);
    const pid_t pid = fork();
    if (pid == 0) {
      dup2(connection, STDIN_FILENO);
      dup2(connection, STDOUT_FILENO);
      execlp("python3", "python3", (kExamples / "plain_rig.py").c_str(), nullptr);
      _exit(127);
    }
    close(connection);
    return pid;
  };
  const pid_t first = serve();
  REQUIRE(rig.await_hello(kLong_s));
  kill(first, SIGKILL);
  waitpid(first, nullptr, 0);
  const pid_t second = serve();
  CHECK(eventually(rig, example_request(), is_done).done);
  CHECK(rig.report().starts >= 2);
  kill(second, SIGKILL);
  waitpid(second, nullptr, 0);
  close(listening);
}

TEST_CASE("a rig behind another user's socket is nobody's rig") {
  const TemporaryFolder folder;
  REQUIRE(chmod(folder.path().c_str(), 0777) == 0);
  if (geteuid() != 0 || seteuid(65534) != 0) {
    WARN("only root can try this");
    return;
  }
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = (folder / "rig.sock").string();
  std::copy(path.begin(), path.end(), address.sun_path);
  const int listening = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool listens =
      bind(listening, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 && listen(listening, 4) == 0;
  REQUIRE(seteuid(0) == 0);
  REQUIRE(listens);
  ExternalSettings settings = settings_for({});
  settings.socket = path;
  EmergencyStop stop;
  ExternalRig rig(settings, kSteady, stop);
  CHECK_FALSE(rig.await_hello(kLong_s));
  CHECK(rig.missing().find("is served by another user") != std::string::npos);
  close(listening);
}

TEST_CASE("what is prepared is presented when its turn comes, or is void") {
  EmergencyStop stop;
  ExternalRig rig(settings_for({"python3", (kExamples / "plain_rig.py").string()}), kSteady, stop);
  REQUIRE(rig.await_hello(kLong_s));
  std::string why;
  const auto ready = [&] {
    const std::uint64_t id = rig.prepare(example_request(), why);
    REQUIRE(id != 0);
    return id;
  };
  Rendered rendered;
  const std::int64_t until_ns = kSteady.now_ns() + static_cast<std::int64_t>(1e9 * kLong_s);
  do {  // on a busy machine it may be silent for 100 ms
    (void)rig.await_hello(kLong_s);
    (void)rig.wait(0);
    const std::uint64_t id = ready();
    bool is_ready = false;
    while (!is_ready && rig.prepares(id))
      for (const RigEvent& event : rig.wait(kSteady.now_ns() + 20'000'000))
        is_ready = is_ready || std::holds_alternative<RigReady>(event.what);
    rendered = rig.render_prepared(id);
  } while (!rendered.done && kSteady.now_ns() < until_ns);
  CHECK(rendered.done);
  const std::uint64_t id = ready();
  rig.let_go();
  CHECK_FALSE(rig.prepares(id));
  CHECK(rig.render_prepared(id).voided);
}

TEST_CASE("no fault of an external rig counts as a presentation, and none leaves a process") {
  const int kinds = static_cast<int>(kFaults.size()), cases = std::max(kinds, test::campaign(kinds));
  constexpr int kAtOnce = 8;  // they mostly wait
  std::atomic<int> next{0};
  std::mutex mutex;
  std::vector<std::string> wrong;
  std::vector<std::thread> workers;
  for (int worker = 0; worker < kAtOnce; ++worker)
    workers.emplace_back([&] {
      for (int number = next++; number < cases; number = next++) {
        const std::string& fault = kFaults[static_cast<std::size_t>(number) % kFaults.size()];
        const std::string found = endure(fault, number);
        if (found.empty()) continue;
        const std::lock_guard lock(mutex);
        wrong.push_back(fmt::format("{} (seed {}): {}", fault, number, found));
      }
    });
  for (std::thread& worker : workers) worker.join();
  for (const std::string& one : wrong) UNSCOPED_INFO(one);
  CHECK(wrong.empty());
}
