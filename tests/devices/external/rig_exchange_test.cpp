// The conversation with an external rig: what counts as a presentation, and what ends it.
#include "devices/external/rig_exchange.h"

#include <fmt/format.h>

#include "tests/catch.h"

using namespace jnd;

namespace {

constexpr std::int64_t kMs_ns = 1'000'000;
const std::string kGreeting =
    R"({"type":"hello","protocol":1,"name":"Rig","version":"1","serial":"S1","model":true,"answers":true,)"
    R"("quantities":[{"name":"stiffness","unit":"N/m","min":100,"max":1000}],)"
    R"("parameters":[{"name":"gain","unit":"","min":0,"max":2}],"measures":[{"name":"force","unit":"N"}]})";

// A rig by hand, on a clock by hand.
struct Talk {
  Talk() {
    exchange.begin(now_ns);
    (void)exchange.take_output();
  }
  void say(const std::string& line) { exchange.hear(line, now_ns); }
  void greet() {
    say(kGreeting);
    REQUIRE(exchange.idle());
  }
  // Time passes; the rig answers every "alive", or none.
  void pass(std::int64_t ms, bool answers = true) {
    for (std::int64_t i = 0; i < ms; i += 5) {
      now_ns += 5 * kMs_ns;
      exchange.tick(now_ns);
      written += exchange.take_output();
      if (answers) answer_alive();
    }
  }
  void be_silent(std::int64_t ms) { pass(ms, false); }
  bool was_said(const std::string& type) {
    written += exchange.take_output();
    return written.find("\"type\":\"" + type + "\"") != std::string::npos;
  }
  void answer_alive() {
    for (std::size_t at = 0; (at = written.find("\"alive\",\"n\":", heard_to)) != std::string::npos;) {
      const std::size_t number = at + 12;
      say(fmt::format("{{\"type\":\"alive\",\"n\":{}}}", std::stoull(written.substr(number))));
      heard_to = number;
    }
  }
  static RenderRequest request() {
    RenderRequest request;
    request.quantity = "stiffness";
    request.unit = "N/m";
    request.value = 500;
    request.parameters = {{"gain", 1.0}};
    request.exploration.duration_s = 1;
    request.time_out_s = 3;
    return request;
  }
  std::uint64_t begin_presentation() {
    std::string why;
    const std::uint64_t id = exchange.prepare(request(), now_ns, why);
    REQUIRE(why == "");
    say(fmt::format(R"({{"type":"ready","id":{}}})", id));
    REQUIRE(exchange.present(id, now_ns));
    touch(id);
    return id;
  }
  void touch(std::uint64_t id) { say(fmt::format(R"({{"type":"contact","id":{},"time_s":0}})", id)); }
  void done(std::uint64_t id, const std::string& outcome = "complete", double duration_s = 1) {
    say(fmt::format(R"({{"type":"done","id":{},"outcome":"{}","duration_s":{},"contacts":1,"first_contact_s":0}})", id,
                    outcome, duration_s));
  }
  // The newest void, refusal or done among the events so far.
  template <typename What>
  std::vector<What> all() {
    for (RigEvent& event : exchange.take_events()) events.push_back(std::move(event));
    std::vector<What> found;
    for (const RigEvent& event : events)
      if (const auto* what = std::get_if<What>(&event.what)) found.push_back(*what);
    return found;
  }

  RigExchange exchange{"0.1.0", {}};
  std::int64_t now_ns = 1000 * kMs_ns;
  std::string written;
  std::size_t heard_to = 0;
  std::vector<RigEvent> events;
};

}  // namespace

TEST_CASE("a presentation counts once the rig says done with its id") {
  Talk talk;
  talk.greet();
  const std::uint64_t id = talk.begin_presentation();
  talk.pass(1000);
  talk.done(id);
  CHECK(talk.all<RigDone>().size() == 1);
  CHECK(talk.all<RigVoid>().empty());
  CHECK(talk.exchange.traffic().presented == 1);
  talk.done(id);  // once more
  CHECK(talk.exchange.traffic().presented == 1);
  CHECK(talk.all<RigLineRefused>().size() == 1);
}

TEST_CASE("lies about ids are refused and never counted") {
  Talk talk;
  talk.greet();
  const std::uint64_t first = talk.begin_presentation();
  talk.pass(1000);
  talk.done(first + 1);
  talk.say(fmt::format(R"({{"type":"ready","id":{}}})", first));
  CHECK(talk.all<RigLineRefused>().size() == 2);
  CHECK(talk.exchange.traffic().presented == 0);
  talk.exchange.stop(RigStop::interrupted, talk.now_ns);
  talk.done(first, "stopped");
  const std::uint64_t second = talk.begin_presentation();
  CHECK(second > first);
  talk.pass(1000);
  talk.done(first);  // late
  CHECK(talk.exchange.traffic().presented == 0);
  talk.done(second);
  CHECK(talk.exchange.traffic().presented == 1);
}

TEST_CASE("done before its time is refused") {
  Talk talk;
  talk.greet();
  const std::uint64_t id = talk.begin_presentation();
  talk.pass(100);
  talk.done(id, "complete", 1);
  CHECK(talk.exchange.traffic().presented == 0);
  REQUIRE(talk.all<RigVoid>().size() == 1);
  CHECK(talk.all<RigVoid>().front().failure == RigFailure::refused_done);
  CHECK(talk.exchange.idle());
}

TEST_CASE("what was asked for has happened, or it is not complete") {
  Talk talk;
  talk.greet();
  const auto presented = [&](const RigExploration& how, const std::string& done, bool touched, bool enough = false) {
    RenderRequest request = Talk::request();
    request.exploration = how;
    std::string why;
    const std::uint64_t id = talk.exchange.prepare(request, talk.now_ns, why);
    talk.say(fmt::format(R"({{"type":"ready","id":{}}})", id));
    REQUIRE(talk.exchange.present(id, talk.now_ns));
    talk.pass(200);
    if (touched) talk.touch(id);
    talk.pass(1200);
    if (enough) talk.exchange.stop(RigStop::enough, talk.now_ns);
    const std::int64_t before = talk.exchange.traffic().presented;
    talk.say(fmt::format(R"({{"type":"done","id":{},"outcome":"complete",{}}})", id, done));
    CHECK(talk.exchange.idle());
    return talk.exchange.traffic().presented > before;
  };
  const std::string whole = R"("duration_s":1.2,"contacts":1,"first_contact_s":0.2)";
  const RigExploration second{.duration_s = 1}, from_start{.duration_s = 1, .from_contact = false};
  CHECK(presented(second, whole, true));
  CHECK_FALSE(presented(second, whole, false));  // contacts that were never told
  CHECK_FALSE(presented(second, R"("duration_s":0,"contacts":0)", false));
  CHECK_FALSE(presented(second, R"("duration_s":1.2,"contacts":0)", true));
  CHECK_FALSE(presented(second, R"("duration_s":0,"contacts":1,"first_contact_s":0)", true));
  CHECK_FALSE(presented(second, R"("duration_s":1.2,"contacts":1,"first_contact_s":0.7)", true));
  CHECK(presented(from_start, R"("duration_s":1,"contacts":0)", false));
  CHECK_FALSE(presented(from_start, R"("duration_s":0.5,"contacts":0)", false));
  const RigExploration presses{.ends = RigExplorationEnd::contacts, .contacts = 2},
      key{.ends = RigExplorationEnd::stop};
  CHECK_FALSE(presented(presses, whole, true));
  CHECK(presented(presses, R"("duration_s":1.2,"contacts":2,"first_contact_s":0.2)", true));
  CHECK_FALSE(presented(key, whole, true));
  CHECK(presented(key, whole, true, true));
  CHECK_FALSE(presented(key, R"("duration_s":1.2,"contacts":0)", false, true));
}

TEST_CASE("a rig that is not ready when its turn comes voids the presentation, and goes on") {
  Talk talk;
  talk.greet();
  std::string why;
  const std::uint64_t id = talk.exchange.prepare(Talk::request(), talk.now_ns, why);
  CHECK(talk.exchange.prepares(id));
  talk.pass(200);
  talk.exchange.give_up(id, talk.now_ns);
  CHECK_FALSE(talk.exchange.prepares(id));
  REQUIRE(talk.all<RigVoid>().size() == 1);
  CHECK(talk.all<RigVoid>().front().failure == RigFailure::not_ready);
  CHECK(talk.all<RigVoid>().front().words ==
        "not ready when its turn came: by its hello it needs at most 0.1 s (\"ready_s\")");
  CHECK(talk.was_said("stop"));
  talk.done(id, "stopped", 0);
  CHECK(talk.exchange.idle());
  const std::uint64_t next = talk.begin_presentation();
  talk.exchange.give_up(next, talk.now_ns);  // it presents: nothing is late
  talk.pass(1000);
  talk.done(next);
  CHECK(talk.exchange.traffic().presented == 1);
}

TEST_CASE("a rig that is ready stays ready") {
  Talk talk;
  talk.greet();
  std::string why;
  const std::uint64_t id = talk.exchange.prepare(Talk::request(), talk.now_ns, why);
  talk.say(fmt::format(R"({{"type":"ready","id":{}}})", id));
  talk.pass(300'000);
  CHECK(talk.exchange.is_ready(id));
  REQUIRE(talk.exchange.present(id, talk.now_ns));
}

TEST_CASE("a rig that presents and is silent for 100 ms is stopped, and the presentation is void") {
  Talk talk;
  talk.greet();
  const std::uint64_t id = talk.begin_presentation();
  talk.pass(500);
  talk.be_silent(105);  // the first "alive" of these comes after 5 ms
  CHECK(talk.all<RigVoid>().empty());
  CHECK_FALSE(talk.was_said("stop"));
  talk.be_silent(5);
  REQUIRE(talk.all<RigVoid>().size() == 1);
  CHECK(talk.all<RigVoid>().front().id == id);
  CHECK(talk.all<RigVoid>().front().failure == RigFailure::silent);
  CHECK(talk.all<RigVoid>().front().words == "silent: it did not answer an \"alive\" of 105 ms ago");
  CHECK(talk.was_said("stop"));
  CHECK_FALSE(talk.exchange.lost());
  SECTION("it says done within 200 ms: it goes on, and nothing counts") {
    talk.be_silent(195);
    talk.done(id);
    CHECK(talk.exchange.idle());
    CHECK(talk.exchange.traffic().presented == 0);
    talk.pass(5);
    const std::uint64_t next = talk.begin_presentation();
    talk.pass(1000);
    talk.done(next);
    CHECK(talk.exchange.traffic().presented == 1);
    CHECK(talk.all<RigVoid>().size() == 1);
  }
  SECTION("it does not: it is lost") {
    talk.be_silent(205);
    REQUIRE(talk.exchange.lost());
    CHECK(talk.exchange.lost()->failure == RigFailure::not_stopped);
    // Nothing that it says now counts.
    talk.done(id);
    CHECK(talk.exchange.traffic().presented == 0);
    // Started anew it is as before, and what the one before says late is not taken for an answer.
    talk.exchange.begin(talk.now_ns);
    talk.greet();
    CHECK(talk.begin_presentation() > id);
  }
}

TEST_CASE("a rig that presents nothing is started anew after 2 s of silence, and not before") {
  Talk talk;
  talk.greet();
  talk.pass(500);
  std::string why;
  const std::string state = GENERATE("idle", "asked", "preparing", "ready", "after done");
  if (state == "asked") REQUIRE(talk.exchange.ask({"first", "second"}, talk.now_ns) != 0);
  if (state == "after done") {
    const std::uint64_t id = talk.begin_presentation();
    talk.pass(1000);
    talk.be_silent(95);
    talk.done(id);
  }
  if (state == "preparing" || state == "ready") {
    const std::uint64_t id = talk.exchange.prepare(Talk::request(), talk.now_ns, why);
    if (state == "ready") talk.say(fmt::format(R"({{"type":"ready","id":{}}})", id));
  }
  INFO(state);
  talk.be_silent(state == "after done" ? 1910 : 2005);
  CHECK_FALSE(talk.exchange.lost());
  SECTION("an answer in time") {
    talk.answer_alive();
    talk.pass(3000);
    CHECK_FALSE(talk.exchange.lost());
    CHECK(talk.all<RigVoid>().empty());
  }
  SECTION("none") {
    talk.be_silent(5);
    REQUIRE(talk.exchange.lost());
    CHECK(talk.exchange.lost()->failure == RigFailure::silent);
    CHECK(talk.exchange.lost()->words == "silent: it did not answer an \"alive\" of 2005 ms ago");
    CHECK(talk.all<RigVoid>().size() == (state == "idle" || state == "after done" ? 0 : 1));
  }
}

TEST_CASE("a rig that is silent is told to present once it answers, and its 100 ms begin then") {
  Talk talk;
  talk.greet();
  talk.pass(500);
  std::string why;
  const std::uint64_t id = talk.exchange.prepare(Talk::request(), talk.now_ns, why);
  talk.say(fmt::format(R"({{"type":"ready","id":{}}})", id));
  SECTION("silent for a second: it waits") {
    talk.be_silent(1000);
    REQUIRE(talk.exchange.present(id, talk.now_ns));
    talk.be_silent(900);
    CHECK_FALSE(talk.was_said("present"));
    talk.done(id);  // of what it was not told to present
    CHECK(talk.all<RigLineRefused>().size() == 1);
    talk.answer_alive();
    CHECK(talk.was_said("present"));
    talk.touch(id);
    talk.pass(1000);
    talk.done(id);
    CHECK(talk.exchange.traffic().presented == 1);
    CHECK(talk.all<RigVoid>().empty());
  }
  SECTION("silent for less than 100 ms: at once, and the 100 ms begin then") {
    talk.be_silent(95);
    REQUIRE(talk.exchange.present(id, talk.now_ns));
    CHECK(talk.was_said("present"));
    talk.be_silent(100);
    CHECK(talk.all<RigVoid>().empty());
    talk.be_silent(5);
    REQUIRE(talk.all<RigVoid>().size() == 1);
    CHECK(talk.all<RigVoid>().front().failure == RigFailure::silent);
  }
  SECTION("stopped meanwhile: it is never told") {
    talk.be_silent(1000);
    REQUIRE(talk.exchange.present(id, talk.now_ns));
    talk.exchange.stop(RigStop::enough, talk.now_ns);
    talk.answer_alive();
    talk.done(id);
    CHECK_FALSE(talk.was_said("present"));
    REQUIRE(talk.all<RigVoid>().size() == 1);
    CHECK(talk.all<RigVoid>().front().failure == RigFailure::stopped);
    CHECK(talk.exchange.idle());
  }
  SECTION("always late: void after 2 s, and stopped") {
    std::vector<std::size_t> said;
    const auto late = [&](int ms) {  // each answer comes 150 ms late
      for (int passed = 0; passed < ms; passed += 5) {
        talk.be_silent(5);
        said.push_back(talk.written.size());
        if (said.size() <= 30) continue;
        const std::string all = std::exchange(talk.written, talk.written.substr(0, said[said.size() - 31]));
        talk.answer_alive();
        talk.written = all;
      }
    };
    late(1000);
    REQUIRE(talk.exchange.present(id, talk.now_ns));
    late(2000);
    CHECK(talk.all<RigVoid>().empty());
    late(5);
    REQUIRE(talk.all<RigVoid>().size() == 1);
    CHECK(talk.all<RigVoid>().front().words == "silent: for 2 s it answered no \"alive\" within 100 ms");
    CHECK(talk.was_said("stop"));
    CHECK_FALSE(talk.was_said("present"));
    CHECK_FALSE(talk.exchange.lost());
  }
}

TEST_CASE("the slowest answers are kept, while it presents and while it waits, and one that has not come") {
  Talk talk;
  talk.greet();
  talk.pass(500);
  CHECK(talk.exchange.traffic().slowest_waiting_ms == 0);
  talk.be_silent(305);
  CHECK(talk.exchange.traffic().slowest_waiting_ms == 300);
  talk.answer_alive();
  const std::uint64_t id = talk.begin_presentation();
  talk.pass(500);
  talk.be_silent(65);
  talk.done(id, "complete", 0.5);
  talk.pass(500);
  CHECK(talk.exchange.traffic().slowest_presenting_ms == 40);
  CHECK(talk.exchange.traffic().slowest_waiting_ms == 300);
  talk.exchange.end(RigFailure::ended, "test", talk.now_ns);
  talk.exchange.begin(talk.now_ns);
  talk.greet();
  talk.be_silent(505);
  CHECK(talk.exchange.traffic().slowest_presenting_ms == 40);  // since the program began
  CHECK(talk.exchange.traffic().slowest_waiting_ms == 500);
}

TEST_CASE("what tests give a rig more time for, it has") {
  constexpr double kMinutes_s = 600;
  RigExchange exchange("test", {.silent_s = kMinutes_s, .presenting_silent_s = kMinutes_s, .stop_s = kMinutes_s});
  std::int64_t now_ns = 1;
  exchange.begin(now_ns);
  exchange.hear(kGreeting, now_ns);
  exchange.tick(now_ns);
  std::string why;
  const std::uint64_t id = exchange.prepare(Talk::request(), now_ns, why);
  exchange.hear(fmt::format(R"({{"type":"ready","id":{}}})", id), now_ns);
  REQUIRE(exchange.present(id, now_ns));
  now_ns += 2'900 * kMs_ns;
  exchange.tick(now_ns);
  exchange.stop(RigStop::interrupted, now_ns);
  now_ns += 590'000 * kMs_ns;
  exchange.tick(now_ns);
  CHECK_FALSE(exchange.lost());
  exchange.hear(fmt::format(R"({{"type":"done","id":{},"outcome":"stopped","duration_s":1,"contacts":0}})", id),
                now_ns);
  CHECK(exchange.idle());
}

TEST_CASE("a rig that answers other numbers of alive than were said is refused") {
  Talk talk;
  talk.greet();
  talk.pass(50);
  talk.say(R"({"type":"alive","n":1000})");
  CHECK(talk.all<RigLineRefused>().size() == 1);
}

TEST_CASE("a program that was held up itself does not take the rig for silent") {
  Talk talk;
  talk.greet();
  talk.pass(100);
  talk.now_ns += 5000 * kMs_ns;  // nothing was said meanwhile, so nothing is missing
  talk.exchange.tick(talk.now_ns);
  CHECK_FALSE(talk.exchange.lost());
}

TEST_CASE("no done in time: stop, and after that the end") {
  Talk talk;
  talk.greet();
  (void)talk.begin_presentation();
  talk.pass(2990);
  CHECK(talk.all<RigVoid>().empty());
  talk.pass(50);
  REQUIRE(talk.all<RigVoid>().size() == 1);
  CHECK(talk.all<RigVoid>().front().failure == RigFailure::time_out);
  CHECK(talk.written.find("\"stop\"") != std::string::npos);
  talk.pass(250);
  REQUIRE(talk.exchange.lost());
  CHECK(talk.exchange.lost()->failure == RigFailure::not_stopped);
  CHECK(talk.all<RigVoid>().size() == 1);
}

TEST_CASE("stop: enough counts, everything else does not") {
  Talk talk;
  talk.greet();
  const std::uint64_t first = talk.begin_presentation();
  talk.pass(1000);
  talk.exchange.stop(RigStop::enough, talk.now_ns);
  talk.done(first);
  CHECK(talk.exchange.traffic().presented == 1);
  const std::uint64_t second = talk.begin_presentation();
  talk.pass(1000);
  talk.exchange.stop(RigStop::emergency, talk.now_ns);
  talk.done(second);  // that crossed the stop
  CHECK(talk.exchange.traffic().presented == 1);
  CHECK(talk.all<RigVoid>().size() == 1);
  CHECK(talk.exchange.idle());
}

TEST_CASE("a fault with an id voids one presentation, a fault without one ends the rig") {
  Talk talk;
  talk.greet();
  const std::uint64_t id = talk.begin_presentation();
  talk.say(fmt::format(R"({{"type":"fault","id":{},"cause":"too hot"}})", id));
  REQUIRE(talk.all<RigVoid>().size() == 1);
  CHECK(talk.all<RigVoid>().front().words == "the rig says: too hot");
  CHECK(talk.exchange.idle());
  talk.say(R"({"type":"fault","cause":"no power"})");
  REQUIRE(talk.exchange.lost());
  CHECK(talk.exchange.lost()->failure == RigFailure::rig_fault);
  CHECK(talk.exchange.lost()->words == "the rig says: no power");
  CHECK(talk.exchange.lost()->sealed == "the rig reports a fault");
}

TEST_CASE("babble is a fault") {
  Talk talk;
  talk.greet();
  for (int i = 0; i < kMostRefusedLines; ++i) talk.say("beep");
  CHECK_FALSE(talk.exchange.lost());
  talk.say("beep");
  REQUIRE(talk.exchange.lost());
  CHECK(talk.exchange.lost()->failure == RigFailure::babbling);
  CHECK(talk.exchange.lost()->words.starts_with(talk.exchange.lost()->sealed + ", the last: "));
  CHECK(talk.exchange.refused_lines().size() == kRefusedLinesKept);
}

TEST_CASE("a hello that is refused gives the reason when the time is over") {
  RigExchange exchange("test", {});
  exchange.begin(1);
  exchange.hear(R"({"type":"hello","protocol":1})", 2);
  exchange.tick(3);
  CHECK_FALSE(exchange.lost());
  exchange.tick(3'600'000'000'000);
  REQUIRE(exchange.lost());
  CHECK(exchange.lost()->failure == RigFailure::no_hello);
  CHECK(exchange.lost()->words.find("the last line was refused: ") != std::string::npos);
  CHECK(exchange.lost()->words.find("name") != std::string::npos);
  CHECK(exchange.lost()->sealed.find("refused") == std::string::npos);
}

TEST_CASE("another rig behind the same command is not taken for the first") {
  Talk talk;
  talk.greet();
  talk.exchange.end(RigFailure::ended, "test", talk.now_ns);
  talk.exchange.begin(talk.now_ns);
  std::string other = kGreeting;
  other.replace(other.find("S1"), 2, "S2");
  talk.say(other);
  REQUIRE(talk.exchange.lost());
  CHECK(talk.exchange.lost()->failure == RigFailure::no_hello);
}

TEST_CASE("a rig that says other units after a new start is another rig") {
  Talk talk;
  talk.greet();
  talk.exchange.end(RigFailure::ended, "test", talk.now_ns);
  talk.exchange.begin(talk.now_ns);
  std::string other = kGreeting;
  other.replace(other.find(R"("unit":"N"})"), 10, R"("unit":"mN")");
  talk.say(other);
  REQUIRE(talk.exchange.lost());
  CHECK(talk.exchange.lost()->failure == RigFailure::no_hello);
}

TEST_CASE("whoever has not the token is not the rig, and nobody hears the token") {
  const std::string token = "0123456789abcdef";
  const auto greeting = [](const std::string& with) {
    return kGreeting.substr(0, kGreeting.size() - 1) + R"(,"token":")" + with + R"("})";
  };
  for (const std::string& said : {kGreeting, greeting("0123456789abcdeX"), greeting(token + "0"), greeting("0")}) {
    RigExchange exchange("0.1.0", {}, token);
    exchange.begin(1);
    exchange.hear(said, 2);
    REQUIRE(exchange.lost());
    CHECK(exchange.lost()->failure == RigFailure::no_hello);
    CHECK_FALSE(exchange.hello());
  }
  RigExchange exchange("0.1.0", {}, token);
  exchange.begin(1);
  CHECK(exchange.take_output().find(token) == std::string::npos);
  exchange.hear(greeting(token), 2);
  CHECK(exchange.idle());
  CHECK(exchange.hello()->token.empty());
  exchange.hear(greeting(token), 3);  // once more, which is refused
  exchange.hear("{\"type\":\"hello\",\"token\":\"" + token + "\"}", 4);
  REQUIRE(exchange.refused_lines().size() == 2);
  for (const RigLineRefused& refused : exchange.refused_lines())
    CHECK((refused.line + refused.why).find(token) == std::string::npos);
}

TEST_CASE("telemetry has the channels of hello") {
  Talk talk;
  talk.greet();
  const std::uint64_t id = talk.begin_presentation();
  talk.say(fmt::format(R"({{"type":"telemetry","id":{},"time_s":0.1,"values":{{"force":1.5}}}})", id));
  talk.say(fmt::format(R"({{"type":"telemetry","id":{},"time_s":0.1,"values":{{"grip":1.5}}}})", id));
  CHECK(talk.all<RigTelemetry>().size() == 1);
  CHECK(talk.all<RigLineRefused>().size() == 1);
}

TEST_CASE("an answer is one of those that were asked for, once") {
  Talk talk;
  talk.greet();
  talk.say(R"({"type":"answer","id":1,"answer":"first"})");
  const std::uint64_t id = talk.exchange.ask({"first", "second"}, talk.now_ns);
  REQUIRE(id != 0);
  talk.say(fmt::format(R"({{"type":"answer","id":{},"answer":"third"}})", id));
  CHECK(talk.all<RigLineRefused>().size() == 2);
  talk.say(fmt::format(R"({{"type":"answer","id":{},"answer":"second","after_s":0.7}})", id));
  talk.say(fmt::format(R"({{"type":"answer","id":{},"answer":"first"}})", id));
  REQUIRE(talk.all<RigAnswer>().size() == 1);
  CHECK(talk.all<RigAnswer>().front().answer == "second");
  const std::uint64_t withdrawn = talk.exchange.ask({"first"}, talk.now_ns);
  talk.exchange.stop(RigStop::enough, talk.now_ns);
  REQUIRE(talk.all<RigVoid>().size() == 1);
  CHECK(talk.all<RigVoid>().front().id == withdrawn);
}

TEST_CASE("what the rig has not said that it can do is not asked of it") {
  Talk talk;
  std::string why;
  CHECK(talk.exchange.prepare(Talk::request(), talk.now_ns, why) == 0);
  CHECK(why == "the rig is not ready for a presentation");
  talk.greet();
  RenderRequest request = Talk::request();
  request.value = 2000;
  CHECK(talk.exchange.prepare(request, talk.now_ns, why) == 0);
  CHECK(why == "2000 N/m is out of the rig's range, stiffness 100 to 1000 N/m");
  request = Talk::request();
  request.parameters.clear();
  CHECK(talk.exchange.prepare(request, talk.now_ns, why) == 0);
  CHECK(why == "the rig's parameter gain is not given");
}
