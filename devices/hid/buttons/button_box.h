// The participant's buttons in a session: answers, the stop, and what the operator is to know of the box.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "devices/emergency_stop.h"
#include "devices/hid/buttons/button_mapping.h"
#include "devices/hid/buttons/button_presses.h"
#include "devices/hid/hid_bus.h"
#include "devices/hid/hid_reader.h"

namespace jnd {

// What has come of the question so far.
struct ButtonsHeard {
  std::optional<ButtonAnswer> answer;  // never a press after the stop button's
  bool pending = false;                // a press that has yet to stay alone
  AnswerTrouble trouble = AnswerTrouble::none;
  bool stopped = false;  // the stop button was pressed since the question
};

struct BoxEvent {
  bool warning = false;
  std::string text;  // printable
};

// Thread rule: members are for the session's thread; a thread of its own reads the box, stamps every press with the
// monotonic clock and latches the stop. A box that is unplugged is looked for until it is there again.
class ButtonBox final : private HidListener {
 public:
  static constexpr double kAppears_s = 3;

  // bus must outlive it.
  ButtonBox(HidBus& bus, const ButtonMapping& mapping);

  // Returns once the box is there. Throws DeviceError where it does not come within kAppears_s: with what is connected
  // instead, and what to do.
  void wait_until_there();
  bool there() const;
  const ButtonMapping& mapping() const noexcept { return mapping_; }
  bool has(ButtonMeaning meaning) const noexcept;

  // The question is on the screen: what is pressed from now on answers it.
  void ask();
  ButtonsHeard hear();
  // What happened to the box since the last call.
  std::vector<BoxEvent> take_events();

  // From now on the stop button latches `stop`, at once, from the box's thread; now, where it is down. Null: no more.
  // `stop` must live until then.
  void stop_with(EmergencyStop* stop);

 private:
  void connected(const HidInfo& info, HidHandle& handle) override;
  void report(std::span<const std::uint8_t> bytes, std::int64_t time_ns) noexcept override;
  void lost(const std::string& why) override;
  std::string not_there() const;

  HidBus& bus_;
  const ButtonMapping mapping_;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  ButtonDecoder decoder_;
  ButtonAnswers answers_;
  EmergencyStop* stop_ = nullptr;
  bool there_ = false, was_there_ = false;
  bool told_stop_ = true;
  std::int64_t stopped_ns_ = 0;  // when the stop button was pressed since the question; 0: it was not
  bool understood_ = false, told_strange_ = false;  // a report that the mapping speaks of has come
  std::size_t strange_bytes_ = 0;                   // of a report that it does not
  std::string refused_;                             // why it could not be opened
  std::vector<BoxEvent> events_;

  HidReader reader_;  // last: it calls the rest
};

// While it lives, the box's stop button latches `stop`. box may be null.
class StopOnButton {
 public:
  StopOnButton(ButtonBox* box, EmergencyStop& stop) : box_(box) {
    if (box_ != nullptr) box_->stop_with(&stop);
  }
  ~StopOnButton() {
    if (box_ != nullptr) box_->stop_with(nullptr);
  }
  StopOnButton(const StopOnButton&) = delete;
  StopOnButton& operator=(const StopOnButton&) = delete;

 private:
  ButtonBox* box_;
};

}  // namespace jnd
