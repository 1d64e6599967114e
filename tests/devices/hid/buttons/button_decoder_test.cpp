// Presses and releases out of reports: first edges, bounce, taps, what was down when a box was opened.
#include <algorithm>
#include <limits>

#include <rapidcheck.h>

#include "devices/hid/buttons/button_presses.h"
#include "tests/catch.h"
#include "tests/units.h"

namespace jnd {
namespace {

constexpr std::int64_t kLater = std::numeric_limits<std::int64_t>::max() / 2;

ButtonMapping box(int debounce_ms = 10) {
  ButtonMapping mapping;
  mapping.report_bytes = 2;
  mapping.debounce_ms = debounce_ms;
  mapping.buttons = {{ButtonMeaning::same, ButtonBits{0, 1, 1}},
                     {ButtonMeaning::different, ButtonBits{0, 2, 2}},
                     {ButtonMeaning::stop, ButtonBits{1, 0x80, 0}}};  // pressed where the bit is not set
  return mapping;
}

struct Edge {
  std::int64_t time_ns = 0;
  bool pressed = false;
};

// Reports of three buttons, of which some change at each time.
struct Reports {
  explicit Reports(int debounce_ms = 10) : decoder(box(debounce_ms)) { decoder.opened(-10'000 * kMs); }
  void set(ButtonMeaning meaning, bool pressed) { down[static_cast<std::size_t>(meaning)] = pressed; }
  void feed(std::int64_t time_ns) {
    const std::array<std::uint8_t, 2> report = {static_cast<std::uint8_t>((down[0] ? 1 : 0) | (down[1] ? 2 : 0)),
                                                static_cast<std::uint8_t>(down[2] ? 0 : 0x80)};
    take(decoder.feed(report, time_ns));
  }
  void take(const ButtonChanges& changes) {
    std::int64_t before = std::numeric_limits<std::int64_t>::min();
    for (const ButtonChange& change : changes) {
      CHECK(change.time_ns >= before);
      before = change.time_ns;
      found[static_cast<std::size_t>(change.meaning)].push_back({change.time_ns, change.pressed});
    }
    stops = stops || changes.stops;
  }
  ButtonDecoder decoder;
  std::array<bool, 3> down{};
  std::array<std::vector<Edge>, 3> found;
  bool stops = false;
};

bool operator==(const Edge& a, const Edge& b) {
  return a.time_ns == b.time_ns && a.pressed == b.pressed;
}

std::ostream& operator<<(std::ostream& out, const Edge& edge) {
  return out << (edge.pressed ? "down " : "up ") << edge.time_ns / kMs << " ms";
}

// The same rule over a whole list of edges of one button: what it is at the end of a change's own window is what it is.
std::vector<Edge> debounced(const std::vector<Edge>& edges, std::int64_t debounce_ns) {
  std::vector<Edge> changes;
  bool state = false;
  std::size_t at = 0;
  while (at < edges.size()) {
    if (edges[at].pressed == state) {
      ++at;
      continue;
    }
    Edge change = edges[at];
    for (bool more = true; more;) {
      changes.push_back(change);
      state = change.pressed;
      while (at < edges.size() && edges[at].time_ns <= change.time_ns + debounce_ns) ++at;
      more = edges[at - 1].pressed != state;
      change = edges[at - 1];
    }
  }
  return changes;
}

TEST_CASE("Any interleaving of three buttons is debounced, each by itself, at first edges") {
  REQUIRE(rc::check("as the rule over the whole list", [] {
    const int debounce_ms = *rc::gen::inRange(0, 20);
    const auto steps = *rc::gen::container<std::vector<std::pair<int, int>>>(
        rc::gen::pair(rc::gen::inRange(1, 25), rc::gen::inRange(1, 8)));
    Reports reports(debounce_ms);
    std::array<std::vector<Edge>, 3> edges;
    std::int64_t now_ns = 0;
    for (const auto& [gap_ms, toggled] : steps) {
      now_ns += gap_ms * kMs;
      for (int i = 0; i < 3; ++i) {
        if ((toggled >> i & 1) == 0) continue;
        bool& down = reports.down[static_cast<std::size_t>(i)];
        down = !down;
        edges[static_cast<std::size_t>(i)].push_back({now_ns, down});
      }
      reports.feed(now_ns);
    }
    reports.take(reports.decoder.settle(kLater));
    for (std::size_t i = 0; i < 3; ++i) RC_ASSERT(reports.found[i] == debounced(edges[i], debounce_ms * kMs));
  }));
}

TEST_CASE("Bounce for up to the debounce time is one press, of its first edge") {
  REQUIRE(rc::check("one press", [] {
    const int debounce_ms = *rc::gen::inRange(1, 50);
    // Odd edges let go, even ones press again; an even number of them ends pressed.
    auto offsets =
        *rc::gen::unique<std::vector<std::int64_t>>(rc::gen::inRange<std::int64_t>(1, debounce_ms * kMs + 1));
    if (offsets.size() % 2 == 1) offsets.pop_back();
    std::sort(offsets.begin(), offsets.end());
    Reports reports(debounce_ms);
    reports.set(ButtonMeaning::same, true);
    reports.feed(0);
    bool down = true;
    for (const std::int64_t offset_ns : offsets) {
      reports.set(ButtonMeaning::same, down = !down);
      reports.feed(offset_ns);
    }
    reports.take(reports.decoder.settle(kLater));
    RC_ASSERT(reports.found[0] == (std::vector<Edge>{{0, true}}));
  }));
}

TEST_CASE("A tap shorter than the debounce time is a press and a release, also where no other report comes") {
  Reports reports;
  reports.set(ButtonMeaning::different, true);
  reports.feed(0);
  reports.set(ButtonMeaning::different, false);
  reports.feed(6 * kMs);
  CHECK(reports.found[1] == std::vector<Edge>{{0, true}});
  reports.take(reports.decoder.settle(10 * kMs));
  CHECK(reports.found[1].size() == 1);  // it may still bounce
  reports.take(reports.decoder.settle(11 * kMs));
  CHECK(reports.found[1] == std::vector<Edge>{{0, true}, {6 * kMs, false}});
  // And at the next report, without being asked.
  Reports other;
  other.set(ButtonMeaning::different, true);
  other.feed(0);
  other.set(ButtonMeaning::different, false);
  other.feed(6 * kMs);
  other.set(ButtonMeaning::different, true);
  other.feed(500 * kMs);
  CHECK(other.found[1] == std::vector<Edge>{{0, true}, {6 * kMs, false}, {500 * kMs, true}});
}

TEST_CASE("A stop is heard at its first edge, also where it may be bounce") {
  Reports reports;
  reports.feed(0);
  CHECK_FALSE(reports.stops);
  reports.set(ButtonMeaning::stop, true);
  reports.feed(20 * kMs);
  CHECK(std::exchange(reports.stops, false));
  reports.set(ButtonMeaning::stop, false);
  reports.feed(40 * kMs);
  CHECK_FALSE(reports.stops);
  reports.set(ButtonMeaning::stop, true);
  reports.feed(45 * kMs);
  CHECK(reports.stops);
}

TEST_CASE("What is down in a report right after opening is no press, but stops") {
  Reports reports;
  reports.decoder.opened(0);
  reports.set(ButtonMeaning::same, true);
  reports.set(ButtonMeaning::stop, true);
  const std::array<std::uint8_t, 2> report = {1, 0};
  const ButtonChanges changes = reports.decoder.feed(report, 5 * kMs);
  REQUIRE(changes.size() == 2);
  for (const ButtonChange& change : changes) CHECK(change.found_down);
  CHECK(changes.stops);
  CHECK(reports.decoder.is_down(ButtonMeaning::stop));
  // A box that reports changes only: the first report is a press, however late it comes.
  ButtonDecoder quiet{box()};
  quiet.opened(0);
  const ButtonChanges pressed = quiet.feed(report, ButtonDecoder::kOpening_ns + 1);
  REQUIRE(pressed.size() == 2);
  CHECK_FALSE(pressed.begin()->found_down);
  // And what comes after the first is a press at any time.
  ButtonDecoder streaming{box()};
  streaming.opened(0);
  const std::array<std::uint8_t, 2> up = {0, 0x80};
  CHECK(streaming.feed(up, kMs).size() == 0);
  CHECK_FALSE(streaming.feed(report, 20 * kMs).begin()->found_down);
}

TEST_CASE("Reports that the mapping does not speak of change nothing") {
  ButtonMapping mapping = box();
  mapping.report_id = 3;
  mapping.report_bytes = 2;
  mapping.buttons = {{ButtonMeaning::same, ButtonBits{1, 1, 1}}, {ButtonMeaning::different, ButtonBits{1, 2, 2}}};
  ButtonDecoder decoder(mapping);
  decoder.opened(-10'000 * kMs);
  for (const std::vector<std::uint8_t>& report :
       std::vector<std::vector<std::uint8_t>>{{}, {3}, {2, 1}, {3, 1, 0}, {1, 3}}) {
    CHECK_FALSE(decoder.speaks_of(report));
    CHECK(decoder.feed(report, 0).size() == 0);
  }
  const std::vector<std::uint8_t> right = {3, 1};
  CHECK(decoder.feed(right, 0).size() == 1);
}

TEST_CASE("A keyboard with too many keys down changes nothing") {
  ButtonMapping mapping;
  mapping.report_bytes = 8;
  mapping.buttons = {{ButtonMeaning::same, ButtonCode{2, 7, 30}}, {ButtonMeaning::different, ButtonCode{2, 7, 31}}};
  ButtonDecoder decoder(mapping);
  decoder.opened(-10'000 * kMs);
  const std::vector<std::uint8_t> one = {0, 0, 30, 0, 0, 0, 0, 0}, lost = {0, 0, 1, 1, 1, 1, 1, 1}, none(8);
  CHECK(decoder.feed(one, 0).size() == 1);
  CHECK(decoder.feed(lost, 100 * kMs).size() == 0);
  CHECK(decoder.is_down(ButtonMeaning::same));
  const ButtonChanges released = decoder.feed(none, 200 * kMs);
  REQUIRE(released.size() == 1);
  CHECK_FALSE(released.begin()->pressed);
}

}  // namespace
}  // namespace jnd
