// Free interaction with named objects, and profiles that answer questionnaires.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>

#include <unistd.h>

#include "devices/contact/object_json.h"
#include "protocols/input/input_error.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

const Protocol& experiment2() {
  static const Protocol protocol = load_protocol(source_path("protocols/chinello2017-experiment2.json"));
  return protocol;
}

RigDescription rig_with_objects() {
  RigDescription rig = rrs3_rig();
  for (const std::string& name : experiment2().explore->objects)
    rig.objects[name] = load_object(source_path("devices/objects") / (name + ".json")).shape;
  return rig;
}

PresentRequest free_request(const std::string& object, double seconds) {
  PresentRequest request;
  request.stimulus = {.stiffness = 900, .cues = kForce};
  request.explore_s = seconds;
  request.id = {.trial = 1};
  request.object = object;
  return request;
}

int contacts(const Presentation& presentation) {
  int all = 0;
  for (const FingerPresentation& finger : presentation.fingers) all += finger.contacts;
  return all;
}

std::string profile_complaint(const std::string& answers) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("jnd_answers_" + std::to_string(::getpid()) + ".json");
  std::ofstream(path)
      << R"({"format": 1, "name": "a", "title": "b", "strategy": "magnitude", "sigma_force_n_per_m": 100,
      "sigma_vibration_n_per_m": 100, "criterion_n_per_m": 50, "answers": )"
      << answers << "}";
  std::string said;
  try {
    (void)load_profile(path);
  } catch (const InputError& error) {
    said = error.what();
  }
  std::filesystem::remove(path);
  return said;
}

}  // namespace

TEST_CASE("A named object is rendered for its time, from the start, and felt") {
  SimulatedClock clock(0);
  const RigDescription description = rig_with_objects();
  const auto rig =
      make_simulated_rig(experiment2(), description, shipped_profile("chinello2017-experiment2"), 1, 1, clock);
  for (const auto& [name, object] : description.objects) {
    const Presentation felt = rig->present(free_request(name, 5));
    CHECK(felt.fault == Fault::none);
    CHECK(felt.duration_s == Approx(5).epsilon(1e-3));
    CHECK(contacts(felt) >= 4);
    for (const FingerPresentation& finger : felt.fingers) {
      CHECK(finger.contacts > 0);
      CHECK(finger.peak_force_n > 1);
      CHECK(finger.deepest_penetration < 0.015);
    }
  }
}

TEST_CASE("Free interaction that ends before the first contact is no fault") {
  SimulatedClock clock(0);
  const auto rig =
      make_simulated_rig(experiment2(), rig_with_objects(), shipped_profile("chinello2017-experiment2"), 1, 1, clock);
  const Presentation felt = rig->present(free_request("baseball", 0.05));
  CHECK(felt.fault == Fault::none);
  CHECK(felt.first_contact_s < 0);
}

TEST_CASE("The protocol's own object comes back after free interaction") {
  SimulatedClock clock(0);
  const auto description = rig_with_objects();
  const auto profile = shipped_profile("chinello2017-experiment2");
  const auto rig = make_simulated_rig(small_protocol(), description, profile, 1, 1, clock);
  const Presentation before = rig->present(request(500, kForce));
  (void)rig->present(free_request("teddy-bear", 2));
  const Presentation after = rig->present(request(500, kForce));
  CHECK(before.fingers[0].deepest_penetration == after.fingers[0].deepest_penetration);
  CHECK(before.fingers[0].contacts == after.fingers[0].contacts);
}

TEST_CASE("Objects that a rig has not, or cannot have, are refused by name") {
  SimulatedClock clock(0);
  const auto profile = shipped_profile("chinello2017-experiment2");
  const auto rig = make_simulated_rig(experiment2(), rig_with_objects(), profile, 1, 1, clock);
  CHECK_THROWS_AS(rig->present(free_request("cactus", 1)), std::invalid_argument);
  RigDescription large = rrs3_rig();
  large.objects["melon"] = sphere_object({.radius_m = 0.09});
  CHECK_THROWS_WITH(make_simulated_rig(experiment2(), large, profile, 1, 1, clock), Catch::Contains("melon"));
  RigDescription wall = rrs3_rig();
  wall.objects["wall"] = load_object(source_path("devices/objects/wall.json")).shape;
  CHECK_THROWS_WITH(make_simulated_rig(experiment2(), wall, profile, 1, 1, clock),
                    Catch::Contains("between two fingers"));
  RigDescription joint = shipped_rig("mckibben");
  joint.objects = rig_with_objects().objects;
  Protocol flexing = small_protocol();
  flexing.rig = {.device = "mckibben", .fingers = {"index"}, .tracker = "encoder"};
  CHECK_THROWS_WITH(make_simulated_rig(flexing, joint, profile, 1, 1, clock), Catch::Contains("drives a joint"));
}

TEST_CASE("The shipped profile has a habit for every item of the questionnaire, within its scale") {
  const ParticipantProfile profile = shipped_profile("chinello2017-experiment2");
  CHECK(default_profile(experiment2()) == profile.name);
  int ratings = 0;
  for (const Question& question : experiment2().questions) {
    if (question.kind != Question::Kind::rating) continue;
    ++ratings;
    REQUIRE(profile.answers.contains(question.id));
    const AnswerHabit& habit = profile.answers.at(question.id);
    CHECK(habit.rating.has_value() == (question.when == Question::When::after_session));
    std::map<std::string, RatingHabit> all = habit.ratings;
    if (habit.rating) all["once"] = *habit.rating;
    for (const auto& [name, rating] : all) {
      CHECK(rating.mean >= 1);
      CHECK(rating.mean <= 9);
      // The largest standard deviation of twelve ratings with that mean.
      CHECK(rating.sd <= std::sqrt((9 - rating.mean) * (rating.mean - 1) * 12 / 11));
    }
    // What the paper prints, but for the impossible spread of QB6.
    for (const PublishedValue& value : experiment2().published) {
      if (value.question != question.id) continue;
      const RatingHabit& own = habit.rating ? *habit.rating : habit.ratings.at(value.condition);
      CHECK(own.mean == value.value);
      if (value.sd != 7.6) CHECK(own.sd == value.sd);
    }
  }
  CHECK(ratings == 21);
}

TEST_CASE("Ratings follow the profile, are whole numbers on the scale, and come the same again") {
  SimulatedClock clock(0);
  const ParticipantProfile profile = shipped_profile("chinello2017-experiment2");
  const auto find = [](const std::string& id) -> const Question& {
    return *std::find_if(experiment2().questions.begin(), experiment2().questions.end(),
                         [&](const Question& question) { return question.id == id; });
  };
  double with = 0, without = 0;
  constexpr int kMany = 400;
  for (int participant = 1; participant <= kMany; ++participant) {
    const auto responder = make_simulated_participant(profile, experiment2(), participant, 7, clock);
    const std::string first = *responder->reply(find("QB5"), 0), second = *responder->reply(find("QB5"), 1);
    CHECK(first == *responder->reply(find("QB5"), 0));
    CHECK(std::stoi(first) >= 1);
    CHECK(std::stoi(second) <= 9);
    with += std::stoi(first);
    without += std::stoi(second);
    CHECK(*responder->reply(find("preference"), -1) == "wearing the devices");
  }
  CHECK(with / kMany == Approx(2.68).margin(0.25));  // 2.6 before rounding and clipping
  CHECK(without / kMany == Approx(5.4).margin(0.3));
}

TEST_CASE("Choices follow their weights") {
  SimulatedClock clock(0);
  ParticipantProfile profile = shipped_profile("chinello2017-experiment2");
  profile.answers["preference"].choices = {{"wearing the devices", 1}, {"bare hands", 3}};
  const Question& question = *std::find_if(experiment2().questions.begin(), experiment2().questions.end(),
                                           [](const Question& one) { return one.id == "preference"; });
  int bare = 0;
  for (int participant = 1; participant <= 1000; ++participant)
    bare +=
        *make_simulated_participant(profile, experiment2(), participant, 7, clock)->reply(question, -1) == "bare hands"
            ? 1
            : 0;
  CHECK(bare > 680);
  CHECK(bare < 820);
}

TEST_CASE("Mistakes in a profile's answers are found") {
  CHECK(profile_complaint(R"({"Q": {"rating": {"mean": 5, "sd": 1}}})").empty());
  CHECK(profile_complaint(R"({"Q": {"rating": {"mean": 5}}})").find("sd") != std::string::npos);
  CHECK(profile_complaint(R"({"Q": {}})").find("says nothing") != std::string::npos);
  CHECK(profile_complaint(R"({"Q": {"choices": {"a": 0}}})").find("weight") != std::string::npos);
  CHECK(profile_complaint(R"({"Q": {"choices": {"a": -1}}})").find("-1") != std::string::npos);
  CHECK(profile_complaint(R"({"Q": {"ratings": {"C": {"mean": 5, "sd": 1, "sdd": 2}}}})").find("sdd") !=
        std::string::npos);
}
