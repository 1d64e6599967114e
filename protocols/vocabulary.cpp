#include "protocols/vocabulary.h"

#include <algorithm>
#include <deque>
#include <mutex>

namespace jnd {

namespace {

constexpr auto kSessionKinds = words<SessionKind>(
    {{"real", SessionKind::real}, {"pilot", SessionKind::pilot}, {"simulated", SessionKind::simulated}});
constexpr auto kChannels = words<Channel>({{"cutaneous", Channel::cutaneous}, {"kinaesthetic", Channel::kinaesthetic}});
constexpr auto kEnteredBy =
    words<EnteredBy>({{"participant", EnteredBy::participant}, {"operator", EnteredBy::operator_}});

// "N s/m" -> "n_s_per_m": what CSV columns and keys of JSON can carry.
std::string suffix_of(std::string_view text) {
  std::string suffix;
  for (const char c : text) {
    if (c == '/') {
      suffix += "_per_";
    } else if (c >= 'A' && c <= 'Z') {
      suffix += static_cast<char>(c - 'A' + 'a');
    } else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      suffix += c;
    } else if (!suffix.empty() && suffix.back() != '_') {
      suffix += '_';
    }
  }
  return suffix;
}

}  // namespace

Unit Unit::named(std::string_view text) {
  if (text == kContact.text) return n_per_m;
  if (text == kJoint.text) return n_per_rad;
  struct Kept {
    explicit Kept(std::string_view written) : text(written), suffix(suffix_of(written)), names{text, suffix} {}
    std::string text, suffix;
    Names names;
  };
  static std::mutex mutex;
  static std::deque<Kept> all;  // which never moves what it holds
  const std::scoped_lock lock(mutex);
  const auto found = std::find_if(all.begin(), all.end(), [&](const Kept& kept) { return kept.text == text; });
  return Unit(found != all.end() ? &found->names : &all.emplace_back(text).names);
}

Intervals::Intervals(std::initializer_list<double> values) noexcept : size_(0) {
  for (const double value : values) push_back(value);
}

void Intervals::push_back(double value) noexcept {
  if (size_ < values_.size()) values_[size_++] = value;
}

std::string_view to_string(TaskKind task) noexcept {
  return word_of(kTaskWords, task);
}

std::optional<TaskKind> task_kind_from(std::string_view text) noexcept {
  return value_of(kTaskWords, text);
}

std::string_view to_string(SessionKind kind) noexcept {
  return word_of(kSessionKinds, kind);
}

std::string_view to_string(Unit unit) noexcept {
  return unit.text();
}

std::string_view name_suffix(Unit unit) noexcept {
  return unit.suffix();
}

std::string_view length_suffix(Unit unit) noexcept {
  return unit == Unit::n_per_rad ? "rad" : "m";
}

std::string_view to_string(Channel channel) noexcept {
  return word_of(kChannels, channel);
}

std::string_view to_string(RenderingMode mode) noexcept {
  return word_of(kRenderingModeWords, mode);
}

std::string_view to_string(EnteredBy who) noexcept {
  return word_of(kEnteredBy, who);
}

std::string_view to_string(Fault fault) noexcept {
  return word_of(kFaultWords, fault);
}

std::optional<SessionKind> session_kind_from(std::string_view text) noexcept {
  return value_of(kSessionKinds, text);
}

std::optional<Channel> channel_from(std::string_view text) noexcept {
  return value_of(kChannels, text);
}

std::optional<EnteredBy> entered_by_from(std::string_view text) noexcept {
  return value_of(kEnteredBy, text);
}

std::optional<Fault> fault_from(std::string_view text) noexcept {
  return value_of(kFaultWords, text);
}

}  // namespace jnd
