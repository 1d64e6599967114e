#include "devices/hid/buttons/button_learner.h"

#include <algorithm>
#include <bit>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace jnd {

namespace {

constexpr std::int64_t kBounce_ns = 100'000'000;          // longer than any contact does, and a finger's way
constexpr std::int64_t kLongestQuiet_ns = 4'000'000'000;  // while slow counters still show new bits

}  // namespace

ButtonLearner::ButtonLearner(const LearnerSetup& setup, std::int64_t now_ns) : setup_(setup), began_ns_(now_ns) {
  wanted_ = {ButtonMeaning::same, ButtonMeaning::different};
  if (setup.with_stop) wanted_.push_back(ButtonMeaning::stop);
  enter(Phase::quiet, now_ns);
  say("Take your hands and feet off the box for a moment.");
}

std::vector<std::string> ButtonLearner::take_words() {
  return std::exchange(words_, {});
}

void ButtonLearner::enter(Phase phase, std::int64_t now_ns) {
  if ((phase == Phase::press || phase == Phase::let_go) && phase_ != phase)
    for (auto& [id, stream] : streams_) stream.moved_ns.assign(stream.latest.size(), {});
  phase_ = phase;
  since_ns_ = now_ns;
}

bool ButtonLearner::Stream::still(std::size_t byte) const {
  return !rest.empty() && ((latest[byte] ^ rest[byte]) & steady(byte)) == 0;
}

void ButtonLearner::begin_attempt(std::int64_t now_ns) {
  again_ = false;
  for (auto& [id, stream] : streams_) {
    stream.restless.assign(stream.latest.size(), 0);
    stream.seen.assign(stream.latest.size(), {});
    for (std::size_t i = 0; i < stream.latest.size(); ++i) stream.seen[i].set(stream.latest[i]);
    stream.held = stream.released = stream.held_again = stream.released_again = {};
  }
  ask_press(now_ns);
}

void ButtonLearner::ask_press(std::int64_t now_ns) {
  say(again_ ? fmt::format("Once more: press {} and hold it.", shouted(wanted()))
             : fmt::format("Press {} and hold it.", shouted(wanted())));
  enter(Phase::press, now_ns);
}

void ButtonLearner::fail_attempt(const std::string& why, std::int64_t now_ns) {
  say(why);
  if (++attempts_ < kMostAttempts) {
    begin_attempt(now_ns);
    return;
  }
  say(fmt::format("{} could not be learnt in {} attempts. Begin again, with hands and feet off the box at first.",
                  shouted(wanted()), kMostAttempts));
  enter(Phase::refused, now_ns);
}

void ButtonLearner::report(std::span<const std::uint8_t> bytes, std::int64_t time_ns) {
  look(time_ns);
  if (bytes.empty() || done() || refused()) return;
  Stream& stream = streams_[setup_.numbered ? bytes[0] : 0];
  const bool first = stream.latest.empty();
  if (first) {
    stream.latest.assign(bytes.begin(), bytes.end());
    stream.noise.assign(bytes.size(), 0);
    stream.restless.assign(bytes.size(), 0);
    stream.seen.assign(bytes.size(), {});
    stream.moved_ns.assign(bytes.size(), {});
  }
  if (stream.latest.size() != bytes.size()) return;
  bool moved = first;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto changed = static_cast<std::uint8_t>(stream.latest[i] ^ bytes[i]);
    stream.latest[i] = bytes[i];
    if (phase_ == Phase::quiet) {
      if ((changed & ~stream.noise[i]) != 0) since_ns_ = time_ns;
      stream.noise[i] |= changed;
      continue;
    }
    stream.seen[i].set(bytes[i]);
    moved = stream.move(i, changed, time_ns) || moved;
  }
  if (!moved) return;
  // What moves first may be something else, such as a counter's slowest bit: time counts from the latest to begin.
  if (phase_ == Phase::press || phase_ == Phase::hold) enter(Phase::hold, time_ns);
  if (phase_ == Phase::let_go || phase_ == Phase::released) enter(Phase::released, time_ns);
}

// Whether a bit that keeps still by itself moves, for the first time since something was asked for. What moves again,
// later than contacts bounce, did not keep still.
bool ButtonLearner::Stream::move(std::size_t byte, std::uint8_t changed, std::int64_t now_ns) {
  bool begins = false;
  for (unsigned bit = 0; bit < 8; ++bit) {
    const auto one = static_cast<std::uint8_t>(1U << bit);
    if ((changed & one & steady(byte)) == 0) continue;
    std::optional<std::int64_t>& moved = moved_ns[byte][bit];
    begins = begins || !moved;
    if (moved && now_ns - *moved > kBounce_ns) restless[byte] |= one;
    if (!moved) moved = now_ns;
  }
  return begins;
}

void ButtonLearner::look(std::int64_t now_ns) {
  const std::int64_t passed_ns = now_ns - since_ns_;
  switch (phase_) {
    case Phase::quiet:
      if (passed_ns < kQuiet_ns && now_ns - began_ns_ < kLongestQuiet_ns) return;
      for (auto& [id, stream] : streams_) stream.rest = stream.latest;
      begin_attempt(now_ns);
      return;
    case Phase::hold:
      if (passed_ns >= kHold_ns) held(now_ns);
      return;
    case Phase::let_go:
      if (passed_ns >= kNoRelease_ns)
        fail_attempt("Nothing changed when it was let go. From the beginning, with all buttons up:", now_ns);
      return;
    case Phase::released:
      if (passed_ns >= kReleased_ns) let_go(now_ns);
      return;
    default:
      return;
  }
}

void ButtonLearner::held(std::int64_t now_ns) {
  bool nothing = true;
  for (auto& [id, stream] : streams_) {
    (again_ ? stream.held_again : stream.held) = stream.latest;
    for (std::size_t i = 0; i < stream.latest.size(); ++i) nothing = nothing && stream.still(i);
  }
  if (nothing) {
    fail_attempt("It was let go too soon, or nothing but axes moved.", now_ns);
    return;
  }
  say("Let go.");
  enter(Phase::let_go, now_ns);
}

void ButtonLearner::let_go(std::int64_t now_ns) {
  for (auto& [id, stream] : streams_) (again_ ? stream.released_again : stream.released) = stream.latest;
  if (again_) {
    judge(now_ns);
    return;
  }
  again_ = true;
  ask_press(now_ns);
}

void ButtonLearner::judge(std::int64_t now_ns) {
  std::vector<Found> found = candidates();
  // A trigger moves an axis as well, a single bit is the switch itself.
  const auto one_bit = [](const Found& one) {
    const auto* bits = std::get_if<ButtonBits>(&one.button.where);
    return bits != nullptr && std::popcount(bits->mask) == 1;
  };
  if (found.size() > 1 && std::count_if(found.begin(), found.end(), one_bit) == 1)
    found = {*std::find_if(found.begin(), found.end(), one_bit)};
  if (found.empty()) {
    fail_attempt(
        fmt::format("Nothing in the reports was there exactly while {} was held, both times the same. An axis or "
                    "a trigger that moves gradually does not do; neither does a button that is let go too "
                    "soon, or two at once.",
                    shouted(wanted())),
        now_ns);
    return;
  }
  if (found.size() > 1) {
    std::string places;
    for (const Found& one : found) places += (places.empty() ? "" : "; ") + described(one.button);
    fail_attempt(
        fmt::format("More than one thing changed with {} ({}): which one it is cannot be told. Press one button "
                    "only, or take another one.",
                    shouted(wanted()), places),
        now_ns);
    return;
  }
  if (const std::string objection = this->objection(found.front()); !objection.empty()) {
    fail_attempt(objection, now_ns);
    return;
  }
  accept(found.front(), now_ns);
}

void ButtonLearner::accept(const Found& found, std::int64_t now_ns) {
  say(fmt::format("{}: {}.", shouted(found.button.meaning), described(found.button)));
  learnt_.push_back(found);
  attempts_ = 0;
  // A box that reports changes only has shown by now what it says with all buttons up.
  for (auto& [id, stream] : streams_)
    if (stream.rest.empty()) stream.rest = stream.released_again;
  if (learnt_.size() == wanted_.size())
    enter(Phase::done, now_ns);
  else
    begin_attempt(now_ns);
}

// Which bytes of what was heard are the button, and what that makes as a mapping.

namespace {

constexpr std::uint16_t kGenericDesktop = 0x01, kKeyboard = 0x06, kKeypad = 0x07;

// Two directions of a hat share bits: they differ in all that either changes, not only in those that each does. Bits of
// their own stay apart, so that both can be seen to be down.
void widen(ButtonBits& bits, std::uint8_t held_value, std::uint8_t mask) {
  if ((bits.mask & mask) == 0) return;
  bits.mask |= mask;
  bits.pressed = held_value & bits.mask;
}

}  // namespace

std::string ButtonLearner::objection(const Found& found) const {
  for (const Found& other : learnt_) {
    if (other.report_id != found.report_id)
      return fmt::format("{} comes in report {}, {} in report {}: take buttons of the same kind.",
                         shouted(found.button.meaning), found.report_id, shouted(other.button.meaning),
                         other.report_id);
    Found a = found, b = other;
    auto *bits_a = std::get_if<ButtonBits>(&a.button.where), *bits_b = std::get_if<ButtonBits>(&b.button.where);
    if (bits_a != nullptr && bits_b != nullptr && bits_a->byte == bits_b->byte) {
      const std::uint8_t mask_a = bits_a->mask;
      widen(*bits_a, a.held_value, bits_b->mask);
      widen(*bits_b, b.held_value, mask_a);
    }
    if (confusable(a.button, b.button) || confusable(b.button, a.button))
      return fmt::format("That was {} again: take another button for {}.", shouted(other.button.meaning),
                         shouted(found.button.meaning));
  }
  return {};
}

bool ButtonLearner::keyboard_array(const Stream& stream, std::size_t byte) const {
  const std::size_t begin = setup_.numbered ? 1 : 0;
  return setup_.info.usage_page == kGenericDesktop &&
         (setup_.info.usage == kKeyboard || setup_.info.usage == kKeypad) && stream.latest.size() == begin + 8 &&
         byte >= begin + 2;
}

std::optional<ButtonLearner::Found> ButtonLearner::candidate(int report_id, const Stream& stream,
                                                             std::size_t byte) const {
  const std::uint8_t steady = stream.steady(byte);
  const auto differ = [&](const Bytes& a, const Bytes& b) { return ((a[byte] ^ b[byte]) & steady) != 0; };
  if (!differ(stream.held, stream.released) || differ(stream.held, stream.held_again) ||
      differ(stream.released, stream.released_again) || (!stream.rest.empty() && differ(stream.rest, stream.released)))
    return std::nullopt;
  std::set<int> values;
  for (std::size_t value = 0; value < 256; ++value)
    if (stream.seen[byte].test(value)) values.insert(static_cast<int>(value) & steady);
  if (values.size() != 2) return std::nullopt;
  Found found;
  found.button.meaning = wanted();
  found.report_id = report_id;
  found.report_bytes = stream.latest.size();
  found.held_value = stream.held[byte];
  if (keyboard_array(stream, byte) && steady == 0xff && stream.released[byte] == 0 && stream.held[byte] >= 4) {
    const int first = setup_.numbered ? 3 : 2;
    found.button.where = ButtonCode{first, first + 5, stream.held[byte]};
    return found;
  }
  ButtonBits bits;
  bits.byte = static_cast<int>(byte);
  bits.mask = static_cast<std::uint8_t>((stream.held[byte] ^ stream.released[byte]) & steady);
  bits.pressed = static_cast<std::uint8_t>(stream.held[byte] & bits.mask);
  found.button.where = bits;
  return found;
}

std::vector<ButtonLearner::Found> ButtonLearner::candidates() const {
  std::vector<Found> found;
  for (const auto& [id, stream] : streams_) {
    const std::size_t size = stream.latest.size();
    if (stream.held.size() != size || stream.released.size() != size || stream.held_again.size() != size ||
        stream.released_again.size() != size)
      continue;
    for (std::size_t byte = 0; byte < size; ++byte)
      if (const std::optional<Found> one = candidate(id, stream, byte)) found.push_back(*one);
  }
  return found;
}

ButtonMapping ButtonLearner::mapping() const {
  ButtonMapping mapping;
  mapping.vendor = setup_.info.vendor;
  mapping.product = setup_.info.product;
  mapping.usage_page = setup_.info.usage_page;
  mapping.usage = setup_.info.usage;
  if (!setup_.info.serial.empty()) mapping.serial = setup_.info.serial;
  mapping.name = setup_.info.product_name.empty() ? "button box" : setup_.info.product_name;
  if (setup_.numbered) mapping.report_id = learnt_.front().report_id;
  mapping.report_bytes = static_cast<int>(learnt_.front().report_bytes);
  mapping.debounce_ms = setup_.debounce_ms;
  for (const Found& found : learnt_) {
    MappedButton button = found.button;
    if (auto* bits = std::get_if<ButtonBits>(&button.where))
      for (const Found& other : learnt_)
        if (const auto* others = std::get_if<ButtonBits>(&other.button.where); others && others->byte == bits->byte)
          widen(*bits, found.held_value, others->mask);
    mapping.buttons.push_back(button);
  }
  return mapping;
}

// Short items of a report descriptor (HID 1.11, 6.2.2.2): a byte of tag, type and size, then its data.
bool numbers_reports(std::span<const std::uint8_t> report_descriptor) noexcept {
  constexpr std::uint8_t kLongItem = 0xfe, kReportId = 0x84;
  std::size_t at = 0;
  while (at < report_descriptor.size()) {
    const std::uint8_t head = report_descriptor[at];
    if (head == kLongItem) {
      if (at + 1 >= report_descriptor.size()) return false;
      at += 3U + report_descriptor[at + 1];
      continue;
    }
    if ((head & 0xfcU) == kReportId) return true;
    const unsigned size = head & 3U;
    at += 1U + (size == 3 ? 4U : size);
  }
  return false;
}

}  // namespace jnd
