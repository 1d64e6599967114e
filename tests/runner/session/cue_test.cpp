// Cues to the participant: which come from the devices, and that they are the same whatever is presented.
#include "runner/session/session_engine.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

using test::Bench;
using test::small_protocol;

Protocol with_taps() {
  return small_protocol(
      {{"trial",
        {{"cues", {{"first", {{"kind", "tap"}}}, {"second", {{"kind", "tap"}}}, {"question", {{"kind", "none"}}}}}}}});
}

TEST_CASE("A tap is presented by the devices before each interval, the same for every stimulus and condition") {
  Bench bench(with_taps());
  std::vector<PresentRequest> asked;
  bench.rig.fault = [&](const PresentRequest& request) {
    asked.push_back(request);
    return Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  REQUIRE(asked.size() == 16 * 4);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const bool tap = i % 2 == 0;
    CHECK((asked[i].tap_g > 0) == tap);
    if (!tap) continue;
    CHECK(asked[i].tap_g == asked[0].tap_g);
    CHECK(asked[i].explore_s == asked[0].explore_s);
    CHECK(asked[i].stimulus == Stimulus{});
    CHECK(asked[i].object.empty());
  }
}

TEST_CASE("A device that fails in a tap voids the attempt, and nothing is presented after it") {
  Bench bench(with_taps());
  int after_failure = 0;
  bench.rig.fault = [&](const PresentRequest& request) {
    const bool fails = request.id.trial == 2 && request.id.attempt == 1;
    if (fails && request.tap_g == 0) ++after_failure;
    return fails && request.tap_g > 0 ? Fault::device_lost : Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  CHECK(after_failure == 0);
  CHECK(replay(bench.log.events()).voided.at(2) == 1);
  CHECK(bench.completed().size() == 16);
}

}  // namespace
}  // namespace jnd
