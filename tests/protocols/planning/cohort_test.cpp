#include "protocols/planning/cohort.h"

#include <sstream>
#include <stdexcept>

#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

TEST_CASE("a cohort of 36 uses each pair of orders of the balanced design once") {
  const Protocol protocol = load_protocol(protocols_folder() / "chinello2017-balanced.json");
  const CohortBalance balance = balance_of_cohort(protocol, 36, 3);
  CHECK(balance.different_pairs_of_orders == 36);
  CHECK(balance.most_used_pair == 1);
  CHECK(balance.group_size == 6);
  CHECK(balance.pair_count == 36);
  REQUIRE(balance.series_orders.size() == 6);
  for (const OrderUse& use : balance.series_orders) CHECK(use.participants == 6);
  for (const OrderUse& use : balance.condition_orders) CHECK(use.participants == 6);
  for (const auto& row : balance.condition_positions) CHECK(row == std::vector<int>{36, 36, 36});
  for (const auto& row : balance.series_positions) CHECK(row == std::vector<int>{12, 12, 12});
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) CHECK(balance.condition_transitions[a][b] == (a == b ? 0 : 36));
  REQUIRE(balance.cells.size() == 9);
  for (const CellBalance& cell : balance.cells) {
    CHECK(cell.pairs == std::array<int, 4>{216, 216, 216, 216});
    CHECK(cell.same == 432);
    CHECK(cell.different == 432);
    CHECK(cell.least_same == 12);
    CHECK(cell.most_same == 12);
  }
  CHECK(balance.same == 36 * 108);
  CHECK(balance.different == 36 * 108);
}

TEST_CASE("independent draws show their spread") {
  const Protocol protocol = load_protocol(protocols_folder() / "chinello2017.json");
  const CohortBalance balance = balance_of_cohort(protocol, 18, 1);
  CHECK(balance.same + balance.different == 18 * 108);
  int spread = 0;
  for (const CellBalance& cell : balance.cells) {
    CHECK(cell.same + cell.different == 18 * 12);
    CHECK(cell.pairs[0] + cell.pairs[1] == cell.same);
    CHECK(cell.least_same <= cell.most_same);
    spread += cell.most_same - cell.least_same;
  }
  CHECK(spread > 9);
}

TEST_CASE("the text says at which sizes a cohort is balanced, within 100 columns") {
  for (const auto& file : shipped_files()) {
    const Protocol protocol = load_protocol(file);
    for (const int participants : {1, 5, 18, 36}) {
      const std::string text = to_text(balance_of_cohort(protocol, participants, 1), protocol);
      std::istringstream lines(text);
      for (std::string line; std::getline(lines, line);) {
        CAPTURE(line);
        CHECK(line.size() <= 100);
      }
    }
  }
  const Protocol protocol = load_protocol(protocols_folder() / "chinello2017.json");
  CHECK(to_text(balance_of_cohort(protocol, 18, 1), protocol).find("Exact: each order is used equally often by 18") !=
        std::string::npos);
  const std::string uneven = to_text(balance_of_cohort(protocol, 16, 1), protocol);
  CHECK(uneven.find("16 participants are not a multiple of 6; 18 would be") != std::string::npos);
  CHECK(uneven.find("pairs of series and condition orders at multiples of 36") != std::string::npos);
}

TEST_CASE("mixed conditions and random orders are said to be so; wide tables are summed up") {
  Protocol mixed = small_protocol(2, 2, 4, Sampling::balanced);
  mixed.design.arrangement = Arrangement::mixed;
  const CohortBalance balance = balance_of_cohort(mixed, 4, 1);
  CHECK(balance.condition_positions.empty());
  CHECK(to_text(balance, mixed).find("mixed within each series") != std::string::npos);

  Protocol random = small_protocol(12, 2, 4, Sampling::balanced);
  random.design.series_order = Order::random;
  const CohortBalance drawn = balance_of_cohort(random, 5, 1);
  CHECK(drawn.group_size == 0);
  const std::string text = to_text(drawn, random);
  CHECK(text.find("balanced by chance only") != std::string::npos);
  CHECK(text.find("every entry lies between") != std::string::npos);
  CHECK_THROWS_AS(balance_of_cohort(random, 0, 1), std::invalid_argument);
}
