// The same session of two plans that look the same (tests/twin_plan.h): the same answers at the same times give the same
// screens, lines and events, byte by byte. What runner/README.md names as unavoidable is held alone: with its own cause
// taken away from the stimuli nothing else differs.
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "protocols/tasks/task.h"
#include "runner/console/console_lines.h"
#include "runner/console/session_console.h"
#include "runner/events/event_feed.h"
#include "runner/screen/screen_display.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"
#include "tests/runner/rigged_fixture.h"
#include "tests/runner/screen/kept_frames.h"
#include "tests/twin_plan.h"

namespace jnd {
namespace {

using Json = nlohmann::json;

// A file in memory.
class Kept {
 public:
  Kept() = default;
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;
  int number() const noexcept { return file_; }
  std::string text() const {
    std::string text(static_cast<std::size_t>(lseek(file_, 0, SEEK_END)), '\0');
    REQUIRE(pread(file_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()));
    return text;
  }
  ~Kept() { close(file_); }

 private:
  int file_ = memfd_create("kept", 0);
};

// Standard output goes there while this lives.
class OutputTo {
 public:
  explicit OutputTo(const Kept& kept) {
    std::fflush(stdout);
    dup2(kept.number(), STDOUT_FILENO);
  }
  ~OutputTo() {
    std::fflush(stdout);
    dup2(before_, STDOUT_FILENO);
    close(before_);
  }
  OutputTo(const OutputTo&) = delete;
  OutputTo& operator=(const OutputTo&) = delete;

 private:
  int before_ = dup(STDOUT_FILENO);
};

// All frames, one after the other; one that is painted again counts once.
class AllFrames final : public Painter {
 public:
  explicit AllFrames(std::string& text) : text_(text) {}
  bool unicode() const noexcept override { return true; }
  int rows() const noexcept override { return 30; }
  int columns() const noexcept override { return 100; }
  bool changed() override { return false; }
  void paint(const Frame& frame) override {
    const std::vector<std::string> before = lines_;
    latest_.paint(frame);
    if (lines_ == before) return;
    for (const std::string& line : lines_) text_ += line + "\n";
  }
  void beep() override { text_ += "beep\n"; }

 private:
  std::string& text_;
  std::vector<std::string> lines_;
  test::KeptFrames latest_{lines_};
};

using Prepare = std::function<void(test::Bench&)>;

// Everything that a session shows and tells. The feed's times are the machine's own.
std::string shown_by(const Protocol& protocol, std::uint64_t seed, bool by_lines, const Prepare& prepare) {
  test::Bench bench(protocol);
  bench.plan = make_plan(protocol, 1, seed);
  bench.person = true;
  const int classes = static_cast<int>(protocol.task.classes.size());
  bench.responder.by_number = classes == 0;
  bench.responder.rule = [&, silent = true](const TrialQuestion& question) mutable -> std::optional<int> {
    if (question.trial.index == 3 && std::exchange(silent, false)) return std::nullopt;
    if (task_of(protocol.task.kind).adjusts()) return question.look < 2 ? 1 : 2;  // more, more, accept
    return classes == 0 ? 1 + question.trial.index : question.trial.index % classes;
  };
  prepare(bench);
  const Kept lines, events;
  std::string frames;
  SessionEnd end = SessionEnd::interrupted;
  {
    EventFeed feed(std::to_string(events.number()));
    const OutputTo here(lines);
    std::unique_ptr<Display> display = std::make_unique<LineDisplay>(false);
    if (!by_lines)
      display = make_screen_display([&frames] { return std::make_unique<AllFrames>(frames); },
                                    std::make_unique<test::SharedClock>(bench.clock));
    ConsoleOptions options;
    options.listeners = {&feed};
    SessionConsole console(options, protocol, nullptr, bench.clock, bench.interrupts, std::move(display));
    SessionCard card;
    card.title = protocol.title;
    card.participant = "P01";
    card.trials_total = main_trial_count(bench.plan);
    console.begin(card);
    end = bench.run(console);
    console.end("The end.");
  }
  REQUIRE(end == SessionEnd::completed);
  std::string told = events.text();
  for (std::size_t at = 0; (at = told.find("\"time_s\":", at)) != std::string::npos;)
    told.erase(at, told.find(',', at) - at);
  return frames + lines.text() + told;
}

struct Twins {
  std::string first, second;
};

// by_lines: with --plain.
Twins shown_by_twins(
    const Protocol& protocol, bool by_lines, const Prepare& prepare = [](test::Bench&) {}, std::uint64_t seed = 1) {
  return {shown_by(protocol, seed, by_lines, prepare),
          shown_by(protocol, test::twin_of(protocol, seed, 1), by_lines, prepare)};
}

// A rig whose limits are met, whose device gets lost and whose program talks, all as the stimulus is.
void delivers_as_asked(test::Bench& bench) {
  bench.rig.looks = true;
  bench.rig.saturated_share = [](const PresentRequest& request) {
    return request.stimulus.stiffness > 800 && request.stimulus.cues.force ? 0.2 : 0;
  };
  bench.rig.fault = [&bench](const PresentRequest& request) {
    bench.rig.said = fmt::format(", and said last: presenting {} N/m", request.stimulus.stiffness);
    if (request.id.trial == 7 && request.id.attempt == 1) return Fault::no_contact;
    if (request.id.trial != 5 || request.id.attempt != 1) return Fault::none;
    bench.rig.gone_until_ns = bench.clock.now_ns() + 1'000'000'000;
    return Fault::device_lost;
  };
}

// same_different with all that a session may ask and tell.
Protocol rich_protocol(const Json& changes = {}) {
  Json json = {{"design", {{"order", {{"conditions", "permuted"}}}}},
               {"practice",
                {{"trials", 2},
                 {"series", "2"},
                 {"conditions", {"S", "V"}},
                 {"criterion_correct", 0},
                 {"max_rounds", 1},
                 {"feedback", "none"}}},
               {"breaks", {{{"after", "block"}, {"duration_s", 20}}}},
               {"questions",
                {{{"id", "ease"},
                  {"when", "after-condition"},
                  {"kind", "rating"},
                  {"text", "How easy was it?"},
                  {"min", 1},
                  {"max", 9},
                  {"low", "hard"},
                  {"high", "easy"}}}}};
  if (!changes.is_null()) json.merge_patch(changes);
  return test::small_protocol(json);
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

TEST_CASE("Two plans that look the same show the same to the last byte, in every task", "[long]") {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const Twins twins = shown_by_twins(rich_protocol(), seed > 2, delivers_as_asked, seed);
    CHECK(twins.first == twins.second);
    for (const char* part : {"rial 16 of 16", "Something is missing", "RRS3-0001 is not there", "not counted",
                             "\"event\":\"trial.voided\""})
      CHECK(twins.first.find(part) != std::string::npos);
  }
  for (const TaskKind task : {TaskKind::which, TaskKind::yes_no, TaskKind::identify, TaskKind::oddity, TaskKind::abx,
                              TaskKind::magnitude, TaskKind::adjust}) {
    CAPTURE(to_string(task));
    const Twins twins = shown_by_twins(testing::few_trials(task, 12), false, delivers_as_asked);
    CHECK(twins.first == twins.second);
  }
}

TEST_CASE("What is named as unavoidable shows nothing beside itself") {
  SECTION("feedback") {
    const Twins twins = shown_by_twins(rich_protocol({{"feedback", "correctness"}}), true, delivers_as_asked);
    CHECK(twins.first != twins.second);
    CHECK(replaced(twins.first, "that was not right", "that was right") ==
          replaced(twins.second, "that was not right", "that was right"));
  }
  SECTION("repeats by on_saturation") {
    const Protocol protocol = rich_protocol({{"stimulus", {{"on_saturation", "repeat"}}}});
    const Twins told = shown_by_twins(protocol, false, delivers_as_asked);
    CHECK(told.first != told.second);
    const Twins twins = shown_by_twins(protocol, false, [](test::Bench& bench) {
      bench.rig.saturated_share = [](const PresentRequest& request) {
        return request.id.trial % 3 == 0 && request.id.attempt == 1 ? 0.2 : 0;
      };
    });
    CHECK(twins.first.find("not counted") != std::string::npos);
    CHECK(twins.first == twins.second);
  }
  SECTION("repeats by on_breach") {
    const Protocol protocol = rich_protocol(
        {{"trial",
          {{"prescription",
            {{"say", "Once."}, {"limits", {{{"measure", "contacts"}, {"high", 1}}}}, {"on_breach", "repeat"}}}}}});
    const auto by = [&](bool by_stimulus) {
      return shown_by_twins(protocol, false, [by_stimulus](test::Bench& bench) {
        bench.rig.contacts = [by_stimulus](const PresentRequest& request) {
          const bool breaks = by_stimulus ? request.stimulus.stiffness > 800 : request.id.trial % 3 == 0;
          return breaks && request.id.attempt == 1 ? 2 : 1;
        };
      });
    };
    const Twins told = by(true), twins = by(false);
    CHECK(told.first != told.second);
    CHECK(twins.first.find("not counted") != std::string::npos);
    CHECK(twins.first == twins.second);
  }
  SECTION("words of a condition") {
    const auto says = [](const char* words) { return Json{{"say", words}}; };
    const Twins twins = shown_by_twins(
        rich_protocol(
            {{"conditions",
              {{{"name", "S"}, {"label", "s"}, {"cues", {"force"}}, {"prescription", says("Press hard.")}},
               {{"name", "V"}, {"label", "v"}, {"cues", {"force"}}, {"prescription", says("Press soft.")}}}}}),
        true);
    CHECK(twins.first != twins.second);
    CHECK(replaced(twins.first, "Press hard.", "Press soft.") == replaced(twins.second, "Press hard.", "Press soft."));
  }
  SECTION("groups") {
    const Protocol protocol = rich_protocol({{"practice", nullptr},
                                             {"groups",
                                              {{{"name", "one"}, {"label", "one"}, {"conditions", {"S"}}},
                                               {{"name", "two"}, {"label", "two"}, {"conditions", {"V"}}}}}});
    std::uint64_t other = 2;
    while (test::letters_of(protocol, other, 1).front() == test::letters_of(protocol, 1, 1).front()) ++other;
    for (const bool by_lines : {false, true}) {
      const Twins twins = {shown_by(protocol, 1, by_lines, delivers_as_asked),
                           shown_by(protocol, other, by_lines, delivers_as_asked)};
      CHECK(twins.first != twins.second);
      const auto without_letter = [](const std::string& text) {
        return replaced(replaced(text, "condition A", "condition B"), "% A", "% B");
      };
      CHECK(without_letter(twins.first) == without_letter(twins.second));
    }
  }
  SECTION("the length of a track") {
    const auto ends_after = [](const Json& stop) {
      return shown_by_twins(
          testing::of_task(TaskKind::which, "staircase",
                           {{"design", {{"procedure", {{"averaged_reversals", 2}, {"stop", stop}}}}}}),
          false);
    };
    const Twins told = ends_after({{"trials", nullptr}, {"reversals", 3}, {"at_most", 20}}),
                twins = ends_after({{"trials", 8}});
    CHECK(told.first != told.second);
    CHECK(twins.first == twins.second);
  }
}

}  // namespace
}  // namespace jnd
