// Thresholds of adaptive tracks, and what is said where there is none.
#include "analysis/thresholds/adaptive_threshold.h"

#include <cmath>

#include "tests/catch.h"

using namespace jnd;

namespace {
constexpr std::array<double, 2> kClamp = {10, 100};
}

TEST_CASE("the mean of reversals takes an even number of the last") {
  const std::vector<double> reversals = {90, 10, 40, 20, 60};
  CHECK(mean_of_reversals(reversals, 4).n == 4);
  CHECK(mean_of_reversals(reversals, 4).mean == Approx(32.5));
  // Deviations -22.5, 7.5, -12.5, 27.5: squares 506.25 + 56.25 + 156.25 + 756.25 = 1475.
  CHECK(mean_of_reversals(reversals, 4).sd == Approx(std::sqrt(1475.0 / 3)));
  CHECK(mean_of_reversals(reversals, 5).n == 4);
  CHECK(mean_of_reversals(reversals, 99).n == 4);
  CHECK(mean_of_reversals(reversals, 3).mean == Approx(40));
  CHECK(mean_of_reversals({5}, 6).n == 0);
  CHECK(std::isnan(mean_of_reversals({5}, 6).mean));
  CHECK(mean_of_reversals({}, -2).n == 0);
}

TEST_CASE("a staircase is ok, short or pinned") {
  const AdaptiveThreshold good = staircase_threshold({50}, {60, 40, 60, 40}, 4, kClamp);
  CHECK(good.status == AdaptiveStatus::ok);
  CHECK(good.threshold == Approx(50));
  CHECK(good.n == 4);
  const AdaptiveThreshold brief = staircase_threshold({50}, {60, 40, 60}, 4, kClamp);
  CHECK(brief.status == AdaptiveStatus::too_few_reversals);
  CHECK(brief.threshold == Approx(50));
  CHECK(brief.n == 2);
  const AdaptiveThreshold none = staircase_threshold({50}, {}, 4, kClamp);
  CHECK(none.status == AdaptiveStatus::too_few_reversals);
  CHECK(std::isnan(none.threshold));
  CHECK(staircase_threshold({}, {}, 4, kClamp).status == AdaptiveStatus::no_trials);
  // Two of four reversals at the end of the clamp are not more than half of them; three are.
  CHECK(staircase_threshold({50}, {100, 80, 100, 80}, 4, kClamp).status == AdaptiveStatus::ok);
  CHECK(staircase_threshold({50}, {100, 80, 100, 100}, 4, kClamp).status == AdaptiveStatus::pinned_at_clamp);
  CHECK(staircase_threshold({50, 100}, {}, 4, kClamp).status == AdaptiveStatus::pinned_at_clamp);
  CHECK(staircase_threshold({50, 10}, {}, 4, kClamp).status == AdaptiveStatus::pinned_at_clamp);
}

TEST_CASE("a QUEST threshold is ten to the mean, within the clamp") {
  const AdaptiveThreshold good = quest_threshold(1.5, 0.1, 30, kClamp);
  CHECK(good.status == AdaptiveStatus::ok);
  CHECK(good.threshold == Approx(31.622776601683793));
  CHECK(good.sd == 0.1);
  CHECK(good.n == 30);
  CHECK(quest_threshold(2, 0.1, 30, kClamp).status == AdaptiveStatus::pinned_at_clamp);
  CHECK(quest_threshold(2.3, 0.1, 30, kClamp).status == AdaptiveStatus::pinned_at_clamp);
  CHECK(quest_threshold(0.9, 0.1, 30, kClamp).status == AdaptiveStatus::pinned_at_clamp);
  CHECK(quest_threshold(1.5, 0.1, 0, kClamp).status == AdaptiveStatus::no_trials);
}

TEST_CASE("tracks that are ok are averaged, others left out") {
  const AdaptiveThreshold a{AdaptiveStatus::ok, 40, 3, 6}, b{AdaptiveStatus::ok, 60, 5, 4};
  const AdaptiveThreshold stuck{AdaptiveStatus::pinned_at_clamp, 100, 0, 6};
  const AdaptiveThreshold brief{AdaptiveStatus::too_few_reversals, 70, 1, 2};
  const AdaptiveThreshold both = combined_staircases({a, b, stuck});
  CHECK(both.status == AdaptiveStatus::ok);
  CHECK(both.threshold == Approx(50));
  CHECK(both.n == 10);
  CHECK(both.sd == Approx(std::sqrt((9 * 5 + 25 * 3) / 8.0)));
  CHECK(combined_staircases({stuck, brief}).status == AdaptiveStatus::pinned_at_clamp);
  CHECK(combined_staircases({brief}).status == AdaptiveStatus::too_few_reversals);
  CHECK(combined_staircases({}).status == AdaptiveStatus::no_trials);
  CHECK(std::isnan(combined_staircases({stuck}).threshold));

  // A track that did not end counts if it is registered so, and is counted either way.
  const AdaptiveThreshold empty{AdaptiveStatus::too_few_reversals, kNaN, kNaN, 0};
  const AdaptiveThreshold without = combined_staircases({a, stuck, brief, empty});
  CHECK(without.threshold == Approx(40));
  CHECK((without.tracks.all == 4 && without.tracks.used == 1 && without.tracks.unfinished == 2));
  const AdaptiveThreshold with = combined_staircases({a, stuck, brief, empty}, UnfinishedTracks::use);
  CHECK(with.threshold == Approx(55));
  CHECK(with.n == 8);
  CHECK((with.tracks.all == 4 && with.tracks.used == 2 && with.tracks.unfinished == 2));
  CHECK(combined_staircases({brief}, UnfinishedTracks::use).status == AdaptiveStatus::ok);
  CHECK(combined_staircases({empty}, UnfinishedTracks::use).status == AdaptiveStatus::too_few_reversals);

  const AdaptiveThreshold low{AdaptiveStatus::ok, 10, 0.3, 20}, high{AdaptiveStatus::ok, 1000, 0.4, 30};
  const AdaptiveThreshold quests = combined_quests({low, high});
  CHECK(quests.threshold == Approx(100));
  CHECK(quests.sd == Approx(0.25));
  CHECK(quests.n == 50);
}

TEST_CASE("every status has its word") {
  CHECK(to_string(AdaptiveStatus::ok) == "ok");
  CHECK(to_string(AdaptiveStatus::too_few_reversals) == "too_few_reversals");
  CHECK(to_string(AdaptiveStatus::no_trials) == "no_trials");
  CHECK(to_string(AdaptiveStatus::pinned_at_clamp) == "pinned_at_clamp");
}

TEST_CASE("a posterior of all answers is ok, says less than the prior, or ends at the grid's end") {
  LogPosterior of{std::log(200), 0.3, std::log(110), std::log(370), 0.7, false, 60};
  const AdaptiveThreshold good = posterior_threshold(of);
  CHECK(good.status == AdaptiveStatus::ok);
  CHECK(good.threshold == Approx(200));
  CHECK(good.sd == 0.3);
  CHECK(good.low == Approx(110));
  CHECK(good.high == Approx(370));
  CHECK(good.n == 60);
  CHECK(good.prior_weight == Approx(0.09 / 0.49));
  of.sd = 0.494;  // half of the prior's variance is at 0.49497
  CHECK(posterior_threshold(of).status == AdaptiveStatus::ok);
  of.sd = 0.496;
  const AdaptiveThreshold few = posterior_threshold(of);
  CHECK(few.status == AdaptiveStatus::too_few_answers);
  CHECK(std::isnan(few.threshold));
  CHECK(std::isnan(few.high));
  CHECK(few.sd == 0.496);
  CHECK(few.n == 60);
  of.at_end = true;
  CHECK(posterior_threshold(of).status == AdaptiveStatus::pinned_at_grid);
  of.trials = 0;
  CHECK(posterior_threshold(of).status == AdaptiveStatus::no_trials);
  CHECK(to_string(AdaptiveStatus::too_few_answers) == "too_few_answers");
  CHECK(to_string(AdaptiveStatus::pinned_at_grid) == "pinned_at_grid");
}
