// The firmware's pages: read always, written at rest only, kept with a CRC.
#include <cstring>

#include "tests/catch.h"
#include "tests/devices/hid/firmware/firmware_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

jnd_force_table some_table() {
  return {.points = 3, .sensor_un = {0, 1'000'000, 3'000'000}, .force_un = {50'000, 1'150'000, 3'050'000}};
}
jnd_certificate some_certificate() {
  jnd_certificate certificate{};
  std::memcpy(certificate.calibration_id, "0123456789abcdef", JND_CALIBRATION_ID_SIZE);
  certificate.date = 20260301;
  return certificate;
}

std::uint8_t write_table(Board& board, const jnd_force_table& table) {
  std::uint8_t data[JND_PAGE_SIZE];
  jnd_encode_force_table(&table, data);
  return board.ask(JND_PAGE_FORCE_TABLE, data)->result;
}
std::uint8_t write_certificate(Board& board, const jnd_certificate& certificate) {
  std::uint8_t data[JND_PAGE_SIZE];
  jnd_encode_certificate(&certificate, data);
  return board.ask(JND_PAGE_CERTIFICATE, data)->result;
}

jnd_identity identity_of(Board& board) {
  const auto answer = board.ask(JND_PAGE_IDENTITY);
  REQUIRE(answer);
  jnd_identity identity{};
  REQUIRE(jnd_decode_identity(answer->data, &identity));
  return identity;
}

double told_n(Board& board, float sensor_n) {
  board.sensors.force_n = sensor_n;
  return 1e-6 * board.step()->force_un;
}

}  // namespace

TEST_CASE("firmware: every page is what it was made with") {
  Board board;
  REQUIRE(board.power_up());
  const jnd_identity identity = identity_of(board);
  CHECK(identity.lowest_version == 1);
  CHECK(identity.highest_version == 1);
  CHECK(identity.model == JND_MODEL_RRS3);
  CHECK(identity.finger == JND_INDEX);
  CHECK(identity.loop_rate_hz == 1000);
  CHECK(identity.watchdog_ms == 20);
  CHECK(std::string(identity.serial) == "TEST-1");
  CHECK(identity.calibration_id[0] == 0);
  CHECK(identity.calibration_date == 0);

  jnd_limits limits{};
  auto answer = board.ask(JND_PAGE_LIMITS);
  REQUIRE(answer);
  CHECK(answer->result == JND_PAGE_OK);
  CHECK(answer->page == JND_PAGE_LIMITS);
  CHECK(answer->token == board.token);
  REQUIRE(jnd_decode_limits(answer->data, &limits));
  CHECK(limits.most_force_un == 4'700'000);
  CHECK(limits.most_force_rise_mn_per_s == 500'000);

  jnd_geometry geometry{};
  answer = board.ask(JND_PAGE_GEOMETRY);
  REQUIRE(jnd_decode_geometry(answer->data, &geometry));
  CHECK(std::memcmp(&geometry, &board.config.geometry, sizeof geometry) == 0);

  jnd_force_table table{};
  answer = board.ask(JND_PAGE_FORCE_TABLE);
  REQUIRE(jnd_decode_force_table(answer->data, &table));
  CHECK(table.points == 0);
  jnd_certificate certificate{};
  answer = board.ask(JND_PAGE_CERTIFICATE);
  REQUIRE(jnd_decode_certificate(answer->data, &certificate));
  CHECK(certificate.date == 0);

  for (const int page : {5, 17, 255}) CHECK(board.ask(static_cast<std::uint8_t>(page))->result == JND_PAGE_UNKNOWN);
}

TEST_CASE("firmware: a serial of all sixteen characters fits, and a longer one is cut") {
  const jnd_fingertip_config config = jnd_fingertip_default_config("0123456789ABCDEFG", JND_THUMB);
  Board board(config);
  REQUIRE(board.power_up());
  CHECK(std::string(identity_of(board).serial, JND_SERIAL_SIZE) == "0123456789ABCDEF");
}

TEST_CASE("firmware: a calibration is written at rest, acts at once and survives power-down") {
  Board board;
  REQUIRE(board.power_up());
  CHECK(told_n(board, 2) == Approx(2));
  CHECK(write_table(board, some_table()) == JND_PAGE_OK);
  CHECK(write_certificate(board, some_certificate()) == JND_PAGE_OK);
  CHECK(board.stored == 2);
  for (int powered = 0; powered < 2; ++powered) {
    CHECK(std::string(identity_of(board).calibration_id, JND_CALIBRATION_ID_SIZE) == "0123456789abcdef");
    CHECK(identity_of(board).calibration_date == 20260301);
    // Straight lines between the points; the first and the last go on.
    CHECK(told_n(board, 0) == Approx(0.05).margin(2e-6));
    CHECK(told_n(board, 0.5F) == Approx(0.6).margin(2e-6));
    CHECK(told_n(board, 1) == Approx(1.15).margin(2e-6));
    CHECK(told_n(board, 2) == Approx(2.1).margin(2e-6));
    CHECK(told_n(board, 4) == Approx(4.0).margin(2e-6));
    CHECK(told_n(board, -1) == Approx(-1.05).margin(2e-6));
    REQUIRE(board.power_up());
  }
  // Another table keeps the certificate, and the other way round.
  jnd_force_table other = some_table();
  other.points = 2;
  other.sensor_un[2] = other.force_un[2] = 0;
  CHECK(write_table(board, other) == JND_PAGE_OK);
  REQUIRE(board.power_up());
  CHECK(identity_of(board).calibration_date == 20260301);
  CHECK(told_n(board, 3) == Approx(3.35).margin(2e-6));
}

TEST_CASE("firmware: writing is refused where it must be, and changes nothing") {
  Board board;
  REQUIRE(board.power_up());
  std::uint8_t data[JND_PAGE_SIZE];
  for (const int page : {JND_PAGE_IDENTITY, JND_PAGE_LIMITS, JND_PAGE_GEOMETRY}) {
    const auto before = board.ask(static_cast<std::uint8_t>(page));
    std::memcpy(data, before->data, sizeof data);
    data[0] ^= 1;
    CHECK(board.ask(static_cast<std::uint8_t>(page), data)->result == JND_PAGE_REFUSED);
    CHECK(std::memcmp(board.ask(static_cast<std::uint8_t>(page))->data, before->data, sizeof data) == 0);
  }
  CHECK(board.ask(9, data)->result == JND_PAGE_UNKNOWN);

  jnd_force_table falling = some_table();
  falling.force_un[2] = 0;
  CHECK(write_table(board, falling) == JND_PAGE_INVALID);
  jnd_force_table single = some_table();
  single.points = 1;
  CHECK(write_table(board, single) == JND_PAGE_INVALID);
  jnd_certificate undated = some_certificate();
  undated.date = 20261301;
  CHECK(write_certificate(board, undated) == JND_PAGE_INVALID);

  board.memory_works = false;
  CHECK(write_table(board, some_table()) == JND_PAGE_REFUSED);
  CHECK(told_n(board, 2) == Approx(2));
  board.memory_works = true;
  CHECK(board.stored == 0);

  // Only at rest.
  board.give(pressing(1));
  CHECK(board.step()->state == JND_STATE_ACTIVE);
  CHECK(write_table(board, some_table()) == JND_PAGE_REFUSED);
  CHECK(board.ask(JND_PAGE_FORCE_TABLE)->result == JND_PAGE_OK);
  CHECK(board.step(30'000)->state == JND_STATE_STOPPED);
  CHECK(write_certificate(board, some_certificate()) == JND_PAGE_REFUSED);
  CHECK(board.stored == 0);
  board.give_rest(2);
  CHECK(write_certificate(board, some_certificate()) == JND_PAGE_OK);
}

TEST_CASE("firmware: a stored calibration with any damaged bit counts as none") {
  Board board;
  REQUIRE(board.power_up());
  REQUIRE(write_table(board, some_table()) == JND_PAGE_OK);
  REQUIRE(write_certificate(board, some_certificate()) == JND_PAGE_OK);
  const std::vector<std::uint8_t> whole = board.memory;
  REQUIRE(whole.size() == JND_CALIBRATION_SIZE);
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    board.memory = whole;
    board.memory[bit / 8] = static_cast<std::uint8_t>(board.memory[bit / 8] ^ (1U << (bit % 8)));
    REQUIRE(board.power_up());
    jnd_identity identity{};
    REQUIRE(jnd_decode_identity(board.ask(JND_PAGE_IDENTITY)->data, &identity));
    REQUIRE(identity.calibration_date == 0);
    REQUIRE(told_n(board, 2) == Approx(2));
  }
  board.memory = std::vector<std::uint8_t>(JND_CALIBRATION_SIZE, 0);  // an erased memory
  REQUIRE(board.power_up());
  CHECK(identity_of(board).calibration_date == 0);
  board.memory.clear();
  REQUIRE(board.power_up());
  CHECK(identity_of(board).calibration_date == 0);
}

TEST_CASE("firmware: an identity's own calibration holds until one is stored") {
  jnd_fingertip_config config = jnd_fingertip_default_config("TEST-1", JND_INDEX);
  std::memcpy(config.identity.calibration_id, "factory", 7);
  config.identity.calibration_date = 20250102;
  Board board(config);
  REQUIRE(board.power_up());
  CHECK(std::string(identity_of(board).calibration_id) == "factory");
  REQUIRE(write_table(board, some_table()) == JND_PAGE_OK);
  CHECK(identity_of(board).calibration_date == 20250102);
  REQUIRE(write_certificate(board, some_certificate()) == JND_PAGE_OK);
  CHECK(identity_of(board).calibration_date == 20260301);
}

TEST_CASE("firmware: an answer without room waits for it") {
  Board board;
  REQUIRE(board.power_up());
  board.step();
  board.room = false;
  CHECK_FALSE(board.ask(JND_PAGE_LIMITS));
  CHECK_FALSE(board.step());
  board.room = true;
  CHECK(board.step());
  const auto answer = board.last_answer();
  REQUIRE(answer);
  CHECK(answer->page == JND_PAGE_LIMITS);
  CHECK(answer->token == board.token);
  board.step();
  CHECK_FALSE(board.last_answer());  // once
}

TEST_CASE("firmware: damaged requests get no answer") {
  Board board;
  REQUIRE(board.power_up());
  jnd_request request{};
  ReportBytes bytes{};
  jnd_encode_request(&request, bytes.data());
  bytes[4] ^= 1;
  board.sent.clear();
  board.give(bytes);
  CHECK_FALSE(board.last_answer());
  CHECK(board.step()->rejected == 0);  // that counts commands
}
