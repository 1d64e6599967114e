#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "protocols/planning/order.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

int longest_run(const std::vector<bool>& sequence) {
  int longest = 0, run = 0;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    run = i > 0 && sequence[i] == sequence[i - 1] ? run + 1 : 1;
    longest = std::max(longest, run);
  }
  return longest;
}

// By listing all arrangements.
std::vector<std::vector<bool>> all_limited(int same, int different, int limit) {
  std::vector<bool> sequence(static_cast<std::size_t>(different), false);
  sequence.insert(sequence.end(), static_cast<std::size_t>(same), true);
  std::vector<std::vector<bool>> all;
  do {
    if (longest_run(sequence) <= limit) all.push_back(sequence);
  } while (std::next_permutation(sequence.begin(), sequence.end()));
  return all;
}

}  // namespace

TEST_CASE("sequences are drawn wherever listing finds some, and are among those listed") {
  for (int same = 0; same <= 6; ++same)
    for (int different = 0; different <= 6; ++different)
      for (int limit = 1; limit <= 7; ++limit) {
        CAPTURE(same, different, limit);
        const auto all = all_limited(same, different, limit);
        RandomStream stream(7, 1, "test");
        if (all.empty()) CHECK_THROWS_AS(draw_limited_sequence(same, different, limit, stream), std::invalid_argument);
        for (int draw = 0; draw < 5 && !all.empty(); ++draw)
          CHECK(std::count(all.begin(), all.end(), draw_limited_sequence(same, different, limit, stream)) == 1);
      }
}

TEST_CASE("limited sequences are drawn uniformly among all that exist") {
  struct Case {
    int same, different, limit;
  };
  for (const Case one : {Case{4, 4, 2}, Case{4, 4, 3}, Case{3, 5, 2}, Case{4, 4, 8}, Case{6, 3, 2}, Case{5, 5, 1},
                         Case{2, 6, 4}, Case{6, 6, 3}}) {
    CAPTURE(one.same, one.different, one.limit);
    const auto all = all_limited(one.same, one.different, one.limit);
    const int each = 400;
    std::map<std::vector<bool>, int> counts;
    for (std::size_t draw = 0; draw < all.size() * each; ++draw) {
      RandomStream stream(11, 1, "test", draw);
      const auto sequence = draw_limited_sequence(one.same, one.different, one.limit, stream);
      REQUIRE(longest_run(sequence) <= one.limit);
      REQUIRE(std::count(sequence.begin(), sequence.end(), true) == one.same);
      ++counts[sequence];
    }
    REQUIRE(counts.size() == all.size());
    double chi_squared = 0;
    for (const auto& [sequence, count] : counts) chi_squared += std::pow(count - each, 2) / each;
    const double freedom = static_cast<double>(all.size()) - 1;
    CHECK(std::abs(chi_squared - freedom) < 5 * std::sqrt(2 * freedom));
  }
}

TEST_CASE("long blocks keep their limit") {
  for (const int limit : {1, 2, 4, 10}) {
    RandomStream stream(1, 1, "test");
    const auto sequence = draw_limited_sequence(500, 500, limit, stream);
    CHECK(sequence.size() == 1000);
    CHECK(std::count(sequence.begin(), sequence.end(), true) == 500);
    CHECK(longest_run(sequence) <= limit);
  }
}

TEST_CASE("impossible run limits are refused") {
  RandomStream stream(1, 1, "test");
  CHECK_THROWS_AS(draw_limited_sequence(5, 1, 2, stream), std::invalid_argument);
  CHECK_THROWS_AS(draw_limited_sequence(2, 2, 0, stream), std::invalid_argument);
  CHECK_THROWS_AS(draw_limited_sequence(501, 500, 4, stream), std::invalid_argument);
  CHECK_THROWS_AS(draw_limited_sequence(-1, 2, 4, stream), std::invalid_argument);
  CHECK(draw_limited_sequence(0, 0, 3, stream).empty());
}
