#include "devices/external/conformance.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/numerics/special_values.h"
#include "devices/device_error.h"
#include "devices/external/rig_fit.h"
#include "devices/external/rig_probe.h"
#include "protocols/delivery.h"

namespace jnd {

namespace {

constexpr double kExplore_s = 0.5;
constexpr double kExploreSlack_s = 0.1;
constexpr double kNoContact_s = 10;  // a person has to find the object
constexpr double kStopAfter_s = 0.2;
constexpr double kHold_s = 1;  // from "ready" to "present", where the operator takes a while
constexpr int kWatched = 20;   // answers to "alive", while the rig is only looked at
constexpr std::uint64_t kForeignId = 4'000'000'000'000'000;  // that no presentation has

std::string parameter_text(const RigParameter& parameter) {
  if (const auto* range = std::get_if<RigRange>(&parameter)) return rig_range_text(*range);
  const auto& choice = std::get<RigChoice>(parameter);
  return fmt::format("{} {}", choice.name, fmt::join(choice.words, " or "));
}

std::string can_do(const RigHello& hello) {
  std::string text;
  for (const RigRange& range : hello.quantities) text += (text.empty() ? "" : "; ") + rig_range_text(range);
  for (const RigParameter& parameter : hello.parameters) text += "; " + parameter_text(parameter);
  return text;
}

std::string ms_text(double ms) {
  return fmt::format("{:.1f} ms", ms);
}

// The first message of that kind; null where there is none.
const RigMessage* first_of(const std::vector<ReadRigLine>& heard, const std::function<bool(const RigMessage&)>& kind) {
  const auto found = std::find_if(heard.begin(), heard.end(),
                                  [&](const ReadRigLine& read) { return read.message && kind(*read.message); });
  return found == heard.end() ? nullptr : &*found->message;
}

class ConformanceTest {
 public:
  ConformanceTest(const ExternalSettings& settings, const std::atomic<bool>& interrupted)
      : settings_(settings), interrupted_(interrupted), is_child_(!settings.command.empty()) {}

  // Says hello; the rig stays on. False where the rest makes no sense.
  bool greet() {
    if (!start("starts") || !hears_hello("hello")) return false;
    hello_ = probe_->exchange().hello();
    note("is", fmt::format("{} {}, serial {}, {}", hello_->name, hello_->version, hello_->serial,
                           hello_->model ? "a model" : "real"));
    note("presents", can_do(*hello_));
    std::vector<std::string> measures;
    for (const RigChannel& channel : hello_->measures) measures.push_back(channel.name);
    note("measures", measures.empty() ? "nothing: what it delivers stays its own word"
                                      : fmt::format("{}", fmt::join(measures, ", ")));
    return true;
  }

  void check_alive() {
    watch();
    check_answers("alive while it waits", traffic().slowest_waiting_ms, Verdict::warn);
  }

  void check_presentations() {
    if (!hello_->holds) note("holds what is ready", "no: how long it takes to get ready may tell the stimulus");
    const RigRange& range = hello_->quantities.front();
    present_at(range.min, "the lowest");
    if (gone()) return;
    if (range.max > range.min) present_at(range.max, "the highest", {}, hello_->holds ? kHold_s : 0);
    if (gone()) return;
    if (hello_->places > 1) present_at(range.min, "beside the highest", range.max);
    if (gone()) return;
    check_answers("alive while it presents", traffic().slowest_presenting_ms, Verdict::bad);
  }

  void check_stops() {
    const Probed stopped = probe_->present(request(hello_->quantities.front().min, 10), {.stop_after_s = kStopAfter_s});
    const double limit_ms = 1000 * settings_.time_outs.stop_s;
    const bool by_stop = stopped.voided && stopped.voided->failure == RigFailure::stopped;
    const std::string ended = by_stop ? "done after " + ms_text(stopped.stopped_ms) : outcome_text(stopped);
    add("stop ends a presentation", gone() ? why_lost() : ended, fmt::format("within {:g} ms", limit_ms),
        !gone() && by_stop && stopped.stopped_ms <= limit_ms);
    if (gone()) return;
    RenderRequest free = request(hello_->quantities.front().min, 0);
    free.exploration = {.ends = RigExplorationEnd::stop, .no_contact_s = kNoContact_s};
    const Probed enough = probe_->present(free, {.stop_after_s = kStopAfter_s, .reason = RigStop::enough});
    if (!untouched(enough, "stop with \"enough\" completes it"))
      add("stop with \"enough\" completes it", outcome_text(enough), "complete", enough.done.has_value());
  }

  void check_refusals() {
    const RigRange& range = hello_->quantities.front();
    const double beyond = std::max(std::abs(range.max), std::abs(range.min)) * 10 + 1;
    RenderRequest wrong = request(range.min, kExplore_s);
    wrong.value = beyond;
    expect_refusal(fmt::format("refuses {}", rig_value_text(beyond, range.unit)), wrong);
    wrong = request(range.min, kExplore_s);
    wrong.quantity = "no_such_quantity";
    expect_refusal("refuses a quantity it does not have", wrong);
    for (const RigParameter& parameter : hello_->parameters) {
      wrong = request(range.min, kExplore_s);
      const std::string& name = std::visit([](const auto& its) -> const std::string& { return its.name; }, parameter);
      if (const auto* its = std::get_if<RigRange>(&parameter))
        wrong.parameters[name] = std::max(std::abs(its->max), std::abs(its->min)) * 10 + 1;
      else
        wrong.parameters[name] = "no such word";
      expect_refusal(fmt::format("refuses a {} out of its range", name), wrong);
    }
  }

  void check_unknown_message() {
    if (gone()) return;
    probe_->say("{\"type\":\"x-later-version\",\"anything\":[1,2,3]}\n");
    watch();
    add("lets an unknown message pass", gone() ? why_lost() : "goes on", "goes on", !gone());
  }

  void check_questions() {
    if (!hello_->answers || gone()) return;
    const std::vector<std::string> answers = {"first", "second"};
    probe_->say(ask_line(kForeignId, answers));
    watch();
    probe_->say(stop_line(kForeignId, RigStop::enough));
    watch();
    add("a question is asked and withdrawn", gone() ? why_lost() : "goes on", "goes on", !gone());
  }

  // A rig without its program must let go by itself.
  void check_watchdog() {
    if (gone()) return;
    probe_->say(prepare_line(kForeignId, request(hello_->quantities.front().min, 10)));
    const auto is_ready = [](const RigMessage& message) { return std::holds_alternative<RigReady>(message); };
    (void)probe_->overhear(settings_.time_outs.prepare_s, is_ready);
    probe_->say(present_line(kForeignId, request(hello_->quantities.front().min, 10)));
    const double began_s = probe_->now_s();
    const double limit_s = settings_.time_outs.presenting_silent_s + settings_.time_outs.stop_s;
    const auto is_fault = [](const RigMessage& message) { return std::holds_alternative<RigFault>(message); };
    const bool told = first_of(probe_->keep_silent(limit_s + 1, is_fault), is_fault) != nullptr;
    const double after_s = probe_->now_s() - began_s;
    add("lets go when the program is silent", told ? "says fault after " + ms_text(1000 * after_s) : "says nothing",
        fmt::format("fault within {:g} ms", 1000 * limit_s), told && after_s <= limit_s);
  }

  void check_refused_lines() {
    const std::int64_t refused = traffic().refused;
    std::string found = fmt::format("{} of {} refused", refused, traffic().lines);
    if (refused > 0)
      found += fmt::format(", the last: {} ({})", probe_->exchange().refused_lines().back().line,
                           probe_->exchange().refused_lines().back().why);
    add("its lines are messages", found, "none refused", refused == 0);
  }

  void check_end(bool with_bye) {
    const double began_s = probe_->now_s();
    const bool was_gone = gone();
    const bool left = !was_gone && probe_->leave(settings_.time_outs.bye_s, with_bye);
    const std::string ended = was_gone ? "was lost before: " + why_lost()
                              : left   ? "after " + ms_text(1000 * (probe_->now_s() - began_s))
                                       : "does not";
    const std::string how = probe_->end(with_bye ? 0 : 300);
    probe_.reset();
    add(with_bye ? (is_child_ ? "bye ends it" : "bye closes the connection") : "ends when its input does",
        left && is_child_ ? fmt::format("{} ({})", ended, how) : ended,
        fmt::format("within {:g} s", settings_.time_outs.bye_s), left);
  }

  // Started anew it is the same rig: what a session would accept.
  bool check_restart() {
    if (!start("starts anew") || !hears_hello("hello after a new start")) return false;
    const bool same = is_same_rig(*hello_, *probe_->exchange().hello());
    add("is the same rig", same ? "says the same hello" : "says another hello", "the same hello", same);
    return true;
  }

  void not_tried(const std::string& what) {
    checks_.push_back(
        {.what = what, .verdict = Verdict::not_judged, .found = "not tried", .limit = "consent, or --yes"});
  }
  bool gone() const noexcept { return probe_ == nullptr || probe_->exchange().lost().has_value(); }
  const std::optional<RigHello>& hello() const noexcept { return hello_; }
  Checks& checks() noexcept { return checks_; }

 private:
  void add(std::string what, std::string found, std::string limit, bool ok) {
    checks_.push_back(measured(std::move(what), std::move(found), std::move(limit), ok));
  }
  void note(std::string what, std::string found) {
    checks_.push_back({.what = std::move(what), .verdict = Verdict::not_judged, .found = std::move(found)});
  }

  bool start(const std::string& what) {
    try {
      probe_ = std::make_unique<RigProbe>(settings_, interrupted_);
    } catch (const DeviceError& error) {
      add(what, error.what(), in_words(settings_), false);
      return false;
    }
    add(what, in_words(settings_), "", true);
    return true;
  }

  bool hears_hello(const std::string& what) {
    const double began_s = probe_->now_s(), patience_s = settings_.time_outs.hello_s;
    const bool greeted = probe_->until(patience_s + 1, [&] { return probe_->exchange().greeted(); });
    add(what, greeted ? "after " + ms_text(1000 * (probe_->now_s() - began_s)) : why_lost(),
        fmt::format("within {:g} s", patience_s), greeted);
    return greeted;
  }

  std::string why_lost() const {
    if (!gone()) return "no answer";
    std::string why = probe_ == nullptr ? "not connected" : probe_->exchange().lost()->words;
    if (probe_ != nullptr && !probe_->connection().last_error().empty())
      why += ", and it said last: " + probe_->connection().last_error();
    return why;
  }

  const RigTraffic& traffic() const { return probe_->exchange().traffic(); }

  // Until the rig has answered so many more `alive`, and so has heard what was said before, or is lost.
  void watch() {
    const std::int64_t enough = traffic().answered + kWatched;
    (void)probe_->until(kInf, [&] { return traffic().answered >= enough; });
  }

  void check_answers(const std::string& what, double slowest_ms, Verdict if_slow) {
    const double limit_ms = 1000 * settings_.time_outs.presenting_silent_s;
    const Verdict found = slowest_ms > limit_ms ? if_slow : Verdict::ok;
    checks_.push_back({.what = what,
                       .verdict = gone() ? Verdict::bad : found,
                       .found = gone() ? why_lost() : fmt::format("answered after at most {}", ms_text(slowest_ms)),
                       .limit = fmt::format("within {:g} ms", limit_ms)});
  }

  RenderRequest request(double value, double explore_s) const {
    RenderRequest request;
    request.quantity = hello_->quantities.front().name;
    request.unit = hello_->quantities.front().unit;
    request.value = value;
    for (const RigParameter& parameter : hello_->parameters) {
      if (const auto* range = std::get_if<RigRange>(&parameter))
        request.parameters[range->name] = range->min;
      else
        request.parameters[std::get<RigChoice>(parameter).name] = std::get<RigChoice>(parameter).words.front();
    }
    request.exploration = {.duration_s = explore_s, .no_contact_s = kNoContact_s};
    request.time_out_s = kNoContact_s + explore_s + 1;
    return request;
  }

  static std::string outcome_text(const Probed& probed) {
    if (probed.voided) return fmt::format("void: {}", probed.voided->words);
    return probed.done ? "complete" : "nothing";
  }

  // Whether nobody touched it, which is judged as nothing.
  bool untouched(const Probed& probed, const std::string& what) {
    const bool untouched = probed.voided && probed.voided->failure == RigFailure::no_contact;
    if (untouched) note(what, "nothing was touched");
    return untouched;
  }

  void judge_delivery(double asked, const std::optional<double>& delivered, const std::string& what) {
    const RigRange& range = hello_->quantities.front();
    if (!delivered) return note(what, "not measured");
    add(what, fmt::format("{:.6g} {}, by its own word", *delivered, range.unit),
        fmt::format("{} +- {:.0f} %", rig_value_text(asked, range.unit), 100 * kDeliveryTolerance),
        is_as_asked(asked, *delivered, std::max(std::abs(range.min), std::abs(range.max))));
  }

  void present_at(double value, const std::string& which, std::optional<double> beside = std::nullopt,
                  double hold_s = 0) {
    RenderRequest asked = request(value, kExplore_s);
    asked.beside = beside;
    const Probed probed = probe_->present(asked, {.hold_s = hold_s});
    const std::string what =
        fmt::format("presents {} {}", rig_value_text(value, hello_->quantities.front().unit), which);
    if (untouched(probed, what)) return;
    add(what, gone() ? why_lost() : outcome_text(probed), "done, complete, with the same id", probed.done.has_value());
    if (!probed.done) return;
    const double ready_s = std::max(hello_->ready_s, settings_.time_outs.ready_s) + settings_.time_outs.late_s;
    add("  ready", "after " + ms_text(probed.ready_ms),
        fmt::format("within {:g} s{}", ready_s,
                    hello_->ready_s > 0 ? ", as \"ready_s\" says" : ", or a longer \"ready_s\""),
        probed.ready_ms <= 1000 * ready_s);
    if (hold_s > 0) note("  holds what is ready", fmt::format("for {:g} s", hold_s));
    add("  tells its contacts", fmt::format("{} told, {} in done", probed.contacts, probed.done->contacts), "as many",
        static_cast<int>(probed.contacts) == probed.done->contacts);
    const double explored_s = probed.done->duration_s - probed.done->first_contact_s.value_or(0);
    add("  explored from the first contact", fmt::format("{:.3f} s", explored_s),
        fmt::format("{:g} +- {:g} s", kExplore_s, kExploreSlack_s),
        std::abs(explored_s - kExplore_s) <= kExploreSlack_s);
    judge_delivery(value, probed.done->delivered, "  delivered");
    if (beside) judge_delivery(*beside, probed.done->delivered_beside, "  delivered beside");
  }

  void expect_refusal(const std::string& what, const RenderRequest& wrong) {
    if (gone()) return;
    probe_->say(prepare_line(kForeignId, wrong));
    const auto answered = [](const RigMessage& message) {
      return std::holds_alternative<RigFault>(message) || std::holds_alternative<RigReady>(message);
    };
    const std::vector<ReadRigLine> heard = probe_->overhear(settings_.time_outs.prepare_s, answered);
    std::string found = gone() ? why_lost() : "no answer";
    bool ok = false;
    if (const RigMessage* answer = first_of(heard, answered); answer != nullptr) {
      const auto* fault = std::get_if<RigFault>(answer);
      ok = fault != nullptr && fault->id == kForeignId;
      found = fault == nullptr ? "says ready" : ok ? "says fault: " + fault->cause : "says fault without its id";
    }
    add(what, found, "fault with the same id", ok);
    // A rig that got ready all the same is let out of it.
    if (!ok && !gone()) {
      probe_->say(stop_line(kForeignId, RigStop::fault));
      (void)probe_->overhear(settings_.time_outs.stop_s,
                             [](const RigMessage& message) { return std::holds_alternative<RigDone>(message); });
    }
  }

  const ExternalSettings settings_;
  const std::atomic<bool>& interrupted_;
  const bool is_child_;
  std::unique_ptr<RigProbe> probe_;
  std::optional<RigHello> hello_;
  Checks checks_;
};

}  // namespace

Conformance check_rig_hello(const ExternalSettings& settings, const std::atomic<bool>& interrupted) {
  ConformanceTest test(settings, interrupted);
  if (test.greet()) test.check_end(true);
  return {test.hello(), std::move(test.checks())};
}

Conformance check_conformance(const ExternalSettings& settings, const std::atomic<bool>& interrupted,
                              const std::function<bool(const RigHello&)>& may_present) {
  ConformanceTest test(settings, interrupted);
  const auto result = [&] { return Conformance{test.hello(), std::move(test.checks())}; };
  if (!test.greet()) return result();
  test.check_alive();
  const bool present = !test.gone() && may_present(*test.hello());
  test.check_refusals();
  test.check_unknown_message();
  test.check_questions();
  if (present && !test.gone()) test.check_presentations();
  if (present && !test.gone()) test.check_stops();
  test.check_refused_lines();
  test.check_end(true);
  if (!present) test.not_tried("presentations, stop, silence of the program");
  if (!test.check_restart()) return result();
  if (present) test.check_watchdog();
  test.check_end(false);
  return result();
}

}  // namespace jnd
