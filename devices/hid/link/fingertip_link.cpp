#include "devices/hid/link/fingertip_link.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/device_fit.h"
#include "devices/hid/our_devices.h"
#include "devices/hid/page_exchange.h"
#include "devices/hid/report_words.h"
#include "devices/machine/io_thread.h"

namespace jnd {

namespace {

// By then a device has heard of an engagement and is active, unless it takes no commands, or has a cause to stop that
// stays.
constexpr std::int64_t kLongestSilence_ns = 100'000'000;

}  // namespace

FingertipLink::FingertipLink(HidBus& bus, LinkTarget target, const Clock& clock, int realtime_priority)
    : bus_(bus), target_(std::move(target)), clock_(clock) {
  described_.serial = target_.serial;
  described_.finger = target_.finger;
  described_.trouble = "not connected";
  writer_ = start_io_thread([this] { write_commands(); }, realtime_priority);
  reader_ = std::make_unique<HidReader>(
      bus_, [this](const HidInfo& info) { return wanted(info); }, static_cast<HidListener&>(*this), realtime_priority,
      &clock_);
}

FingertipLink::~FingertipLink() {
  reader_.reset();
  ends_.store(true);
  wake();
  writer_.join();
}

// A device without a serial number on the bus has it in its identity page only.
bool FingertipLink::wanted(const HidInfo& info) const {
  return is_fingertip(info) && (info.serial.empty() || info.serial == target_.serial);
}

// -- the loop's part
// ----------------------------------------------------------------------------------------------------

void FingertipLink::wake() noexcept {
  wake_.fetch_add(1, std::memory_order_release);
  wake_.notify_one();
}

void FingertipLink::post(const jnd_command& command) noexcept {
  ++posting_.number;
  posting_.command = command;
  posted_.put(posting_);
  wake();
}

std::uint32_t FingertipLink::engage() noexcept {
  ++posting_.engagement;
  post(jnd_command{});
  return posting_.engagement;
}

void FingertipLink::send(const jnd_command& command) noexcept {
  post(command);
}

// -- the reader's part
// --------------------------------------------------------------------------------------------------

void FingertipLink::assign(std::uint32_t connection, const std::string& path) {
  {
    const std::lock_guard lock(mutex_);
    path_ = path;
    assigned_.store(connection);
  }
  wake();
}

void FingertipLink::connected(const HidInfo& info, HidHandle& handle) {
  const std::string name = fmt::format("device {} for the {} finger", target_.serial, target_.finger);
  PageExchange pages(handle, name);
  const jnd_identity identity = pages.identity();
  if (const std::string serial = serial_of(identity); serial != target_.serial)
    throw DeviceError(fmt::format("{} is device {}, not {}", info.path, serial, target_.serial));
  if (identity.finger != JND_FINGER_ANY && finger_word(identity.finger) != target_.finger)
    throw DeviceError(fmt::format("{} is made for the {} finger: wear it there, or name another device in the rig file",
                                  name, finger_word(identity.finger)));
  const jnd_limits limits = pages.limits();
  (void)pages.geometry();  // refused where it cannot be that of a platform
  const jnd_certificate certificate = pages.certificate();
  if (const std::string short_of = shortcomings(target_.spec, target_.damps, identity, limits); !short_of.empty())
    throw DeviceError(
        fmt::format("{} cannot do what this protocol was checked against ({}): {}. Use another device, or a "
                    "description of the rig with its limits",
                    name, target_.spec.name, short_of));
  ++connections_;
  last_echo_ = 0;
  {
    const std::lock_guard lock(mutex_);
    DeviceLinkReport& now = described_;
    now.firmware = firmware_text(identity);
    now.protocol_version = JND_PROTOCOL_VERSION;
    now.calibration_id = calibration_id_of(certificate);
    now.calibration_date = date_text(certificate.date);
    now.is_model = (identity.capabilities & JND_IS_MODEL) != 0;
    now.reconnections = static_cast<int>(connections_) - 1;
    now.trouble.clear();
    write_trouble_.clear();
    stop_faults_ = 0;
    rejected_now_ = 0;
    counter_.begin();
    sync_.begin();
  }
  assign(connections_, info.path);
}

void FingertipLink::report(std::span<const std::uint8_t> bytes, std::int64_t time_ns) noexcept {
  jnd_telemetry telemetry{};
  const jnd_decode_result result = jnd_decode_telemetry(bytes.data(), bytes.size(), &telemetry);
  // Answers to another program's requests are none of ours, and no damage.
  jnd_answer answer{};
  if (result == JND_DECODE_ID && jnd_decode_answer(bytes.data(), bytes.size(), &answer) == JND_DECODE_OK) return;
  if (result == JND_DECODE_OK) {
    take(telemetry, time_ns);
    return;
  }
  const std::lock_guard lock(mutex_);
  ++damaged_;
}

void FingertipLink::take(const jnd_telemetry& telemetry, std::int64_t time_ns) noexcept {
  LinkTelemetry shown;
  shown.telemetry = telemetry;
  shown.connection = connections_;
  // A person's word, and before the loop can see that the device stopped: what follows is an emergency stop.
  if ((telemetry.faults & JND_FAULT_BUTTON) != 0)
    if (EmergencyStop* stop = stop_.load()) stop->latch(StopSource::button);
  const std::uint64_t engaged = engaged_.load(std::memory_order_acquire);
  const auto first = static_cast<std::uint32_t>(engaged);
  shown.engagement = static_cast<std::uint32_t>(engaged >> 32U);
  if (static_cast<std::int32_t>(telemetry.command_sequence - first) < 0) --shown.engagement;
  {
    const std::lock_guard lock(mutex_);
    if (!counter_.take(telemetry.sequence)) return;
    std::int64_t written_ns = 0;
    if (telemetry.command_sequence != last_echo_ && telemetry.command_age_us != JND_COMMAND_AGE_NONE &&
        written_.find(telemetry.command_sequence, written_ns)) {
      latency_.add(time_ns - written_ns);
      sync_.add_round_trip(written_ns, telemetry.time_us - telemetry.command_age_us, telemetry.time_us, time_ns);
    } else {
      sync_.add_arrival(telemetry.time_us, time_ns);
    }
    last_echo_ = telemetry.command_sequence;
    shown.time_ns = sync_.to_host_ns(telemetry.time_us);
    rejected_now_ = telemetry.rejected;
    if (telemetry.faults != 0) stop_faults_ = telemetry.faults;
  }
  newest_.put(shown);
  faults_.store(telemetry.faults);
  if (ready_.load(std::memory_order_relaxed) != connections_ && writing_.load() == connections_)
    ready_.store(connections_, std::memory_order_release);
}

void FingertipLink::lost(const std::string& why) {
  ready_.store(0, std::memory_order_release);
  assign(0, {});
  const std::lock_guard lock(mutex_);
  described_.trouble = why;
}

// -- for the log
// --------------------------------------------------------------------------------------------------------

DeviceLinkReport FingertipLink::report() const {
  const std::lock_guard lock(mutex_);
  DeviceLinkReport now = described_;
  now.connected = connection() > 0;
  if (now.trouble.empty()) now.trouble = write_trouble_;
  if (now.trouble.empty() && stop_faults_ != 0) now.trouble = "it stopped itself: " + fault_words(stop_faults_);
  now.sent = sent_.load();
  now.overtaken = overwritten();
  now.received = counter_.taken();
  now.missing = counter_.missing();
  now.damaged = damaged_ + counter_.old();
  now.rejected = rejected_now_;
  now.clock_offset_s = sync_.offset_s();
  now.clock_drift_ppm = sync_.drift_ppm();
  now.clock_uncertainty_s = sync_.uncertainty_s();
  now.latency_p50_us = latency_.percentile_us(0.50);
  now.latency_p99_us = latency_.percentile_us(0.99);
  now.latency_max_us = latency_.largest_us();
  return now;
}

std::string FingertipLink::missing() const {
  if (connection() > 0) {
    const unsigned faults = faults_.load();
    if (faults == 0) return {};
    return fmt::format("device {} for the {} finger has a fault ({})", target_.serial, target_.finger,
                       fault_words(faults));
  }
  const std::lock_guard lock(mutex_);
  const std::string why = described_.trouble.empty() ? write_trouble_ : described_.trouble;
  return fmt::format("device {} for the {} finger is not there{}", target_.serial, target_.finger,
                     why.empty() || why == "not connected" ? "" : " (" + why + ")");
}

int FingertipLink::clock_steps() const {
  const std::lock_guard lock(mutex_);
  return sync_.steps();
}

// The thread of a FingertipLink that writes.

namespace {

// Commands of mode rest after a connection: they begin the numbering anew, leave the device at rest after any former
// use, and their echoes tell how its clock runs.
constexpr int kFirstCommands = 20;
constexpr std::chrono::milliseconds kBetweenFirst{2};

}  // namespace

// What one connection is written to with. Lives in the writer's thread only.
class FingertipLink::Writer {
 public:
  explicit Writer(FingertipLink& link) noexcept : link_(link) {}

  void connect(std::uint32_t connection) {
    handle_.reset();
    connection_ = connection;
    sequence_ = 0;
    engagement_ = 0;
    link_.written_.clear();
    if (connection == 0) return;
    std::string path;
    {
      const std::lock_guard lock(link_.mutex_);
      path = link_.path_;
    }
    try {
      handle_ = link_.bus_.open(path);
    } catch (const DeviceError& error) {  // gone already: the reader will see that too
      const std::lock_guard lock(link_.mutex_);
      link_.write_trouble_ = error.what();
      return;
    }
    // No telemetry before it is of an engagement.
    link_.engaged_.store(1, std::memory_order_release);
    for (int i = 0; i < kFirstCommands && current(); ++i) {
      write(jnd_command{});
      std::this_thread::sleep_for(kBetweenFirst);
    }
    if (current()) link_.writing_.store(connection);
  }

  void write(const PostedCommand& posted) {
    if (!handle_) return;
    if (posted.engagement != engagement_) {
      engagement_ = posted.engagement;
      link_.engaged_.store(std::uint64_t{engagement_} << 32U | (sequence_ + 1U), std::memory_order_release);
      if (posted.command.mode != JND_MODE_REST) write(jnd_command{});
    }
    write(posted.command);
  }

  // Whatever was commanded last, the device is left at rest.
  void finish() {
    if (handle_ && link_.assigned_.load() == connection_) write(jnd_command{});
  }

  std::uint32_t connection() const noexcept { return connection_; }
  std::uint32_t engagement() const noexcept { return engagement_; }

 private:
  bool current() const noexcept { return !link_.ends_.load() && link_.assigned_.load() == connection_; }

  void write(jnd_command command) {
    if (++sequence_ == 0) ++sequence_;  // 0 says "none yet" in telemetry
    command.sequence = sequence_;
    std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
    jnd_encode_command(&command, bytes.data());
    link_.written_.note(sequence_, link_.clock_.now_ns());
    if (handle_->write(bytes)) {
      link_.sent_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    const std::lock_guard lock(link_.mutex_);
    link_.write_trouble_ = "it takes no commands (" + handle_->error() + ")";
  }

  FingertipLink& link_;
  std::unique_ptr<HidHandle> handle_;
  std::uint32_t connection_ = 0;
  std::uint32_t sequence_ = 0;
  std::uint32_t engagement_ = 0;
};

void FingertipLink::write_commands() noexcept {
  Writer writer(*this);
  std::uint64_t written = 0;
  while (!ends_.load()) {
    const std::uint32_t seen = wake_.load(std::memory_order_acquire);
    if (assigned_.load() != writer.connection()) {
      writer.connect(assigned_.load());
      written = posted_.look().number;  // what was meant for the connection before is not for this one
    }
    const PostedCommand posted = posted_.look();
    if (posted.number == written) {
      wake_.wait(seen, std::memory_order_acquire);  // returns at once where anything came since
      continue;
    }
    // Mode rest before a new engagement is written also where a command has replaced it already.
    const bool rest_is_made_up = posted.engagement != writer.engagement() && posted.command.mode != JND_MODE_REST;
    const auto skipped = static_cast<std::int64_t>(posted.number - written - 1);
    overwritten_.fetch_add(std::max<std::int64_t>(skipped - (rest_is_made_up ? 1 : 0), 0), std::memory_order_relaxed);
    written = posted.number;
    writer.write(posted);
  }
  writer.finish();
}

DeviceStatus HidFingertip::engage(std::int64_t now_ns) noexcept {
  was_active_ = false;
  engaged_ns_ = now_ns;
  connection_ = link_.connection();
  if (connection_ == 0) return DeviceStatus::lost;
  engagement_ = link_.engage();
  return DeviceStatus::ok;
}

DeviceStatus HidFingertip::read(std::int64_t now_ns, DeviceReading& reading) noexcept {
  if (lost()) return DeviceStatus::lost;
  const LinkTelemetry newest = link_.newest();
  if (newest.connection != connection_) return DeviceStatus::lost;
  reading = to_reading(newest.telemetry, newest.time_ns);
  const bool settled = now_ns - engaged_ns_ > kLongestSilence_ns;
  // Before that, what it says of stops is of the engagement before.
  if (newest.engagement != engagement_) return settled ? DeviceStatus::lost : DeviceStatus::ok;
  if (newest.telemetry.state == JND_STATE_ACTIVE) {
    was_active_ = true;
    return DeviceStatus::ok;
  }
  return was_active_ || settled ? DeviceStatus::stopped : DeviceStatus::ok;
}

DeviceStatus HidFingertip::write(const DeviceCommand& command, std::int64_t /*now_ns*/) noexcept {
  if (lost()) return DeviceStatus::lost;
  jnd_command report{};
  (void)to_report(command, mode_, report);
  link_.send(report);
  return DeviceStatus::ok;
}

void HidFingertip::neutral() noexcept {
  link_.send(jnd_command{});
}

}  // namespace jnd
