#include "devices/external/rig_exchange.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "devices/external/rig_fit.h"
#include "devices/external/rig_line.h"

namespace jnd {

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t nanoseconds(double seconds) noexcept {
  return static_cast<std::int64_t>(seconds * 1e9);
}

double milliseconds(std::int64_t ns) noexcept {
  return 1e-6 * static_cast<double>(ns);
}

// In a time that does not tell how much of it is right.
bool is_same_secret(std::string_view one, std::string_view other) noexcept {
  unsigned differs = one.size() == other.size() ? 0U : 1U;
  for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i)
    differs |= static_cast<unsigned char>(one[i]) ^ static_cast<unsigned char>(other[i]);
  return differs == 0;
}

}  // namespace

RigExchange::RigExchange(std::string program_version, const RigTimeOuts& time_outs, std::string token)
    : program_version_(std::move(program_version)), time_outs_(time_outs), token_(std::move(token)) {}

void RigExchange::begin(std::int64_t now_ns) {
  output_.clear();
  lost_.reset();
  greeted_ = leaving_ = false;
  began_ns_ = now_ns;
  rest();
  question_ = 0;
  alive_heard_ = alive_said_;  // its numbers go on, as those of presentations do
  alive_unanswered_.clear();
  refused_lately_ = 0;
  output_ += hello_line(program_version_);
}

void RigExchange::hear(std::string_view line, std::int64_t now_ns) {
  if (lost_) return;
  ++traffic_.lines;
  line_ = line;
  const ReadRigLine read = read_rig_line(line);
  if (!read.message) {
    const bool ends_presentation = read.type == "done" && (state_ == State::presenting || state_ == State::stopping);
    refuse(read.refused, now_ns);
    if (!ends_presentation || lost_) return;
    // Which presentation it meant is not known for sure: it is stopped all the same, and then says "done" once more or
    // is started anew.
    void_presentation(RigFailure::refused_done, "its \"done\" was refused: " + read.refused, now_ns);
    if (state_ == State::presenting) stop_for(RigStop::fault, now_ns);
    return;
  }
  if (!greeted_ && !std::holds_alternative<RigHello>(*read.message)) {
    refuse("came before hello", now_ns);
    return;
  }
  std::visit([&](const auto& message) { take(message, now_ns); }, *read.message);
}

void RigExchange::hear_too_long(std::string_view beginning, std::int64_t now_ns) {
  if (lost_) return;
  ++traffic_.lines;
  line_ = beginning;
  refuse(fmt::format("longer than {} bytes", kLongestRigLine), now_ns);
}

void RigExchange::take(const RigHello& told, std::int64_t now_ns) {
  RigHello hello = told;
  const std::string token = std::exchange(hello.token, {});
  if (!token_.empty() && !is_same_secret(token, token_)) {
    end(RigFailure::no_hello,
        "what listens there is not known to be the rig: its hello has not the token of the file that the rig file names",
        now_ns);
    return;
  }
  if (greeted_) {
    refuse("a second hello", now_ns);
    return;
  }
  if (hello_ && !is_same_rig(*hello_, hello)) {
    end(RigFailure::no_hello, "the rig says another hello than before: the study was checked against the first one",
        now_ns);
    return;
  }
  greeted_ = true;
  hello_ = hello;
  emit({now_ns, hello});
}

std::string RigExchange::wrong_state(std::string_view what, std::uint64_t id, bool good_state) const {
  if (!engaged()) return fmt::format("{} of {}, while nothing is presented", what, id);
  if (id != id_) return fmt::format("{} of {}, while it is the turn of {}", what, id, id_);
  if (!good_state) return fmt::format("{} of {} at the wrong time", what, id);
  return {};
}

std::string RigExchange::wrong_names(const NamedNumbers& numbers) const {
  for (const auto& entry : numbers) {
    const bool known = std::any_of(hello_->measures.begin(), hello_->measures.end(),
                                   [&](const RigChannel& channel) { return channel.name == entry.first; });
    if (!known) return fmt::format("hello measures no {}", entry.first);
  }
  return {};
}

void RigExchange::take(const RigReady& ready, std::int64_t now_ns) {
  if (std::string why = wrong_state("ready", ready.id, state_ == State::preparing); !why.empty()) {
    refuse(std::move(why), now_ns);
    return;
  }
  state_ = State::ready;
  emit({now_ns, ready});
}

void RigExchange::take(const RigContact& contact, std::int64_t now_ns) {
  const bool good = state_ == State::presenting || state_ == State::stopping;
  if (std::string why = wrong_state("contact", contact.id, good); !why.empty())
    refuse(std::move(why), now_ns);
  else {
    ++contacts_;
    emit({now_ns, contact});
  }
}

std::string RigExchange::wrong_done(const RigDone& done, std::int64_t now_ns) const {
  for (const NamedNumbers* numbers : {&done.peaks, &done.channels})
    if (std::string why = wrong_names(*numbers); !why.empty()) return why;
  const double elapsed_s = 1e-9 * static_cast<double>(now_ns - presented_ns_);
  if (done.duration_s > elapsed_s + kRigClockSlack_s)
    return fmt::format("duration_s is {} s, {:.3f} s after \"present\"", done.duration_s, elapsed_s);
  if (done.contacts > 0 && contacts_ == 0) return fmt::format("{} contacts, and none was told", done.contacts);
  return done.outcome == RigOutcome::complete && !voided_ ? unfinished(done) : std::string();
}

// What was asked for has not happened, whatever the rig says; only this program's "enough" ends it before.
std::string RigExchange::unfinished(const RigDone& done) const {
  const RigExploration& how = request_.exploration;
  if (how.from_contact && done.contacts == 0) return "\"complete\", and nothing was touched";
  if (state_ == State::stopping) return {};
  switch (how.ends) {
    case RigExplorationEnd::time: {
      const double explored_s = done.duration_s - (how.from_contact ? done.first_contact_s.value_or(0) : 0);
      if (explored_s >= how.duration_s - kRigClockSlack_s) return {};
      return fmt::format("\"complete\" after {:.3f} of {:g} s", explored_s, how.duration_s);
    }
    case RigExplorationEnd::contacts:
      if (done.contacts >= how.contacts) return {};
      return fmt::format("\"complete\" after {} of {} contacts", done.contacts, how.contacts);
    case RigExplorationEnd::stop:
      break;
  }
  return "\"complete\" before it was told that it is enough";
}

void RigExchange::take(const RigDone& done, std::int64_t now_ns) {
  const bool good = state_ == State::presenting || state_ == State::stopping;
  if (std::string why = wrong_state("done", done.id, good); !why.empty()) {
    refuse(std::move(why), now_ns);
    return;
  }
  if (std::string why = wrong_done(done, now_ns); !why.empty()) {
    refuse(why, now_ns);
    if (lost_) return;
    void_presentation(RigFailure::refused_done, "its \"done\" was refused: " + why, now_ns);
    rest();
    return;
  }
  finish(done, now_ns);
}

void RigExchange::finish(const RigDone& done, std::int64_t now_ns) {
  const bool stopped_for_fault = state_ == State::stopping && voided_;
  if (!stopped_for_fault) {
    if (done.outcome == RigOutcome::complete) {
      ++traffic_.presented;
      emit({now_ns, done});
    } else if (done.outcome == RigOutcome::no_contact) {
      void_presentation(RigFailure::no_contact, "nothing was touched", now_ns);
    } else {
      void_presentation(RigFailure::stopped, "stopped", now_ns);
    }
  }
  rest();
}

void RigExchange::take(const RigTelemetry& telemetry, std::int64_t now_ns) {
  if (std::string why = wrong_names(telemetry.values); !why.empty()) {
    refuse(std::move(why), now_ns);
    return;
  }
  if (telemetry.id) {
    const bool good = state_ == State::presenting || state_ == State::stopping;
    if (std::string why = wrong_state("telemetry", *telemetry.id, good); !why.empty()) {
      refuse(std::move(why), now_ns);
      return;
    }
  }
  emit({now_ns, telemetry});
}

void RigExchange::take(const RigAnswer& answer, std::int64_t now_ns) {
  if (question_ == 0) {
    refuse(fmt::format("answer to {}, while nothing is asked", answer.id), now_ns);
  } else if (answer.id != question_) {
    refuse(fmt::format("answer to {}, while it is the turn of {}", answer.id, question_), now_ns);
  } else if (std::find(answers_.begin(), answers_.end(), answer.answer) == answers_.end()) {
    refuse("none of the answers that were asked for", now_ns);
  } else {
    question_ = 0;
    emit({now_ns, answer});
  }
}

void RigExchange::take(const RigFault& fault, std::int64_t now_ns) {
  const std::string words = "the rig says: " + ascii_quote(fault.cause);
  if (!fault.id) {
    emit({now_ns, fault});
    end(RigFailure::rig_fault, words, now_ns, "the rig reports a fault");
    return;
  }
  if (question_ != 0 && *fault.id == question_) {
    emit({now_ns, fault});
    void_question(RigFailure::rig_fault, words, now_ns);
    return;
  }
  if (std::string why = wrong_state("fault", *fault.id, true); !why.empty()) {
    refuse(std::move(why), now_ns);
    return;
  }
  emit({now_ns, fault});
  void_presentation(RigFailure::rig_fault, words, now_ns);
  rest();
}

void RigExchange::take(const RigAlive& alive, std::int64_t now_ns) {
  if (alive.n <= alive_heard_ || alive.n > alive_said_) {
    refuse(fmt::format("alive {}, and the program's newest is {}, the rig's {}", alive.n, alive_said_, alive_heard_),
           now_ns);
    return;
  }
  keep_slowest(now_ns);
  for (; alive_heard_ < alive.n; ++alive_heard_, ++traffic_.answered) alive_unanswered_.pop_front();
  if (state_ == State::due) say_present(now_ns);
}

// The age of the oldest `alive` without an answer; while the rig presents, at most the time since "present".
std::int64_t RigExchange::unanswered_ns(std::int64_t now_ns) const {
  return alive_unanswered_.empty() ? 0 : now_ns - std::max(alive_unanswered_.front(), presented_ns_);
}

void RigExchange::keep_slowest(std::int64_t now_ns) {
  double& slowest_ms = presented_ns_ != 0 ? traffic_.slowest_presenting_ms : traffic_.slowest_waiting_ms;
  slowest_ms = std::max(slowest_ms, milliseconds(unanswered_ns(now_ns)));
}

// Only a rig that is told to present, and has not said `done`, must answer within a tenth of a second: then it is
// stopped, and has the time of every stop. Else it is in nobody's way, and may be busy for a while.
void RigExchange::judge_silence(std::int64_t now_ns) {
  keep_slowest(now_ns);
  const std::int64_t unanswered = unanswered_ns(now_ns);
  const bool at_once = state_ == State::presenting;
  if (unanswered <= nanoseconds(at_once ? time_outs_.presenting_silent_s : time_outs_.silent_s)) return;
  const std::string words =
      fmt::format("silent: it did not answer an \"alive\" of {:.0f} ms ago", milliseconds(unanswered));
  if (!at_once) {
    end(RigFailure::silent, words, now_ns);
    return;
  }
  void_presentation(RigFailure::silent, words, now_ns);
  stop_for(RigStop::fault, now_ns);
}

void RigExchange::tick(std::int64_t now_ns) {
  if (lost_ || leaving_) return;
  if (!greeted_) {
    if (now_ns - began_ns_ > nanoseconds(time_outs_.hello_s))
      end(RigFailure::no_hello,
          refused_lines_.empty()
              ? fmt::format("no hello within {:g} s", time_outs_.hello_s)
              : fmt::format("no hello that can be taken within {:g} s; the last line was refused: {}",
                            time_outs_.hello_s, refused_lines_.back().why),
          now_ns, fmt::format("no hello that can be taken within {:g} s", time_outs_.hello_s));
    return;
  }
  judge_silence(now_ns);
  if (lost_) return;
  if (alive_said_ns_ < began_ns_ || now_ns - alive_said_ns_ >= kRigAliveEvery_ns) {
    output_ += alive_line(++alive_said_);
    alive_said_ns_ = now_ns;
    alive_unanswered_.push_back(now_ns);
  }
  if (!engaged() || state_ == State::ready || now_ns <= deadline_ns_) return;
  switch (state_) {
    case State::preparing:
      void_presentation(RigFailure::not_ready,
                        fmt::format("not ready within {:g} s", std::max(time_outs_.prepare_s, hello_->ready_s)),
                        now_ns);
      stop_for(RigStop::time_out, now_ns);
      break;
    case State::due:
      void_presentation(RigFailure::silent,
                        fmt::format("silent: for {:g} s it answered no \"alive\" within {:.0f} ms", time_outs_.silent_s,
                                    1000 * time_outs_.presenting_silent_s),
                        now_ns);
      stop_for(RigStop::fault, now_ns);
      break;
    case State::presenting:
      void_presentation(RigFailure::time_out, fmt::format("no \"done\" within {:g} s", request_.time_out_s), now_ns);
      stop_for(RigStop::time_out, now_ns);
      break;
    case State::stopping:
      end(RigFailure::not_stopped, fmt::format("no \"done\" within {:.0f} ms of \"stop\"", 1000 * time_outs_.stop_s),
          now_ns);
      break;
    default:
      break;
  }
}

void RigExchange::end(RigFailure failure, std::string_view words, std::int64_t now_ns, std::string_view sealed) {
  if (lost_) return;
  if (engaged() || question_ != 0) output_ += stop_line(0, RigStop::fault);
  void_presentation(failure, std::string(words), now_ns);
  void_question(failure, std::string(words), now_ns);
  rest();
  lost_ = RigLost{failure, std::string(words), std::string(sealed.empty() ? words : sealed)};
  emit({now_ns, *lost_});
}

std::string RigExchange::take_output() {
  return std::exchange(output_, {});
}

std::uint64_t RigExchange::prepare(const RenderRequest& request, std::int64_t now_ns, std::string& why) {
  why = idle() && question_ == 0 ? rig_request_problem(request, *hello_) : "the rig is not ready for a presentation";
  if (!why.empty()) return 0;
  id_ = ++last_id_;
  request_ = request;
  voided_ = false;
  state_ = State::preparing;
  contacts_ = 0;
  deadline_ns_ = now_ns + nanoseconds(std::max(time_outs_.prepare_s, hello_->ready_s));
  output_ += prepare_line(id_, request_);
  return id_;
}

bool RigExchange::present(std::uint64_t id, std::int64_t now_ns) {
  if (lost_ || state_ != State::ready || id != id_) return false;
  state_ = State::due;
  deadline_ns_ = now_ns + nanoseconds(time_outs_.silent_s);
  say_present(now_ns);
  return true;
}

void RigExchange::give_up(std::uint64_t id, std::int64_t now_ns) {
  if (lost_ || state_ != State::preparing || id != id_) return;
  void_presentation(RigFailure::not_ready,
                    fmt::format("not ready when its turn came: by its hello it needs at most {:g} s (\"ready_s\")",
                                std::max(hello_->ready_s, time_outs_.ready_s)),
                    now_ns);
  stop_for(RigStop::time_out, now_ns);
}

void RigExchange::say_present(std::int64_t now_ns) {
  if (unanswered_ns(now_ns) > nanoseconds(time_outs_.presenting_silent_s)) return;
  state_ = State::presenting;
  presented_ns_ = now_ns;
  deadline_ns_ = now_ns + nanoseconds(request_.time_out_s);
  output_ += present_line(id_, request_);
}

std::uint64_t RigExchange::ask(const std::vector<std::string>& answers, std::int64_t /*now_ns*/) {
  if (!idle() || question_ != 0 || !hello_->answers || answers.empty()) return 0;
  question_ = ++last_id_;
  answers_ = answers;
  output_ += ask_line(question_, answers_);
  return question_;
}

void RigExchange::stop(RigStop reason, std::int64_t now_ns) {
  if (lost_) return;
  if (question_ != 0) {
    output_ += stop_line(question_, reason);
    void_question(RigFailure::stopped, fmt::format("withdrawn ({})", word_of(kRigStopWords, reason)), now_ns);
  }
  if (!engaged() && reason == RigStop::emergency && greeted_) output_ += stop_line(0, reason);
  if (!engaged() || state_ == State::stopping) return;
  // What has not begun has nothing that could be enough.
  if (reason != RigStop::enough || state_ != State::presenting)
    void_presentation(RigFailure::stopped, fmt::format("stopped ({})", word_of(kRigStopWords, reason)), now_ns);
  stop_for(reason, now_ns);
}

void RigExchange::bye() {
  if (lost_ || leaving_) return;
  leaving_ = true;
  output_ += bye_line();
}

std::vector<RigEvent> RigExchange::take_events() {
  std::vector<RigEvent> events(std::make_move_iterator(events_.begin()), std::make_move_iterator(events_.end()));
  events_.clear();
  return events;
}

void RigExchange::refuse(std::string why, std::int64_t now_ns) {
  ++traffic_.refused;
  const bool secret = !token_.empty() && line_.find(token_) != std::string_view::npos;
  RigLineRefused refused{secret ? "(a line with the token)" : ascii_quote(line_), std::move(why)};
  if (refused_lines_.size() == kRefusedLinesKept) refused_lines_.pop_front();
  refused_lines_.push_back(refused);
  emit({now_ns, std::move(refused)});
  if (refused_lately_ == 0 || now_ns - refused_since_ns_ > kSecond_ns) {
    refused_since_ns_ = now_ns;
    refused_lately_ = 0;
  }
  if (++refused_lately_ > kMostRefusedLines)
    end(RigFailure::babbling,
        fmt::format("{} lines refused within a second, the last: {}", refused_lately_, refused_lines_.back().why),
        now_ns, fmt::format("{} lines refused within a second", refused_lately_));
}

void RigExchange::void_presentation(RigFailure failure, std::string words, std::int64_t now_ns) {
  if (!engaged() || voided_) return;
  voided_ = true;
  ++traffic_.voided;
  emit({now_ns, RigVoid{id_, failure, std::move(words)}});
}

void RigExchange::void_question(RigFailure failure, const std::string& words, std::int64_t now_ns) {
  if (question_ == 0) return;
  emit({now_ns, RigVoid{std::exchange(question_, 0), failure, words}});
}

// A rig that is stopped says `done`, also where it was only getting ready.
void RigExchange::stop_for(RigStop reason, std::int64_t now_ns) {
  state_ = State::stopping;
  deadline_ns_ = now_ns + nanoseconds(time_outs_.stop_s);
  output_ += stop_line(id_, reason);
}

// What decides about a presentation is never dropped: there is a handful of it for each.
void RigExchange::emit(RigEvent event) {
  const bool may_drop = std::holds_alternative<RigTelemetry>(event.what) ||
                        std::holds_alternative<RigLineRefused>(event.what) ||
                        std::holds_alternative<RigContact>(event.what);
  if (may_drop && events_.size() >= kMostRigEvents) {
    ++traffic_.dropped;
    return;
  }
  events_.push_back(std::move(event));
}

}  // namespace jnd
