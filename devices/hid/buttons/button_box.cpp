#include "devices/hid/buttons/button_box.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "devices/clock.h"
#include "devices/device_error.h"

namespace jnd {

namespace {
constexpr int kPriority = 1;  // no work of other threads delays a stop or a stamp; the control loop still goes first
}  // namespace

ButtonBox::ButtonBox(HidBus& bus, const ButtonMapping& mapping)
    : bus_(bus),
      mapping_(mapping),
      decoder_(mapping),
      reader_(
          bus, [this](const HidInfo& info) { return mapping_.is(info); }, *this, kPriority) {}

bool ButtonBox::has(ButtonMeaning meaning) const noexcept {
  return std::any_of(mapping_.buttons.begin(), mapping_.buttons.end(),
                     [&](const MappedButton& button) { return button.meaning == meaning; });
}

bool ButtonBox::there() const {
  const std::scoped_lock lock(mutex_);
  return there_;
}

void ButtonBox::wait_until_there() {
  {
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, std::chrono::duration<double>(kAppears_s), [this] { return there_; })) return;
  }
  throw DeviceError(not_there());
}

std::string ButtonBox::not_there() const {
  std::string others, refused;
  {
    const std::scoped_lock lock(mutex_);
    refused = refused_;
  }
  for (const HidInfo& info : bus_.list())
    others += fmt::format("\n  {:04x}:{:04x} {}{}{}, usage 0x{:02x}/0x{:02x}, {}", info.vendor, info.product,
                          info.manufacturer, info.manufacturer.empty() ? "" : " ", info.product_name, info.usage_page,
                          info.usage, info.path);
  std::string text =
      fmt::format("the button box \"{}\" ({:04x}:{:04x}{}{}) is not there", mapping_.name, mapping_.vendor,
                  mapping_.product, mapping_.serial ? ", serial " : "", mapping_.serial.value_or(""));
  if (!refused.empty()) text += ": " + refused;
  text += others.empty() ? "; no HID device is connected" : "; connected:" + others;
  return text +
         "\nplug it in, learn another one's buttons (jnd device learn-buttons --to FILE), or leave the buttons out: "
         "the keys answer too";
}

void ButtonBox::ask() {
  const std::scoped_lock lock(mutex_);
  const std::int64_t now_ns = SteadyClock().now_ns();
  for (const ButtonChange& change : decoder_.settle(now_ns)) answers_.change(change);
  answers_.ask(now_ns);
  stopped_ns_ = 0;
}

ButtonsHeard ButtonBox::hear() {
  const std::scoped_lock lock(mutex_);
  const std::int64_t now_ns = SteadyClock().now_ns();
  for (const ButtonChange& change : decoder_.settle(now_ns)) answers_.change(change);
  ButtonsHeard heard;
  heard.answer = answers_.take(now_ns);
  heard.pending = answers_.pending().has_value();
  heard.trouble = answers_.trouble();
  heard.stopped = stopped_ns_ != 0;
  if (heard.stopped && heard.answer && heard.answer->time_ns > stopped_ns_) heard.answer.reset();
  return heard;
}

std::vector<BoxEvent> ButtonBox::take_events() {
  const std::scoped_lock lock(mutex_);
  std::vector<BoxEvent> events = std::exchange(events_, {});
  if (!std::exchange(told_stop_, true)) events.push_back({true, "STOP by the button: the devices give nothing"});
  if (strange_bytes_ != 0 && !understood_ && !std::exchange(told_strange_, true))
    events.push_back({true, fmt::format("the button box sends reports of {} bytes, where its buttons were learnt in "
                                        "reports of {}: learn them again (jnd device learn-buttons)",
                                        strange_bytes_, mapping_.report_bytes)});
  return events;
}

void ButtonBox::stop_with(EmergencyStop* stop) {
  const std::scoped_lock lock(mutex_);
  stop_ = stop;
  if (stop_ != nullptr && decoder_.is_down(ButtonMeaning::stop)) stop_->latch(StopSource::button);
}

void ButtonBox::connected(const HidInfo& /*info*/, HidHandle& /*handle*/) {
  const std::scoped_lock lock(mutex_);
  decoder_.opened(SteadyClock().now_ns());
  answers_.forget();
  if (was_there_) events_.push_back({false, "the button box is there again"});
  there_ = was_there_ = true;
  changed_.notify_all();
}

void ButtonBox::report(std::span<const std::uint8_t> bytes, std::int64_t time_ns) noexcept {
  const std::scoped_lock lock(mutex_);
  const ButtonChanges changes = decoder_.feed(bytes, time_ns);
  if (changes.stops) {
    if (stop_ != nullptr) stop_->latch(StopSource::button);
    stopped_ns_ = time_ns;
    told_stop_ = false;
  }
  for (const ButtonChange& change : changes) answers_.change(change);
  if (decoder_.speaks_of(bytes))
    understood_ = true;
  else if (!mapping_.report_id)
    strange_bytes_ = bytes.size();
}

void ButtonBox::lost(const std::string& why) {
  const std::scoped_lock lock(mutex_);
  refused_ = why;
  if (!std::exchange(there_, false)) return;
  answers_.forget();
  events_.push_back({true, "the button box has gone: the keys answer until it is plugged in again"});
}

}  // namespace jnd
