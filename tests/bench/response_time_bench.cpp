// How true a response time is: keys written to a pseudo-terminal at known instants, read by the Keyboard's own thread,
// beside a bare loop of read() on another pseudo-terminal in the same run, key by key in turn. The error is the stamp
// less the instant before the write. Unloaded, then with a busy thread on every core.
//
// Usage: response_time_bench [KEYS]   2000 of each, by default
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <pthread.h>
#include <pty.h>
#include <signal.h>
#include <termios.h>
#include <unistd.h>

#include "devices/clock.h"
#include "runner/keys/keyboard.h"

namespace jnd {
namespace {

struct Terminal {
  Terminal() {
    if (openpty(&master, &slave, nullptr, nullptr, nullptr) != 0) {
      std::perror("no pseudo-terminal");
      std::exit(1);
    }
    termios settings{};
    tcgetattr(slave, &settings);
    settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(slave, TCSANOW, &settings);
  }
  int master = -1, slave = -1;
};

struct Stamp {
  std::int64_t written_ns = 0, read_ns = 0;
};

// What a keyboard thread would be without anything else: the floor.
class BareLoop {
 public:
  explicit BareLoop(int descriptor) : descriptor_(descriptor), thread_([this] { run(); }) {}
  ~BareLoop() { thread_.join(); }
  std::int64_t take() {
    std::int64_t stamp = 0;
    while ((stamp = latest_ns_.exchange(0)) == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
    return stamp;
  }

 private:
  void run() {
    const SteadyClock clock;
    char byte = 0;
    while (::read(descriptor_, &byte, 1) == 1) {
      latest_ns_ = clock.now_ns();
      if (byte == 'z') return;
    }
  }
  int descriptor_;
  std::atomic<std::int64_t> latest_ns_{0};
  std::thread thread_;
};

double percentile_us(std::vector<Stamp> stamps, double share) {
  std::vector<double> errors;
  for (const Stamp& stamp : stamps) errors.push_back(static_cast<double>(stamp.read_ns - stamp.written_ns) * 1e-3);
  std::sort(errors.begin(), errors.end());
  return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
}

std::int64_t write_key(int master, char key) {
  const std::int64_t now = SteadyClock().now_ns();
  if (write(master, &key, 1) != 1) std::exit(1);
  return now;
}

void measure(const char* what, Keyboard& keyboard, int keyboard_master, BareLoop& bare, int bare_master, int keys) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> pause_us(500, 4000);
  std::vector<Stamp> ours, floor;
  for (int i = 0; i < keys; ++i) {
    std::this_thread::sleep_for(std::chrono::microseconds(pause_us(random)));
    Stamp stamp{write_key(keyboard_master, 's'), 0};
    std::optional<Key> key;
    while (!key) key = keyboard.press(1);
    stamp.read_ns = key->time_ns;
    ours.push_back(stamp);
    std::this_thread::sleep_for(std::chrono::microseconds(pause_us(random)));
    stamp.written_ns = write_key(bare_master, 's');
    stamp.read_ns = bare.take();
    floor.push_back(stamp);
  }
  fmt::print(
      "{:<10} {:>6} keys   keyboard p50 {:8.1f}  p99 {:8.1f}  max {:9.1f} us   bare read() p50 {:8.1f}  p99 {:8.1f}  "
      "max {:9.1f} us\n",
      what, keys, percentile_us(ours, 0.5), percentile_us(ours, 0.99), percentile_us(ours, 1),
      percentile_us(floor, 0.5), percentile_us(floor, 0.99), percentile_us(floor, 1));
  fmt::print("{:<10} keyboard / bare: p50 {:.2f}, p99 {:.2f}\n", what,
             percentile_us(ours, 0.5) / percentile_us(floor, 0.5),
             percentile_us(ours, 0.99) / percentile_us(floor, 0.99));
}

int run(int keys) {
  const Terminal ours, bare_terminal;
  dup2(ours.slave, STDIN_FILENO);
  Keyboard keyboard;
  BareLoop bare(bare_terminal.slave);
  measure("unloaded", keyboard, ours.master, bare, bare_terminal.master, keys);
  std::atomic<bool> over{false};
  std::vector<std::thread> load;
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  for (unsigned i = 0; i < cores; ++i)
    load.emplace_back([&] {
      volatile std::uint64_t work = 0;
      while (!over) work = work + 1;
    });
  measure("loaded", keyboard, ours.master, bare, bare_terminal.master, keys);
  over = true;
  for (std::thread& thread : load) thread.join();
  write_key(bare_terminal.master, 'z');
  return 0;
}

}  // namespace
}  // namespace jnd

int main(int argc, char** argv) {
  return jnd::run(argc > 1 ? std::max(10, std::atoi(argv[1])) : 2000);
}
