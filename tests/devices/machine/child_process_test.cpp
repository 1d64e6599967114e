// Programs that are started: with an input, and ended with everything that they started.
#include "devices/machine/child_process.h"

#include <fstream>

#include <poll.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "tests/catch.h"
#include "tests/wait_until.h"

using namespace jnd;

namespace {

// What a program has written once it closes its output or so many bytes have come.
std::string heard_from(const ChildProcess& child, std::size_t bytes) {
  std::string text;
  std::array<char, 512> buffer{};
  while (text.size() < bytes) {
    pollfd file{child.output(), POLLIN, 0};
    (void)poll(&file, 1, -1);
    const ssize_t count = read(child.output(), buffer.data(), buffer.size());
    if (count <= 0) break;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
  return text;
}

// How it ends by itself: what has closed its output has not exited yet.
std::string end_of(ChildProcess& child) {
  CHECK(wait_until([&] { return child.has_exited(); }));
  return child.end();
}

// Neither gone nor a zombie that another process has to reap.
bool is_running(const std::string& pid) {
  std::ifstream file("/proc/" + pid + "/stat");
  std::string stat;
  std::getline(file, stat, '\0');
  const std::size_t name_end = stat.rfind(')');
  return name_end != std::string::npos && stat.at(name_end + 2) != 'Z' && stat.at(name_end + 2) != 'X';
}

}  // namespace

TEST_CASE("a child with an input hears what is written and where it ends") {
  ChildProcess child({"cat"}, {}, ChildInput::pipe);
  REQUIRE(child.input() >= 0);
  REQUIRE(write(child.input(), "hello", 5) == 5);
  CHECK(heard_from(child, 5) == "hello");
  child.close_input();
  CHECK(heard_from(child, 1).empty());
  CHECK(end_of(child) == "exit code 0");
}

TEST_CASE("a child without an input reads its end at once") {
  ChildProcess child({"cat"}, {});
  CHECK(child.input() == -1);
  CHECK(heard_from(child, 1).empty());
  CHECK(end_of(child) == "exit code 0");
}

TEST_CASE("what a child started in groups of its own is ended with it") {
  // setpgid as timeout and interactive shells do it: SIGKILL to the child's group does not reach it.
  ChildProcess child({"python3", "-c",
                      "import os, signal\n"
                      "signal.signal(signal.SIGTERM, signal.SIG_IGN)\n"
                      "pid = os.fork()\n"
                      "if pid == 0: os.setpgid(0, 0)\n"
                      "os.write(1, b'%d\\n' % os.getpid())\n"  // in one piece, whatever buffering is asked for
                      "signal.pause()"},
                     {});
  std::string pids;
  while (std::count(pids.begin(), pids.end(), '\n') < 2) {
    const std::string more = heard_from(child, 1);
    REQUIRE(!more.empty());
    pids += more;
  }
  const std::string first = pids.substr(0, pids.find('\n'));
  const std::string second = pids.substr(pids.find('\n') + 1, pids.size() - pids.find('\n') - 2);
  CHECK(is_running(first));
  CHECK(is_running(second));
  CHECK(child.end(std::chrono::milliseconds(50)) == "signal 9 (Killed)");
  CHECK_FALSE(is_running(first));
  CHECK(wait_until([&] { return !is_running(second); }));
}

TEST_CASE("a child is asked first, and may end by itself") {
  ChildProcess child({"sh", "-c", "trap 'kill $!; echo bye; exit 7' TERM; echo hello; tail -f /dev/null & wait"}, {});
  CHECK(heard_from(child, 6) == "hello\n");
  CHECK(child.end(std::chrono::minutes(10)) == "exit code 7");
}

TEST_CASE("a child whose folder is not there cannot be started") {
  CHECK_THROWS_AS(ChildProcess({"true"}, "/no/such/folder"), DeviceError);
  CHECK_THROWS_AS(ChildProcess({"/no/such/program"}, {}), DeviceError);
  CHECK_THROWS_AS(ChildProcess({}, {}), DeviceError);
}
