// A rig of your own in C++17, to start from where the device is driven at 1 kHz: put your haptic library's calls in place
// of Device, your ranges in kHello, and keep the rest. What each message means is in ../PROTOCOL.md. It needs
// nlohmann/json and nothing of jnd (-fno-ipa-modref: g++ below 14.2 gives wrong code without it, GCC bug 114207):
//
//   g++ -std=c++17 -O2 -fno-ipa-modref rig_loop.cpp -o rig_loop
//   jnd device test external --command ./rig_loop
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <optional>
#include <string>
#include <thread>

#include <nlohmann/json.hpp>
#include <poll.h>
#include <unistd.h>

using nlohmann::json;
using Clock = std::chrono::steady_clock;

namespace {

const json kHello = {{"type", "hello"},
                     {"protocol", 1},
                     {"name", "Loop rig"},
                     {"version", "1.0"},
                     {"serial", "none"},
                     {"model", true},
                     {"answers", false},
                     {"ready_s", 0},  // the longest that prepare() takes, and a little more
                     {"quantities", {{{"name", "stiffness"}, {"unit", "N/m"}, {"min", 50}, {"max", 900}}}},
                     {"parameters", {{{"name", "damping"}, {"unit", "N s/m"}, {"min", 0}, {"max", 5}}}},
                     {"measures", {{{"name", "force"}, {"unit", "N"}}, {{"name", "depth"}, {"unit", "m"}}}}};
constexpr std::chrono::microseconds kPeriod{1000};
constexpr double kSilence_s = 0.1;  // of jnd: then there is no force

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Your hardware. This one is a model, and kHello says so: a finger that goes 4 mm into a wall, once a second.
class Device {
 public:
  // Gets ready, and nobody feels it: here a motor moves to its place, in a thread of its own if it takes a while.
  void prepare(const json& /*request*/) {}
  bool is_ready() const { return true; }
  double depth_m(double elapsed_s) const { return std::max(0.0, -0.004 * std::cos(2 * M_PI * elapsed_s)); }
  void push(double force_n) { force_n_ = force_n; }
  double measured_force_n() const { return force_n_; }
  void off() { force_n_ = 0; }  // at once; called often

 private:
  double force_n_ = 0;
};

void say(const json& message) {
  std::cout << message.dump() << '\n' << std::flush;
}

// Why this cannot be presented; empty: it can. jnd asks for nothing beyond kHello; a rig looks all the same.
std::string problem(const json& request) {
  json given = request.at("parameters");
  given[request.at("quantity").get<std::string>()] = request.at("value");
  for (const char* list : {"quantities", "parameters"})
    for (const json& item : kHello.at(list)) {
      const std::string name = item.at("name");
      const json value = given.value(name, json());
      if (!value.is_number() || value < item.at("min") || value > item.at("max"))
        return name + " cannot be " + value.dump();
    }
  return {};
}

class Presentation {
 public:
  explicit Presentation(const json& request)
      : id_(request.at("id")),
        stiffness_(request.at("value")),
        damping_(request.at("parameters").at("damping")),
        how_(request.at("exploration")) {}

  std::uint64_t id() const { return id_; }

  // One tick of the loop. Returns how it ended, or nothing.
  std::optional<std::string> tick(Device& device) {
    const double now_s = seconds_since(began_), depth_m = device.depth_m(now_s);
    const double speed = (depth_m - depth_m_) / std::chrono::duration<double>(kPeriod).count();
    device.push(depth_m > 0 ? std::max(0.0, stiffness_ * depth_m + damping_ * speed) : 0);
    if (depth_m > 0 && depth_m_ <= 0) {
      ++contacts_;
      if (!first_s_) first_s_ = now_s;
      say({{"type", "contact"}, {"id", id_}, {"time_s", now_s}});
    }
    depth_m_ = depth_m;
    peak_depth_m_ = std::max(peak_depth_m_, depth_m);
    peak_force_n_ = std::max(peak_force_n_, device.measured_force_n());
    fit_fx_ += device.measured_force_n() * depth_m;
    fit_xx_ += depth_m * depth_m;
    return ending(now_s);
  }

  void done(Device& device, const std::string& outcome) const {
    device.off();
    json message = {{"type", "done"},        {"id", id_},
                    {"outcome", outcome},    {"duration_s", seconds_since(began_)},
                    {"contacts", contacts_}, {"peaks", {{"force", peak_force_n_}, {"depth", peak_depth_m_}}}};
    if (first_s_) message["first_contact_s"] = *first_s_;
    if (fit_xx_ > 0) message["delivered"] = fit_fx_ / fit_xx_;  // the slope that was measured, not what was asked for
    say(message);
  }

 private:
  std::optional<std::string> ending(double now_s) const {
    if (!first_s_ && how_.contains("no_contact_s") && now_s > how_.at("no_contact_s")) return "no_contact";
    const std::string ends = how_.at("ends");
    const int ended = depth_m_ > 0 ? contacts_ - 1 : contacts_;
    if (ends == "contacts" && ended >= how_.at("contacts")) return "complete";
    if (ends != "time") return std::nullopt;
    const bool from_start = how_.at("from") == "start";
    if (!from_start && !first_s_) return std::nullopt;
    if (now_s - (from_start ? 0 : *first_s_) < how_.at("duration_s")) return std::nullopt;
    return "complete";
  }

  std::uint64_t id_;
  double stiffness_, damping_;
  json how_;
  Clock::time_point began_ = Clock::now();
  std::optional<double> first_s_;
  int contacts_ = 0;
  double depth_m_ = 0, peak_depth_m_ = 0, peak_force_n_ = 0, fit_fx_ = 0, fit_xx_ = 0;
};

class Rig {
 public:
  void run() {
    for (auto next = Clock::now(); !over_; std::this_thread::sleep_until(next += kPeriod)) {
      listen();
      if (waits_ && device_.is_ready()) {
        say({{"type", "ready"}, {"id", prepared_->id()}});
        waits_ = false;
      }
      if (!going_) continue;
      if (seconds_since(heard_) > kSilence_s) {
        device_.off();
        say({{"type", "fault"}, {"id", going_->id()}, {"cause", "jnd has fallen silent"}});
        going_.reset();
      } else if (const auto outcome = going_->tick(device_)) {
        going_->done(device_, *outcome);
        going_.reset();
      }
    }
    device_.off();
  }

 private:
  // What has come, without waiting.
  void listen() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    char bytes[4096];
    while (!over_ && poll(&input, 1, 0) > 0) {
      const ssize_t count = read(STDIN_FILENO, bytes, sizeof bytes);
      over_ = count <= 0;  // jnd is gone
      if (over_) return;
      heard_ = Clock::now();
      text_.append(bytes, static_cast<std::size_t>(count));
      for (std::size_t end = 0; (end = text_.find('\n')) != std::string::npos; text_.erase(0, end + 1))
        hear(json::parse(text_.substr(0, end)));
    }
  }

  void hear(const json& message) {
    const std::string type = message.at("type");
    if (type == "hello") say(kHello);
    if (type == "alive") say({{"type", "alive"}, {"n", message.at("n")}});
    if (type == "prepare" || type == "present") begin(message, type == "present");
    if (type == "stop") stop(message.at("reason") == "enough");
    if (type == "bye") over_ = true;
    // Anything else is of a later version of jnd: it passes.
  }

  void begin(const json& request, bool present) {
    const std::string why = going_ ? "busy" : problem(request);
    if (!why.empty()) {
      say({{"type", "fault"}, {"id", request.at("id")}, {"cause", why}});
    } else if (present) {
      prepared_.reset();
      waits_ = false;
      going_.emplace(request);
    } else {
      device_.prepare(request);
      prepared_.emplace(request);
      waits_ = true;
    }
  }

  void stop(bool enough) {
    device_.off();
    if (going_)
      going_->done(device_, enough ? "complete" : "stopped");
    else if (prepared_)
      prepared_->done(device_, "stopped");
    going_.reset();
    prepared_.reset();
    waits_ = false;
  }

  Device device_;
  std::optional<Presentation> going_, prepared_;
  Clock::time_point heard_ = Clock::now();
  std::string text_;
  bool waits_ = false;  // to say that it is ready
  bool over_ = false;
};

}  // namespace

int main() {
  try {
    Rig().run();
  } catch (const std::exception& error) {
    std::cerr << "rig_loop: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
