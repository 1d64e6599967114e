// What was measured, held against what was prescribed: the line that a trial keeps, and when it counts as broken.
#include "protocols/course/prescription.h"

#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

namespace {

Protocol prescribed() {
  return load_protocol(corpus_folder() / "good/prescription.json");
}

FingerPresentation finger(int contacts, double peak_force_n, double depth_m) {
  FingerPresentation one;
  one.contacts = contacts;
  one.peak_force_n = peak_force_n;
  one.deepest_penetration = depth_m;
  one.mean_speed = 0.02;
  return one;
}

Presentation felt(const std::vector<FingerPresentation>& fingers) {
  Presentation presentation;
  presentation.fingers = fingers;
  return presentation;
}

Trial trial_of(int condition) {
  Trial trial;
  trial.condition = condition;
  return trial;
}

}  // namespace

TEST_CASE("both ends of a limit are within it, and what lies outside is said with its interval, value and limit") {
  const Protocol protocol = prescribed();
  const Presentation kept = felt({finger(2, 4.5, 0.001)}), pressed = felt({finger(2, 4.6, 0.006)});
  CHECK(breach_of(trial_of(0), {kept, kept}, protocol).empty());
  const std::string line = breach_of(trial_of(0), {kept, pressed}, protocol);
  CHECK(line == "second interval: peak_force 4.6 N, above 4.5 N");
  CHECK(breaks_limit(line));
  CHECK(breach_of(trial_of(0), {felt({finger(1, 1, 0.0005)}), kept}, protocol) ==
        "first interval: contacts 1, below 2; first interval: depth 0.0005 m, below 0.001 m");
}

TEST_CASE("the finger that pressed hardest is judged: by force, and where the condition has none by depth") {
  Protocol protocol = prescribed();
  const Presentation two = felt({finger(2, 3, 0.007), finger(2, 4, 0.002)});
  CHECK(breach_of(trial_of(0), {two, two}, protocol).empty());
  protocol.conditions[0].cues = Cues{.vibration = true};
  CHECK(breaks_limit(breach_of(trial_of(0), {two, two}, protocol)));
}

TEST_CASE("a condition's own prescription takes the place of that of all trials") {
  const Protocol protocol = prescribed();
  const Presentation wild = felt({finger(9, 9, 0.02)});
  CHECK(breach_of(trial_of(1), {wild, wild}, protocol).empty());
  CHECK(breaks_limit(breach_of(trial_of(2), {wild, wild}, protocol)));
  CHECK(judges_exploration(protocol));
  CHECK(rule_repeats(protocol));
}

TEST_CASE("what a rig of the laboratory's own does not measure is said and breaks nothing") {
  Protocol protocol = prescribed();
  protocol.rig.device = std::string(kExternalRig);
  Presentation told;
  told.measured = {{"contacts", 2}, {"peak_force", 5}};
  CHECK(breach_of(trial_of(0), {told}, protocol) ==
        "depth not measured; peak_force 5 N, above 4.5 N; mean_speed not measured");
  told.measured["peak_force"] = 4;
  const std::string unknown = breach_of(trial_of(0), {told}, protocol);
  CHECK(unknown == "depth not measured; mean_speed not measured");
  CHECK_FALSE(breaks_limit(unknown));
}

TEST_CASE("of two that are felt together there is one line, and of a joint depths are angles") {
  Protocol protocol = prescribed();
  protocol.task.together = true;
  const Presentation deep = felt({finger(2, 1, 0.5)});
  Trial trial = trial_of(0);
  trial.unit = Unit::n_per_rad;
  CHECK(breach_of(trial, {deep, deep}, protocol) == "depth 0.5 rad, above 0.006 rad");
  CHECK(limit_text({"mean_speed", 0, 0.1}, Unit::n_per_rad) == "mean_speed 0 to 0.1 rad/s");
}
