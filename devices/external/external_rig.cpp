#include "devices/external/external_rig.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "devices/external/rig_line.h"
#include "devices/machine/io_thread.h"
#include "protocols/version.h"

namespace jnd {

namespace {

constexpr int kLookAt_ms = 3;                         // the stop latch, `alive`, time-outs
constexpr std::int64_t kStartGap_ns = 1'000'000'000;  // a run that is shorter is followed by a wait
constexpr int kMostGaps = 5;
constexpr std::chrono::milliseconds kFaultGrace{300};
constexpr std::int64_t kRenderLook_ns = 50'000'000;
constexpr std::int64_t kAskEvery_ns = 50'000'000;  // whether it is enough
constexpr int kPause_ms = 50;
constexpr int kMostReads = 4;  // of 64 KiB, before it is looked at what is due

}  // namespace

Fault fault_of(RigFailure failure) noexcept {
  switch (failure) {
    case RigFailure::no_contact:
      return Fault::no_contact;
    case RigFailure::stopped:
      return Fault::interrupted;
    case RigFailure::rig_fault:
    case RigFailure::refused_done:
    case RigFailure::time_out:
    case RigFailure::not_ready:
    case RigFailure::not_stopped:
      return Fault::device_fault;
    case RigFailure::silent:
      return Fault::stale_reading;
    case RigFailure::babbling:
    case RigFailure::no_hello:
    case RigFailure::ended:
      break;
  }
  return Fault::device_lost;
}

Presentation presentation_of(const Rendered& rendered, StopSource stopped_by) {
  Presentation presentation;
  if (rendered.voided) {
    presentation.fault = fault_of(rendered.voided->failure);
    if (presentation.fault == Fault::interrupted && stopped_by != StopSource::none) {
      presentation.fault = Fault::emergency_stop;
      presentation.stopped_by = to_string(stopped_by);
    }
  }
  if (rendered.done) {
    presentation.first_contact_s = rendered.done->first_contact_s.value_or(-1);
    presentation.duration_s = rendered.done->duration_s;
  }
  return presentation;
}

ExternalRig::ExternalRig(ExternalSettings settings, const Clock& clock, const EmergencyStop& stop)
    : settings_(std::move(settings)),
      source_(in_words(settings_)),
      clock_(clock),
      stop_(stop),
      exchange_(kVersion, settings_.time_outs, settings_.token),
      trouble_(fmt::format("{} has not been started yet", source_)),
      sealed_(trouble_),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (wake_ < 0) throw DeviceError(fmt::format("no eventfd can be made: {}", std::strerror(errno)));
  thread_ = start_io_thread([this] { serve(); }, 0);
}

ExternalRig::~ExternalRig() {
  {
    const std::lock_guard lock(mutex_);
    leave_ = true;
  }
  (void)eventfd_write(wake_, 1);
  thread_.join();
  close(wake_);
}

bool ExternalRig::await_hello(double time_out_s) const {
  std::unique_lock lock(mutex_);
  const auto there = [&] { return exchange_.greeted() && !exchange_.lost(); };
  const auto decided = [&] { return there() || (failed_starts_ > 0 && !is_trying_); };
  news_.wait_for(lock, std::chrono::duration<double>(time_out_s), decided);
  return there();
}

std::optional<RigHello> ExternalRig::hello() const {
  const std::lock_guard lock(mutex_);
  return exchange_.hello();
}

std::string ExternalRig::missing() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

std::string ExternalRig::missing_sealed() const {
  const std::lock_guard lock(mutex_);
  return trouble_.empty() ? std::string() : sealed_;
}

ExternalReport ExternalRig::report() const {
  const std::lock_guard lock(mutex_);
  return {.hello = exchange_.hello(),
          .source = source_,
          .connected = trouble_.empty(),
          .trouble = trouble_,
          .starts = starts_,
          .traffic = exchange_.traffic(),
          .refused = {exchange_.refused_lines().begin(), exchange_.refused_lines().end()}};
}

std::uint64_t ExternalRig::prepare(const RenderRequest& request, std::string& why) {
  std::uint64_t id = 0;
  {
    const std::lock_guard lock(mutex_);
    if (!trouble_.empty())
      why = trouble_;
    else if (stop_.latched())
      why = "the emergency stop is latched";
    else
      id = exchange_.prepare(request, clock_.now_ns(), why);
  }
  (void)eventfd_write(wake_, 1);
  return id;
}

bool ExternalRig::present(std::uint64_t id) {
  bool presents = false;
  {
    const std::lock_guard lock(mutex_);
    presents = !stop_.latched() && exchange_.present(id, clock_.now_ns());
  }
  (void)eventfd_write(wake_, 1);
  return presents;
}

std::uint64_t ExternalRig::ask(const std::vector<std::string>& answers) {
  std::uint64_t id = 0;
  {
    const std::lock_guard lock(mutex_);
    id = exchange_.ask(answers, clock_.now_ns());
  }
  (void)eventfd_write(wake_, 1);
  return id;
}

void ExternalRig::stop_with(RigStop reason) {
  {
    const std::lock_guard lock(mutex_);
    exchange_.stop(reason, clock_.now_ns());
  }
  (void)eventfd_write(wake_, 1);
}

std::vector<RigEvent> ExternalRig::wait(std::int64_t until_ns) {
  std::unique_lock lock(mutex_);
  const auto patience = std::chrono::nanoseconds(std::max<std::int64_t>(until_ns - clock_.now_ns(), 0));
  news_.wait_for(lock, patience, [&] { return exchange_.has_events(); });
  return exchange_.take_events();
}

Rendered ExternalRig::render(const RenderRequest& request, const std::function<void(const RigEvent&)>& hear,
                             const std::function<bool()>& enough) {
  (void)wait(0);  // what came before is not of this presentation
  std::string why;
  const std::uint64_t id = prepare(request, why);
  if (id != 0) return follow(id, false, hear, enough);
  return {.done = {},
          .voided = RigVoid{0, stop_.latched() ? RigFailure::stopped : RigFailure::ended, why},
          .telemetry = {},
          .contacts = {}};
}

Rendered ExternalRig::render_prepared(std::uint64_t id, const std::function<void(const RigEvent&)>& hear,
                                      const std::function<bool()>& enough) {
  Rendered rendered;
  bool ready = false;
  {
    std::unique_lock lock(mutex_);
    news_.wait_for(lock, std::chrono::duration<double>(settings_.time_outs.late_s),
                   [&] { return exchange_.is_ready(id) || !exchange_.prepares(id); });
    ready = exchange_.is_ready(id);
    if (!ready) {
      exchange_.give_up(id, clock_.now_ns());
      rendered.voided = RigVoid{id, RigFailure::ended, "it is not ready any more"};
    }
    for (const RigEvent& event : exchange_.take_events())  // of the time before it
      if (const auto* voided = std::get_if<RigVoid>(&event.what); voided != nullptr && voided->id == id)
        rendered.voided = *voided;
  }
  (void)eventfd_write(wake_, 1);
  if (ready) {
    if (!present(id)) stop_with(RigStop::interrupted);
    return follow(id, true, hear, enough);
  }
  await_rest();
  return rendered;
}

// To its end; presents: it was told to, otherwise it is as soon as it is ready.
Rendered ExternalRig::follow(std::uint64_t id, bool presents, const std::function<void(const RigEvent&)>& hear,
                             const std::function<bool()>& enough) {
  Rendered rendered;
  bool ends = false;
  std::int64_t asked_ns = clock_.now_ns();
  while (!rendered.done && !rendered.voided) {
    if (enough && !ends && clock_.now_ns() - asked_ns >= kAskEvery_ns) {
      asked_ns = clock_.now_ns();
      ends = enough();
      if (ends) stop_with(RigStop::enough);
    }
    for (const RigEvent& event : wait(clock_.now_ns() + kRenderLook_ns)) {
      if (const auto* ready = std::get_if<RigReady>(&event.what); !presents && ready != nullptr && ready->id == id) {
        presents = present(id);
        if (!presents) stop_with(RigStop::interrupted);
      }
      if (!presents && std::holds_alternative<RigTelemetry>(event.what)) continue;  // of the time before it
      if (hear) hear(event);
      if (const auto* contact = std::get_if<RigContact>(&event.what)) rendered.contacts.push_back(*contact);
      if (const auto* telemetry = std::get_if<RigTelemetry>(&event.what)) rendered.telemetry.push_back(*telemetry);
      if (const auto* done = std::get_if<RigDone>(&event.what); done != nullptr && done->id == id)
        rendered.done = *done;
      if (const auto* voided = std::get_if<RigVoid>(&event.what); voided != nullptr && voided->id == id)
        rendered.voided = *voided;
    }
  }
  await_rest();  // it may have been stopped: the next presentation begins when it has said `done`, or is lost
  return rendered;
}

void ExternalRig::let_go() {
  stop_with(RigStop::interrupted);
  await_rest();
}

void ExternalRig::await_rest() {
  std::unique_lock lock(mutex_);
  news_.wait(lock, [&] { return !exchange_.engaged(); });
}

bool ExternalRig::prepares(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  return exchange_.prepares(id);
}

bool ExternalRig::leaving() const {
  const std::lock_guard lock(mutex_);
  return leave_;
}

// How often it was tried belongs to the message: a rig that cannot be started again is not waited for in silence.
void ExternalRig::say(const std::string& trouble, const std::string& sealed) {
  {
    const std::lock_guard lock(mutex_);
    const std::string starts =
        failed_starts_ > 1 ? fmt::format("; it could not be started {} times", failed_starts_) : std::string();
    trouble_ = source_ + trouble + starts;
    sealed_ = source_ + sealed + starts;
  }
  news_.notify_all();
}

// False once the thread is to end.
bool ExternalRig::pause_until(std::int64_t until_ns) const {
  while (!leaving()) {
    const std::int64_t left_ns = until_ns - clock_.now_ns();
    if (left_ns <= 0) return true;
    pollfd file{wake_, POLLIN, 0};
    (void)poll(&file, 1, static_cast<int>(std::min<std::int64_t>(left_ns / 1'000'000 + 1, kPause_ms)));
    eventfd_t count = 0;
    (void)eventfd_read(wake_, &count);
  }
  return false;
}

void ExternalRig::serve() noexcept {
  int short_runs = 0;  // in a row
  while (!leaving()) {
    const std::int64_t started_ns = clock_.now_ns();
    serve_once();
    short_runs = clock_.now_ns() - started_ns < kStartGap_ns ? short_runs + 1 : 0;
    if (!pause_until(started_ns + std::clamp(short_runs - 1, 0, kMostGaps) * kStartGap_ns)) return;
  }
}

// One run of the rig, from start to end.
void ExternalRig::serve_once() {
  {
    const std::lock_guard lock(mutex_);
    ++starts_;
    ++failed_starts_;  // until it says hello
    is_trying_ = true;
  }
  try {
    RigConnection connection(settings_);
    {
      const std::lock_guard lock(mutex_);
      exchange_.begin(clock_.now_ns());
    }
    converse(connection);
    part(connection);
  } catch (const DeviceError& error) {
    const std::string trouble =
        fmt::format(" {}: correct \"external\" in the rig file, or start the rig", error.what());
    say(trouble, trouble);
  }
  {
    const std::lock_guard lock(mutex_);
    is_trying_ = false;
  }
  news_.notify_all();
}

// Until the rig is lost, or this is to end.
void ExternalRig::converse(RigConnection& connection) {
  while (true) {
    connection.wait(wake_, kLookAt_ms);
    eventfd_t count = 0;
    (void)eventfd_read(wake_, &count);
    std::string output;
    {
      const std::lock_guard lock(mutex_);
      hear_all(connection);
      settle();
      output = exchange_.take_output();
    }
    news_.notify_all();
    const bool written = connection.write(output);
    const std::lock_guard lock(mutex_);
    if (!written) exchange_.end(RigFailure::ended, "it closed its input", clock_.now_ns());
    if (exchange_.lost() || leave_) return;
  }
}

// What has come is heard before anything is found to be missing: up to 256 KiB, as much as a flood may take.
void ExternalRig::hear_all(RigConnection& connection) {
  const auto hear = [&](std::string_view line) { exchange_.hear(line, clock_.now_ns()); };
  const auto too_long = [&](std::string_view line) { exchange_.hear_too_long(line, clock_.now_ns()); };
  int reads = 0;
  while (reads < kMostReads && connection.read(hear, too_long)) ++reads;
  if (!connection.is_open()) exchange_.end(RigFailure::ended, "it closed its output", clock_.now_ns());
}

void ExternalRig::settle() {
  pass_on_stop();
  exchange_.tick(clock_.now_ns());
  if (!exchange_.greeted() || exchange_.lost()) return;
  trouble_.clear();
  failed_starts_ = 0;
}

// Ends the rig, and says why.
void ExternalRig::part(RigConnection& connection) {
  std::string why, sealed, last_words;
  {
    const std::lock_guard lock(mutex_);
    exchange_.bye();
    last_words = exchange_.take_output();
    if (exchange_.lost()) {
      why = exchange_.lost()->words;
      sealed = exchange_.lost()->sealed;
    }
  }
  (void)connection.write(last_words);
  if (why.empty()) {
    connection.close_input();
    (void)connection.leave(std::chrono::milliseconds(std::llround(1000 * settings_.time_outs.bye_s)));
    (void)connection.end(kFaultGrace);
    return;
  }
  say(": " + why, ": " + sealed);  // ending it takes a while
  const std::string how = connection.end(kFaultGrace);
  say(fmt::format(": {} ({}){}{}", why, how,
                  connection.last_error().empty() ? "" : ", and it said last: ", connection.last_error()),
      fmt::format(": {} ({})", sealed, how));
}

// The latch may be set by a signal handler, which can do no more.
void ExternalRig::pass_on_stop() {
  const bool latched = stop_.latched();
  if (latched && !stop_passed_on_) exchange_.stop(RigStop::emergency, clock_.now_ns());
  stop_passed_on_ = latched;
}

}  // namespace jnd
