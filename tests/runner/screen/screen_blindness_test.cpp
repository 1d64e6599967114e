// What the operator's screen could give away: how well the stiffness, or the condition, of an interval can be told from
// what is shown live. The figures that it prints are those of runner/README.md.
#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include <fmt/format.h>

#include "devices/loop/telemetry_ring.h"
#include "devices/rigs/fingertip_rig.h"
#include "devices/rigs/rig_factory.h"
#include "protocols/rigs/rig_description.h"
#include "runner/screen/screen_parts.h"
#include "runner/session/device_health.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

const std::string kSource = JND_SOURCE_DIR;
constexpr int kIntervals = 100;           // of each class
constexpr std::int64_t kLook_ticks = 25;  // between two snapshots of the loop
constexpr double kHabit_m = 0.005;        // depth of the shipped hand
constexpr double kForce_n = 3.6;          // of a hand that presses everything equally hard: 4 mm at 900 N/m, 9 at 400

// An interval as it could be shown: at every snapshot, whether there is contact, and how deep it is.
struct Shown {
  std::vector<bool> contact;
  std::vector<int> depth;  // 0 none, 1 light, 2 medium, 3 deep: thirds of the expected press
};

enum class Hand { shipped, equally_hard };

Shown present(const Cues& cues, double stiffness, Hand hand, int interval) {
  Protocol protocol = test::small_protocol();
  const bool feels = hand == Hand::equally_hard && cues.force;
  protocol.stimulus.expected_press = feels ? kForce_n / stiffness : kHabit_m;
  const RigDescription description{.spec = load_rig_spec(kSource + "/devices/specs/rrs3.json")};
  static const ParticipantProfile profile = load_profile(kSource + "/devices/profiles/chinello2017.json");
  SimulatedClock clock(0);
  const auto rig = make_simulated_rig(protocol, description, profile, 1, 1, clock,
                                      {.telemetry_ticks = 40'000, .realtime = std::nullopt});
  PresentRequest request;
  request.stimulus.stiffness = stiffness;
  request.stimulus.cues = cues;
  request.explore_s = 3;
  request.no_contact_time_out_s = 10;
  request.id = {interval, 1, 0};
  const Presentation given = rig->present(request);
  REQUIRE(given.fault == Fault::none);
  std::vector<TickRecord> ticks;
  rig->telemetry()->drain(ticks);
  Shown shown;
  const std::size_t devices = given.fingers.size();
  for (std::size_t tick = 0; tick + devices <= ticks.size(); tick += kLook_ticks * devices) {
    double deepest = 0;
    for (std::size_t device = 0; device < devices; ++device)
      deepest = std::max(deepest, ticks[tick + device].penetration);
    shown.contact.push_back(deepest > 0);
    shown.depth.push_back(deepest <= 0 ? 0 : std::min(3, 1 + static_cast<int>(3 * deepest / kHabit_m)));
  }
  return shown;
}

// What can be counted of an interval.
std::vector<double> features_of_contact(const Shown& shown) {
  double looks = 0, touches = 0, first = -1, last = 0;
  for (std::size_t i = 0; i < shown.contact.size(); ++i) {
    if (!shown.contact[i]) continue;
    if (first < 0) first = static_cast<double>(i);
    last = static_cast<double>(i);
    ++looks;
    touches += i == 0 || !shown.contact[i - 1] ? 1 : 0;
  }
  return {looks, touches, first, last, static_cast<double>(shown.contact.size())};
}

std::vector<double> features_of_depth(const Shown& shown) {
  std::vector<double> counts(4);
  for (const int word : shown.depth) ++counts[static_cast<std::size_t>(word)];
  counts.push_back(*std::max_element(shown.depth.begin(), shown.depth.end()));
  return counts;
}

// The intervals from the smallest value of each feature to its largest.
std::vector<std::vector<std::size_t>> orders_of(const std::vector<std::vector<double>>& features) {
  std::vector<std::vector<std::size_t>> orders(features.front().size(), std::vector<std::size_t>(features.size()));
  for (std::size_t feature = 0; feature < orders.size(); ++feature) {
    std::iota(orders[feature].begin(), orders[feature].end(), std::size_t{0});
    std::sort(orders[feature].begin(), orders[feature].end(),
              [&](std::size_t a, std::size_t b) { return features[a][feature] < features[b][feature]; });
  }
  return orders;
}

// The best that a threshold on any one feature does on these very intervals: share of right guesses, 0.5 .. 1.
double best_guess(const std::vector<std::vector<double>>& features, const std::vector<std::vector<std::size_t>>& orders,
                  const std::vector<bool>& second_class) {
  double best = 0.5;
  const auto n = static_cast<double>(features.size());
  const auto all_second = static_cast<double>(std::count(second_class.begin(), second_class.end(), true));
  for (std::size_t feature = 0; feature < orders.size(); ++feature) {
    double right = all_second;  // where what is above the threshold is said to be of the second class
    for (std::size_t i = 0; i < orders[feature].size(); ++i) {
      const std::size_t at = orders[feature][i];
      right += second_class[at] ? -1 : 1;
      const bool last_of_its_value =
          i + 1 == orders[feature].size() || features[orders[feature][i + 1]][feature] > features[at][feature];
      if (last_of_its_value) best = std::max({best, right / n, 1 - right / n});
    }
  }
  return best;
}

struct Guess {
  double told = 0;    // by what is shown
  double chance = 0;  // the same with the classes shuffled: 95 of 100 shuffles do no better
  double most = 0;    // the best of 1000 shuffles: what is told by more than this is not told by chance
};

template <typename Features>
Guess guess(const std::vector<Shown>& first, const std::vector<Shown>& second, Features features_of) {
  std::vector<std::vector<double>> features;
  std::vector<bool> second_class;
  for (const bool is_second : {false, true})
    for (const Shown& shown : is_second ? second : first) {
      features.push_back(features_of(shown));
      second_class.push_back(is_second);
    }
  const std::vector<std::vector<std::size_t>> orders = orders_of(features);
  Guess result{.told = best_guess(features, orders, second_class)};
  std::mt19937 random(1);
  std::vector<double> shuffled;
  for (int i = 0; i < 1000; ++i) {
    std::shuffle(second_class.begin(), second_class.end(), random);
    shuffled.push_back(best_guess(features, orders, second_class));
  }
  result.most = *std::max_element(shuffled.begin(), shuffled.end());
  std::sort(shuffled.begin(), shuffled.begin() + 100);
  result.chance = shuffled[94];
  return result;
}

std::vector<Shown> intervals(const Cues& cues, double stiffness, Hand hand, int from) {
  std::vector<Shown> all;
  for (int i = 0; i < kIntervals; ++i) all.push_back(present(cues, stiffness, hand, from + i));
  return all;
}

constexpr Cues kForce{.force = true, .vibration = false}, kVibration{.force = false, .vibration = true};

TEST_CASE("From what the screen shows neither the stiffness nor the condition of an interval can be told", "[long]") {
  for (const Hand hand : {Hand::shipped, Hand::equally_hard}) {
    const std::vector<Shown> soft = intervals(kForce, 400, hand, 1), stiff = intervals(kForce, 900, hand, 1001),
                             buzzed = intervals(kVibration, 400, hand, 2001);
    const Guess contact = guess(soft, stiff, features_of_contact),
                condition = guess(stiff, buzzed, features_of_contact), depth = guess(soft, stiff, features_of_depth);
    const char* const name = hand == Hand::shipped ? "the shipped hand" : "a hand that presses everything equally hard";
    for (const auto& [what, told] : {std::pair("400 or 900 N/m, by contact yes or no", contact),
                                     std::pair("force or vibration alone, by contact yes or no", condition),
                                     std::pair("400 or 900 N/m, by three words of depth", depth)})
      fmt::print("{}: {}: {:.0f} % of {} intervals right (chance: up to {:.0f} %)\n", name, what, 100 * told.told,
                 2 * kIntervals, 100 * told.chance);
    CHECK(contact.told <= contact.most);
    CHECK(condition.told <= condition.most);
    // Why depth is not shown: a person is more like the second hand than like the first.
    if (hand == Hand::equally_hard) CHECK(depth.told > 0.9);
  }
}

// The same finger, whatever is rendered to it: the same rows, letter by letter.
TEST_CASE("The row of the devices is the same at every stiffness and in every condition") {
  const Area area;
  const auto rows = [&](const Cues& cues, double stiffness) {
    std::string text;
    for (const bool contact : present(cues, stiffness, Hand::shipped, 7).contact) {
      LoopSnapshot snapshot{.ticks = 25, .elapsed_s = 0.025, .contact = contact};
      for (const Span& part : health_row(area, health_of(snapshot))) text += part.text + " ";
      text += "\n";
    }
    return text;
  };
  const std::string shown = rows(kForce, 900);
  CHECK(shown.find("Devices at work: contact") != std::string::npos);
  CHECK(shown.find("Devices at work: no contact") != std::string::npos);
  for (const Cues& cues : {kForce, kVibration, Cues{.force = true, .vibration = true}})
    for (const double stiffness : {400.0, 900.0, 2000.0}) CHECK(rows(cues, stiffness) == shown);
}

TEST_CASE("What a presentation delivered leaves no trace on the screen when it is over") {
  const Area area;
  const auto row_of = [&](double force_n, double saturated_share, Fault fault) {
    Presentation given;
    given.ticks = 3000;
    given.duration_s = 3;
    given.fault = fault;
    FingerPresentation finger;
    finger.peak_force_n = force_n;
    finger.saturated_share = saturated_share;
    given.fingers = {finger};
    std::string text;
    for (const Span& part : health_row(area, health_of(given))) text += part.text + " ";
    return text;
  };
  const std::string rest = row_of(0, 0, Fault::none);
  CHECK(rest.find("Devices at rest") != std::string::npos);
  CHECK(row_of(4.7, 0.2, Fault::none) == rest);
  // A stop and a pause are no faults of the devices.
  for (const Fault fault : {Fault::emergency_stop, Fault::interrupted, Fault::no_contact})
    CHECK(row_of(2, 0, fault) == rest);
  CHECK(row_of(2, 0, Fault::device_lost).find("FAULT") != std::string::npos);
}

}  // namespace
}  // namespace jnd
