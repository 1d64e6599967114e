// Devices that are programs, on real sockets: found, shared, cut off, killed and back again.
#include "devices/hid/socket/socket_bus.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <random>
#include <thread>

#include <sys/socket.h>

#include "devices/device_error.h"
#include "devices/hid/hid_reader.h"
#include "devices/hid/link/hid_rig.h"
#include "devices/hid/our_devices.h"
#include "devices/hid/page_exchange.h"
#include "devices/hid/socket/shared_socket.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/devices/hid/link/link_fixtures.h"
#include "tests/devices/hid/socket/served_device.h"
#include "tests/temporary_folder.h"
#include "tests/text_checks.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

using Folder = jnd::TemporaryFolder;

SocketDevice at(const std::filesystem::path& socket) {
  return {.path = socket.string(), .socket = socket};
}

// Both ends of one connection, the program's end in the test's hands.
struct Pair {
  Pair() {
    auto [ours, its] = local_pair();
    shared = std::make_shared<SharedSocket>(std::move(ours));
    peer = std::move(its);
  }
  bool send(std::size_t size) const {
    const std::array<std::uint8_t, 5000> bytes{1};
    return ::send(peer.get(), bytes.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(size);
  }
  std::shared_ptr<SharedSocket> shared;
  OwnedFile peer;
};

int read_one(HidHandle& handle, int timeout_ms = 0) {
  std::array<std::uint8_t, 1024> bytes{};
  return handle.read(bytes, timeout_ms);
}

constexpr int kGuard_ms = 600'000;  // of a read that is certain to end

// What is there, once that many are: a bus does not wait long for a program to say who it is, and a busy machine may.
std::vector<HidInfo> listed(HidBus& bus, std::size_t count) {
  std::vector<HidInfo> found;
  REQUIRE(wait_until([&] { return (found = bus.list()).size() >= count; }));
  return found;
}

struct Counter final : HidListener {
  void report(std::span<const std::uint8_t> /*bytes*/, std::int64_t /*time_ns*/) noexcept override { ++reports; }
  void lost(const std::string& /*why*/) override { ++losses; }
  std::atomic<int> reports{0}, losses{0};
};

}  // namespace

TEST_CASE("a served device is listed by what it says of itself, and opened", "[socket_bus]") {
  const Folder folder;
  const ServedDevice device(folder / "thumb.sock", "RRS3-0001", JND_THUMB);
  SocketBus bus({at(device.socket()), at(folder / "none.sock")});
  const std::vector<HidInfo> found = listed(bus, 1);
  REQUIRE(found.size() == 1);
  CHECK(found[0].path == device.socket().string());
  CHECK(found[0].serial == "RRS3-0001");
  CHECK(found[0].usage_page == JND_USAGE_PAGE);
  CHECK(found[0].usage == JND_USAGE_FINGERTIP);
  CHECK(found[0].transport == "socket");
  CHECK(contains(bus.absent(), "no device is served at " + (folder / "none.sock").string()));
  CHECK_THROWS_AS(bus.open("another path"), DeviceError);
  CHECK_THROWS_AS(bus.open((folder / "none.sock").string()), DeviceError);
  const std::unique_ptr<HidHandle> handle = bus.open(found[0].path);
  CHECK(PageExchange(*handle, "x").identity().finger == JND_THUMB);
  CHECK(listed(bus, 1).size() == 1);  // while it is open
}

TEST_CASE("every handle gets every report, whichever of them listens", "[socket_bus]") {
  const Pair pair;
  const std::unique_ptr<HidHandle> first = pair.shared->handle(), second = pair.shared->handle();
  for (int i = 0; i < 3; ++i) REQUIRE(pair.send(JND_REPORT_SIZE));
  for (int i = 0; i < 3; ++i) CHECK(read_one(*first) == JND_REPORT_SIZE);
  CHECK(read_one(*first) == kHidTimeOut);
  for (int i = 0; i < 3; ++i) CHECK(read_one(*second) == JND_REPORT_SIZE);
  CHECK(read_one(*second, 1) == kHidTimeOut);
  // From several threads at once.
  constexpr int kReports = 200;
  std::array<std::atomic<int>, 2> counts{};
  std::atomic<bool> ends{false};
  std::vector<std::thread> readers;
  for (std::size_t i = 0; i < 2; ++i)
    readers.emplace_back([&, i] {
      HidHandle& handle = i == 0 ? *first : *second;
      while (!ends.load())
        if (read_one(handle, 5) == JND_REPORT_SIZE) ++counts[i];
    });
  for (int i = 0; i < kReports; ++i) {
    // A handle keeps kReportsQueued and no more, and a thread may be held up for longer than they take to come.
    const bool sent = wait_until([&] { return i - std::min(counts[0].load(), counts[1].load()) < kReportsQueued; }) &&
                      wait_until([&] { return pair.send(JND_REPORT_SIZE); });
    CHECK(sent);
    if (!sent) break;
  }
  CHECK(wait_until([&] { return counts[0] == kReports && counts[1] == kReports; }));
  ends = true;
  for (std::thread& reader : readers) reader.join();
}

TEST_CASE("a handle that does not read keeps the newest, and holds nobody up", "[socket_bus]") {
  const Pair pair;
  const std::unique_ptr<HidHandle> reads = pair.shared->handle(), sleeps = pair.shared->handle();
  for (int i = 0; i < 3 * kReportsQueued; ++i) {
    REQUIRE(pair.send(JND_REPORT_SIZE));
    CHECK(read_one(*reads) == JND_REPORT_SIZE);
  }
  int kept = 0;
  while (read_one(*sleeps) > 0) ++kept;
  CHECK(kept == kReportsQueued);
}

TEST_CASE("a packet that is no report is never read as one", "[socket_bus]") {
  const Pair pair;
  const std::unique_ptr<HidHandle> handle = pair.shared->handle();
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{63}, std::size_t{65}, std::size_t{5000}}) {
    CAPTURE(size);
    REQUIRE(pair.send(size));
    const int count = read_one(*handle, kGuard_ms);
    CHECK(count > 0);
    CHECK(count < JND_REPORT_SIZE);
  }
  REQUIRE(pair.send(JND_REPORT_SIZE));
  CHECK(read_one(*handle) == JND_REPORT_SIZE);
  const std::array<std::uint8_t, JND_REPORT_SIZE + 1> longer{};
  CHECK_FALSE(handle->write(longer));
  CHECK_FALSE(handle->write(std::span(longer).first(3)));
}

TEST_CASE("what was sent before the end is read, then it is gone, for every handle", "[socket_bus]") {
  Pair pair;
  const std::unique_ptr<HidHandle> first = pair.shared->handle(), second = pair.shared->handle();
  REQUIRE(pair.send(JND_REPORT_SIZE));
  pair.peer.close();
  CHECK(read_one(*first) == JND_REPORT_SIZE);
  CHECK(read_one(*first, kGuard_ms) == kHidGone);
  CHECK(read_one(*second) == JND_REPORT_SIZE);
  CHECK(read_one(*second) == kHidGone);
  CHECK(pair.shared->is_gone());
  CHECK(contains(first->error(), "closed the connection"));
  CHECK_FALSE(first->write(std::array<std::uint8_t, JND_REPORT_SIZE>{}));
}

TEST_CASE("a device that does not read takes no more commands, and does not hold the writer", "[socket_bus]") {
  const Pair pair;
  const std::unique_ptr<HidHandle> handle = pair.shared->handle();
  const std::array<std::uint8_t, JND_REPORT_SIZE> report{};
  int taken = 0;
  while (taken < 10 * kReportsQueued && handle->write(report)) ++taken;
  CHECK(taken >= 8);
  CHECK(taken <= 2 * kReportsQueued);
  CHECK(contains(handle->error(), "does not read"));
}

TEST_CASE("a device that sends without end is cut off, and its reader stays free", "[socket_bus]") {
  const Folder folder;
  const OwnedFile listening = listen_local(folder / "babbler.sock");
  std::atomic<bool> ends{false};
  std::atomic<int> connections{0};
  std::thread babbler([&] {
    const std::array<std::uint8_t, JND_REPORT_SIZE> report{JND_REPORT_TELEMETRY, JND_PROTOCOL_VERSION};
    while (!ends.load()) {
      OwnedFile host;
      (void)wait_until([&] { return ends.load() || (host = accept_local(listening)).get() >= 0; });
      if (ends.load()) break;
      ++connections;
      for (;;) {
        const ssize_t sent = send(host.get(), report.data(), report.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        if ((sent < 0 && errno != EAGAIN) || ends.load()) break;
      }
    }
  });
  {
    SocketBus bus({at(folder / "babbler.sock")});
    CHECK(wait_until([&] {
      CHECK(bus.list().empty());
      return contains(bus.absent(), "sends more than 4000 reports a second");
    }));
    const std::unique_ptr<HidHandle> handle = bus.open((folder / "babbler.sock").string());
    int count = 0;
    while (read_one(*handle, kGuard_ms) > 0) ++count;
    CHECK(count >= kMostReportsAtOnce - 1);
    CHECK(contains(handle->error(), "cut off"));
    // A reader that listens to it ends when it is told to, and looks again meanwhile.
    Counter counter;
    const int before = connections.load();
    const HidReader reader(
        bus, [](const HidInfo&) { return true; }, counter);
    CHECK(wait_until([&] { return connections.load() >= before + 2; }));
  }
  ends = true;
  babbler.join();
}

TEST_CASE("a link finds its device again each time its program was killed", "[socket_bus]") {
  const Folder folder;
  ServedDevice device(folder / "index.sock", "RRS3-0001", JND_INDEX);
  SocketBus bus({at(device.socket())});
  const SteadyClock clock;
  FingertipLink link(bus, target_of("RRS3-0001", "index"), clock);
  REQUIRE(wait_until([&] { return link.connection() > 0; }));
  std::mt19937 random(7);  // NOLINT(cert-msc51-cpp): after as many reports in every run
  constexpr int kKills = 8;
  for (int kill = 1; kill <= kKills; ++kill) {
    CAPTURE(kill);
    const std::int64_t reports = link.report().received + static_cast<std::int64_t>(random() % 40);
    REQUIRE(wait_until([&] { return link.report().received >= reports; }));
    device.kill();
    REQUIRE(wait_until([&] { return link.connection() == 0; }));
    CHECK(contains(link.missing(), "is not there"));
    device.start();
    REQUIRE(wait_until([&] { return link.connection() > 0; }));
    CHECK(link.missing().empty());
  }
  const DeviceLinkReport report = link.report();
  CHECK(report.reconnections == kKills);
  CHECK(report.damaged == 0);
  CHECK(report.is_model);
}

TEST_CASE("a rig of served devices: unplugged while it presses, it stops, and goes on when it is back",
          "[socket_bus]") {
  const Folder folder;
  const ServedDevice thumb(folder / "thumb.sock", "RRS3-0001", JND_THUMB);
  ServedDevice index(folder / "index.sock", "RRS3-0002", JND_INDEX);
  SocketBus bus({at(thumb.socket()), at(index.socket())});
  RigFile file;
  // One by its serial number, the other by where it is.
  file.devices = {{"thumb", "RRS3-0001"}, {.finger = "index", .serial = "", .socket = index.socket()}};
  SteadyClock clock;
  const Protocol protocol = small_protocol();
  const std::unique_ptr<Rig> rig =
      make_hid_rig(protocol, rrs3_rig(), file, shipped_profile("chinello2017"), 1, 42, clock, bus,
                   {.realtime = RealtimePolicy::prefer}, std::chrono::minutes(10));
  CHECK(rig->connections().on_a_model());
  CHECK(rig->connections().devices[1].serial == "RRS3-0002");
  const auto felt = [&rig](double explore_s) {
    PresentRequest asked = request(500, kForce);
    asked.explore_s = explore_s;
    return rig->present(asked);
  };
  // A busy machine may be late: what counts is that a presentation succeeds, and what it then delivers.
  const auto delivers = [&felt] {
    const Presentation presented = felt(0.6);
    if (presented.fault != Fault::none) return false;
    for (const FingerPresentation& finger : presented.fingers)
      CHECK(finger.stiffness.value_or(0) == Approx(500).epsilon(0.1));
    return presented.fingers.size() == 2;
  };
  REQUIRE(wait_until(delivers));
  std::atomic<bool> over{false};
  std::thread hand([&, before = index.pushes()] {
    (void)wait_until([&] { return index.pushes() > before || over.load(); });
    index.kill();
  });
  const Presentation stopped = felt(60);
  over = true;
  hand.join();
  CHECK(stopped.fault != Fault::none);
  REQUIRE(wait_until([&] { return contains(rig->missing(), "RRS3-0002"); }));
  index.start();
  REQUIRE(wait_until([&] { return rig->missing().empty(); }));
  CHECK(wait_until(delivers));
}

TEST_CASE("a program that cannot serve is named, with its last words, and started once a second", "[socket_bus]") {
  const Folder folder;
  const std::string started = (folder / "started").string();
  SocketBus bus(
      std::vector<SocketDevice>{{.path = "program:thumb",
                                 .command = {"sh", "-c", "echo x >> started; echo 'no\033hard''ware' >&2; exit 3"},
                                 .folder = folder.path()}});
  // More time than this measures cannot have passed between two starts, however busy the machine is.
  const auto begun = std::chrono::steady_clock::now();
  CHECK(wait_until([&] {
    CHECK(bus.list().empty());
    return contains(bus.absent(), "has ended (exit code 3), and said last: no?hardware");
  }));
  for (int i = 0; i < 30; ++i) CHECK(bus.list().empty());
  std::string told;  // to a session
  CHECK(wait_until([&] {
    try {
      (void)bus.open("program:thumb");
    } catch (const DeviceError& error) {
      told = error.what();
    }
    return contains(told, "has ended (exit code 3)");
  }));
  CHECK_FALSE(contains(told, "hardware"));
  const auto passed = std::chrono::steady_clock::now() - begun;
  const std::uintmax_t starts = std::filesystem::file_size(started) / 2;
  CHECK(starts <= 1 + static_cast<std::uintmax_t>(passed / std::chrono::seconds(1)));
  SocketBus none(std::vector<SocketDevice>{{.path = "program:thumb", .command = {"jnd-no-such-program"}}});
  CHECK(none.list().empty());
  CHECK(contains(none.absent(), "jnd-no-such-program cannot be started: No such file"));
}

TEST_CASE("two buses are one", "[socket_bus]") {
  const Folder folder;
  const ServedDevice device(folder / "thumb.sock", "RRS3-0001", JND_THUMB);
  auto second = std::make_unique<MemoryBus>();
  second->add(jnd_fingertip_default_config("RRS3-0002", JND_INDEX), shipped_rrs3());
  JoinedBus bus(std::make_unique<SocketBus>(std::vector<SocketDevice>{at(device.socket()), at(folder / "none.sock")}),
                std::move(second));
  const std::vector<HidInfo> found = listed(bus, 3);
  REQUIRE(found.size() == 3);  // a keyboard is on every memory bus
  CHECK(found[0].serial == "RRS3-0001");
  CHECK(std::count_if(found.begin(), found.end(), [](const HidInfo& one) { return one.serial == "RRS3-0002"; }) == 1);
  CHECK(contains(bus.absent(), "none.sock"));
  for (const HidInfo& info : found)
    if (is_fingertip(info)) CHECK_NOTHROW(bus.open(info.path));
}
