#include "devices/hid/virtual/device_loop.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <exception>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {
// A line longer than this is none of ours; it is thrown away.
constexpr std::size_t kLongestLine = 4096;
}  // namespace

ControlLines::ControlLines(const std::filesystem::path& path) {
  if (path.empty()) {
    fd_ = STDIN_FILENO;
    return;
  }
  own_ = true;
  const bool made = ::mkfifo(path.c_str(), 0600) == 0;
  // For reading and writing: a named pipe then never comes to its end when a writer leaves.
  fd_ = made || errno == EEXIST ? ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;
  if (fd_ < 0)
    throw DeviceError(
        fmt::format("cannot open the control file {}: {}; give --control a path in a folder that you may "
                    "write to, or leave it out to use the standard input",
                    path.string(), std::strerror(errno)));
}

ControlLines::~ControlLines() {
  if (own_ && fd_ >= 0) ::close(fd_);
}

void ControlLines::serve(const std::function<void(std::string_view)>& line) {
  std::array<char, 1024> bytes{};
  const ssize_t count = ::read(fd_, bytes.data(), bytes.size());
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (count <= 0) {
    if (own_) ::close(fd_);
    fd_ = -1;
    if (rest_.find_first_not_of(" \t\r") != std::string::npos) line(rest_);
    return;
  }
  rest_.append(bytes.data(), static_cast<std::size_t>(count));
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = rest_.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string_view whole = std::string_view(rest_).substr(begin, end - begin);
    if (whole.find_first_not_of(" \t\r") != std::string_view::npos) line(whole);
  }
  rest_.erase(0, begin);
  if (rest_.size() > kLongestLine) rest_.clear();
}

namespace {

constexpr std::int64_t kMostBehind = 50;
constexpr std::int64_t kLongestWait_ns = 1'000'000'000;
// Reports taken in one go, so that a host that floods the device cannot stop its steps.
constexpr int kMostReports = 32;

std::int64_t ns_of_ms(double milliseconds) {
  return std::llround(1e6 * milliseconds);
}

}  // namespace

DeviceLoop::DeviceLoop(VirtualDevice& device, DevicePort& port, FaultScript& script, ControlLines& control,
                       EventLog& log)
    : device_(device),
      port_(port),
      script_(script),
      control_(control),
      log_(log),
      start_ns_(monotonic_ns()),
      clock_(start_ns_),
      next_ns_(device.period_ns()) {}

void DeviceLoop::run() {
  plug();
  if (const std::string where = port_.where(); !where.empty()) {
    fmt::print("{} is served at {}\n", device_.description().serial, where);
    (void)std::fflush(stdout);
  }
  while (!quits_ && !port_.is_over()) {
    orders(monotonic_ns());
    steps();
    wait();
  }
  unplug();
}

void DeviceLoop::plug() {
  back_ns_.reset();
  device_.plugged(true);
  port_.plug(device_.description());
  log_.write("plugged", "");
}

void DeviceLoop::unplug() {
  if (!port_.plugged()) return;
  port_.unplug();
  device_.plugged(false);
  log_.write("unplugged", device_.status());
}

void DeviceLoop::pass_on(const DeviceOrder& order) {
  if (!device_.obey(order)) fmt::print(stderr, "jnd-virtual-device: this device cannot do that: {}\n", order.words);
}

void DeviceLoop::obey(const DeviceOrder& order, std::int64_t now_ns) {
  if (order.kind != OrderKind::status) log_.write("order", fmt::format("\"words\":{}", json_text(order.words)));
  switch (order.kind) {
    case OrderKind::unplug:
      unplug();
      if (order.amount > 0) back_ns_ = now_ns + ns_of_ms(order.amount);
      break;
    case OrderKind::freeze:
      frozen_until_ns_ = now_ns + ns_of_ms(order.amount);
      break;
    case OrderKind::slow_clock:
      clock_.slow(order.amount, now_ns);
      break;
    case OrderKind::offset:
      device_.jump(std::llround(1e9 * order.amount));
      break;
    case OrderKind::press:
      pass_on(parse_order(fmt::format("button {} on", order.button)));
      script_.add({.at_ns = now_ns - start_ns_ + ns_of_ms(order.amount),
                   .order = parse_order(fmt::format("button {} off", order.button))});
      break;
    case OrderKind::status:
      fmt::print("{}\n", status());
      (void)std::fflush(stdout);
      break;
    case OrderKind::quit:
      quits_ = true;
      break;
    default:
      pass_on(order);
  }
}

void DeviceLoop::orders(std::int64_t now_ns) {
  if (back_ns_ && *back_ns_ <= now_ns) plug();
  while (const std::optional<DeviceOrder> order = script_.take(now_ns - start_ns_)) obey(*order, now_ns);
}

bool DeviceLoop::serve_port(std::int64_t now_ns) {
  // While steps are late a report arrives, by the device's timer, before the next of them.
  const std::int64_t arrival_ns = std::clamp(clock_.timer_ns(now_ns), next_ns_ - device_.period_ns(), next_ns_);
  return port_.serve([&](std::span<const std::uint8_t> report) { device_.receive(report, arrival_ns); });
}

void DeviceLoop::steps() {
  const std::int64_t period_ns = device_.period_ns();
  const std::int64_t behind = (clock_.timer_ns(monotonic_ns()) - next_ns_) / period_ns;
  if (behind > kMostBehind) {
    skipped_ += behind - kMostBehind;
    log_.write("skipped", fmt::format("\"steps\":{}", behind - kMostBehind));
    next_ns_ += (behind - kMostBehind) * period_ns;
  }
  std::int64_t now_ns = monotonic_ns();
  for (bool late = false; clock_.real_ns(next_ns_) <= now_ns; late = true, now_ns = monotonic_ns()) {
    const bool frozen = now_ns < frozen_until_ns_;
    if (late && !frozen) (void)serve_port(now_ns);
    device_.step(next_ns_, frozen);
    next_ns_ += period_ns;
  }
}

// Until the next step, order or plug; output reports and control lines are handled on the way.
void DeviceLoop::wait() {
  const std::int64_t now_ns = monotonic_ns();
  std::int64_t until_ns = std::min(clock_.real_ns(next_ns_), now_ns + kLongestWait_ns);
  if (const std::optional<std::int64_t> order_ns = script_.next_ns())
    until_ns = std::min(until_ns, start_ns_ + *order_ns);
  if (back_ns_) until_ns = std::min(until_ns, *back_ns_);
  const std::int64_t rest_ns = std::max<std::int64_t>(until_ns - now_ns, 0);
  const timespec rest{.tv_sec = rest_ns / 1'000'000'000, .tv_nsec = rest_ns % 1'000'000'000};
  // A device whose processor stands still takes no reports: they wait in the kernel.
  const bool frozen = now_ns < frozen_until_ns_;
  std::array<pollfd, 2> watched = {{{.fd = frozen ? -1 : port_.fd(), .events = POLLIN, .revents = 0},
                                    {.fd = control_.fd(), .events = POLLIN, .revents = 0}}};
  if (::ppoll(watched.data(), watched.size(), &rest, nullptr) <= 0) return;
  if (watched[0].revents != 0)
    for (int taken = 0; taken < kMostReports && serve_port(monotonic_ns());) ++taken;
  if (watched[1].revents == 0) return;
  control_.serve([&](std::string_view line) {
    try {
      obey(parse_order(line), monotonic_ns());
    } catch (const InputError& error) {
      fmt::print(stderr, "jnd-virtual-device: {}\n", error.what());
    }
  });
}

std::string DeviceLoop::status() const {
  const std::int64_t now_ns = monotonic_ns();
  return fmt::format("{{\"time_s\":{}.{:09},\"plugged\":{},\"open\":{},\"frozen\":{},\"skipped\":{},{}}}",
                     now_ns / 1'000'000'000, now_ns % 1'000'000'000, port_.plugged(), port_.opened(),
                     now_ns < frozen_until_ns_, skipped_, device_.status());
}

}  // namespace jnd
