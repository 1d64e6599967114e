#include "protocols/random_stream.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <Random123/philox.h>

#include "tests/catch.h"

using namespace jnd;

TEST_CASE("Philox4x64-10 gives the published known answers") {
  // Random123, examples/kat_vectors, lines "philox4x64 10".
  struct Known {
    r123::Philox4x64::ctr_type counter;
    r123::Philox4x64::key_type key;
    r123::Philox4x64::ctr_type answer;
  };
  const std::uint64_t ones = ~std::uint64_t{0};
  const std::vector<Known> known = {
      {{{0, 0, 0, 0}},
       {{0, 0}},
       {{0x16554d9eca36314cU, 0xdb20fe9d672d0fdcU, 0xd7e772cee186176bU, 0x7e68b68aec7ba23bU}}},
      {{{ones, ones, ones, ones}},
       {{ones, ones}},
       {{0x87b092c3013fe90bU, 0x438c3c67be8d0224U, 0x9cc7d7c69cd777b6U, 0xa09caebf594f0ba0U}}},
      {{{0x243f6a8885a308d3U, 0x13198a2e03707344U, 0xa4093822299f31d0U, 0x082efa98ec4e6c89U}},
       {{0x452821e638d01377U, 0xbe5466cf34e90c6cU}},
       {{0xa528f45403e61d95U, 0x38c72dbd566e9788U, 0xa5a1610e72fd18b5U, 0x57bd43b5e52b7fe6U}}},
  };
  for (const Known& one : known) CHECK(r123::Philox4x64{}(one.counter, one.key) == one.answer);
}

TEST_CASE("FNV-1a gives the published known answers") {
  CHECK(hash_of_name("") == 0xcbf29ce484222325U);
  CHECK(hash_of_name("a") == 0xaf63dc4c8601ec8cU);
  CHECK(hash_of_name("foobar") == 0x85944171f73967e8U);
}

TEST_CASE("a stream is Philox of its documented key and counter") {
  RandomStream stream(7, 3, "stimuli/1/SV", 5);
  for (std::uint64_t position = 0; position < 3; ++position) {
    const auto block = r123::Philox4x64{}({{position, 5, 3, 0}}, {{7, hash_of_name("stimuli/1/SV")}});
    for (std::size_t i = 0; i < 4; ++i) CHECK(stream.next() == block[i]);
  }
}

TEST_CASE("below is uniform and stays below") {
  RandomStream stream(1, 1, "test");
  std::vector<int> counts(7, 0);
  for (int i = 0; i < 70000; ++i) ++counts.at(static_cast<std::size_t>(stream.below(7)));
  // Standard deviation 92.6: 5 of them, 7 cells.
  for (const int count : counts) CHECK(std::abs(count - 10000) < 463);
  CHECK(RandomStream(1, 1, "test").below(1) == 0);
}

TEST_CASE("shuffle gives every order of four equally often") {
  RandomStream stream(2, 1, "test");
  std::vector<int> counts(24, 0);
  std::vector<int> order(4);
  for (int i = 0; i < 24000; ++i) {
    std::iota(order.begin(), order.end(), 0);
    stream.shuffle(order);
    int rank = 0;
    std::vector<int> sorted = {0, 1, 2, 3};
    while (sorted != order && std::next_permutation(sorted.begin(), sorted.end())) ++rank;
    ++counts.at(static_cast<std::size_t>(rank));
  }
  for (const int count : counts) CHECK(std::abs(count - 1000) < 5 * 31);
}

TEST_CASE("uniform never leaves the open interval, normal has mean 0 and SD 1") {
  RandomStream stream(3, 1, "test");
  double sum = 0, squares = 0;
  for (int i = 0; i < 40000; ++i) {
    const double u = stream.uniform();
    REQUIRE(u > 0);
    REQUIRE(u < 1);
    const double z = stream.normal();
    sum += z;
    squares += z * z;
  }
  CHECK(std::abs(sum / 40000) < 5 * 0.005);
  CHECK(std::abs(squares / 40000 - 1) < 5 * 0.0071);
}
