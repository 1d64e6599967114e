#include "runner/session/exploration_block.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "devices/loop/telemetry_ring.h"
#include "devices/rigs/rig_factory.h"
#include "protocols/condition_words.h"
#include "runner/session/device_health.h"
#include "runner/session/rig_connections.h"

namespace jnd {

namespace {

constexpr double kLook_s = 0.02;   // between two looks at the operator's keys while nothing is rendered
constexpr double kLeast_s = 1e-6;  // a rest of this is rounding

}  // namespace

ExplorationBlock::ExplorationBlock(const SessionParts& parts, const CourseRecorder& recorder)
    : parts_(parts), recorder_(recorder), codes_(condition_codes(parts.protocol, parts.plan.seed)) {}

void ExplorationBlock::settle_attempt(const step::SettleExploration& due) {
  void_attempt(exploration_of(parts_.protocol, due.slot, due.attempt), "interrupted", false);
}

void ExplorationBlock::explore(const step::Explore& due) {
  await_rig(parts_, recorder_, slots_done());  // told before the operator calls the participant to order
  if (ready(due.slot, due.attempt)) attempt(due.slot, due.attempt);
}

// The operator's word before an attempt. False: the slot may be over.
bool ExplorationBlock::ready(const ExplorationSlot& slot, int attempt) {
  const Condition& condition = parts_.protocol.conditions[static_cast<std::size_t>(slot.condition)];
  ExplorationOutline outline;
  outline.number = slot.index;
  outline.total = static_cast<int>(parts_.plan.explorations.size());
  outline.condition_code = codes_[static_cast<std::size_t>(slot.condition)];
  outline.object = parts_.protocol.explore->objects[static_cast<std::size_t>(slot.object)];
  outline.devices = condition.devices;
  outline.duration_s = slot.duration_s;
  outline.attempt = attempt;
  const OperatorRequest request =
      settle(parts_, recorder_, slots_done(), [&] { return parts_.view.ready_to_explore(outline); });
  if (request.kind == Request::end_block) end_block(slot.block, request.text);
  if (request.kind == Request::take_break) pause_session(parts_, recorder_, "break", request.text, slots_done());
  return request.kind == Request::go_on;
}

void ExplorationBlock::attempt(const ExplorationSlot& slot, int attempt) {
  ticks_ = {};
  asked_ = false;
  await_rig(parts_, recorder_, slots_done());
  // A stop that came before it: nothing is felt, and nothing counted, before a person has cleared it.
  handle_interrupts(parts_, recorder_, slots_done());
  recorder_.record_mark(ExplorationBegan{slot.index, attempt}, {{"index", slot.index}, {"attempt", attempt}});
  ExplorationRecord record = exploration_of(parts_.protocol, slot, attempt);
  PieceEnd end = PieceEnd::go_on;
  while (end == PieceEnd::go_on) {
    const double left_s = slot.duration_s - record.duration_s;
    if (left_s <= kLeast_s) break;
    end = record.devices ? render_piece(record, std::min(left_s, kLongestFreePiece_s)) : bare_hands(record);
  }
  parts_.rig.neutral();
  if (end == PieceEnd::voided) return;
  nlohmann::ordered_json body = to_body(record, unit());
  const std::vector<TelemetryBlob> ticks = take_ticks();
  if (!ticks.empty()) body["telemetry"] = telemetry_body(ticks);
  recorder_.record(ExplorationEnded{slot.index, attempt}, body, ticks);
  parts_.view.explored();
}

ExplorationBlock::PieceEnd ExplorationBlock::render_piece(ExplorationRecord& record, double length_s) {
  const Protocol& protocol = parts_.protocol;
  PresentRequest request;
  request.stimulus = {.stiffness = protocol.stimulus.reference,
                      .damping_n_s_per_m = protocol.stimulus.damping_n_s_per_m,
                      .cues = protocol.conditions[static_cast<std::size_t>(record.slot.condition)].cues};
  request.explore_s = request.no_contact_time_out_s = length_s;
  request.id = {record.slot.index, record.attempt, static_cast<int>(record.presentations.size())};
  request.object = record.object;
  const double left_s = record.slot.duration_s - record.duration_s;
  parts_.rig.watch([&](const LoopSnapshot& snapshot) {
    parts_.view.health(health_of(snapshot));
    // What the operator asks for is heard at once: the object lets go, and goes on after it.
    if (!still_exploring(left_s - snapshot.elapsed_s)) parts_.rig.stop.latch(StopSource::program);
  });
  record.presentations.push_back(parts_.rig.present(request));
  parts_.rig.watch({});
  Presentation& piece = record.presentations.back();
  const bool by_us = asked_ && parts_.rig.stop.clear_if(StopSource::program);
  const bool pausing =
      (parts_.interrupts.pause || parts_.interrupts.end) && piece.stopped_by == to_string(StopSource::signal);
  if (piece.fault == Fault::emergency_stop && (by_us || pausing)) piece.fault = Fault::interrupted;
  if (piece.fault == Fault::interrupted || parts_.record == RecordPolicy::off) piece.last_ticks.clear();
  if (piece.fault == Fault::no_contact) piece.fault = Fault::none;  // one may well leave the object alone
  // A piece of no length delivers nothing: without this it would be asked for for ever.
  if (piece.fault == Fault::none && !(piece.duration_s > 0)) piece.fault = Fault::device_lost;
  record.duration_s += piece.duration_s;
  keep_ticks(piece);
  parts_.view.health(health_of(piece));
  if (piece.fault != Fault::none && piece.fault != Fault::interrupted)
    return stopped(record, std::string(to_string(piece.fault)),
                   piece.fault == Fault::emergency_stop ? piece.stopped_by : std::string(),
                   counts_as_attempt(parts_, piece.fault));
  (void)still_exploring(record.slot.duration_s - record.duration_s);
  return handle_requests(record);
}

// Without devices time passes; the operator's keys and the stop are looked at all the same.
ExplorationBlock::PieceEnd ExplorationBlock::bare_hands(ExplorationRecord& record) {
  const std::int64_t began_ns = parts_.clock.now_ns();
  const double left_s = record.slot.duration_s - record.duration_s;
  parts_.clock.sleep_until_ns(began_ns + static_cast<std::int64_t>(std::ceil(1e9 * std::min(left_s, kLook_s))));
  record.duration_s += 1e-9 * static_cast<double>(parts_.clock.now_ns() - began_ns);
  if (const StopSource source = parts_.rig.stop.source(); source != StopSource::none) {
    const bool pausing = (parts_.interrupts.pause || parts_.interrupts.end) && source == StopSource::signal;
    if (!pausing) return stopped(record, std::string(to_string(Fault::emergency_stop)), std::string(to_string(source)));
  }
  (void)still_exploring(record.slot.duration_s - record.duration_s);
  return handle_requests(record);
}

bool ExplorationBlock::still_exploring(double left_s) {
  if (!parts_.view.exploring(std::max(left_s, 0.0))) asked_ = true;
  return !asked_;
}

// What the operator asked for meanwhile, and what signals ask for.
ExplorationBlock::PieceEnd ExplorationBlock::handle_requests(ExplorationRecord& record) {
  if (parts_.interrupts.end) leave(record, SessionEnds{false, "signal", {}});
  try {
    handle_interrupts(parts_, recorder_, slots_done());
    if (!asked_) return PieceEnd::go_on;
    asked_ = false;
    const OperatorRequest request = parts_.view.meanwhile();
    switch (request.kind) {
      case Request::pause:
      case Request::take_break:
        pause_session(parts_, recorder_, request.kind == Request::pause ? "key" : "break", request.text, slots_done());
        return PieceEnd::go_on;
      case Request::note:
        recorder_.note(request.text, slots_done());
        return PieceEnd::go_on;
      case Request::repeat_trial:
        record.words = request.text;
        void_attempt(record, "repeated", true);
        return PieceEnd::voided;
      case Request::end_block:
        record.ended_early = true;
        record.words = request.text;
        return PieceEnd::enough;
      case Request::end_for_now:
      case Request::end_for_good:
        throw SessionEnds{request.kind == Request::end_for_good, "operator", request.text};
      default:
        return PieceEnd::go_on;
    }
  } catch (const SessionEnds& end) {
    leave(record, end);
  }
}

ExplorationBlock::PieceEnd ExplorationBlock::stopped(ExplorationRecord& record, const std::string& reason,
                                                     const std::string& stopped_by, bool counts) {
  void_attempt(record, reason, counts);
  if (stopped_by.empty()) note_connections(parts_, recorder_, "fault");
  if (stopped_by.empty()) return PieceEnd::voided;
  recover_from_stop(parts_, recorder_, stopped_by, slots_done());
  return PieceEnd::voided;
}

void ExplorationBlock::void_attempt(const ExplorationRecord& record, const std::string& reason, bool counts) {
  const int index = record.slot.index;
  const std::map<int, int>& so_far = recorder_.course().state().exploration.used;
  const int used = (so_far.contains(index) ? so_far.at(index) : 0) + (counts ? 1 : 0);
  const bool will_repeat = used < parts_.protocol.timeline.max_attempts;
  nlohmann::ordered_json body = voided_body(record, unit(), reason, counts, will_repeat);
  const std::vector<TelemetryBlob> ticks = take_ticks();
  if (!ticks.empty()) body["telemetry"] = telemetry_body(ticks);
  parts_.rig.neutral();
  recorder_.record(ExplorationVoided{index, record.attempt, counts, will_repeat}, body, ticks);
}

// Felt, but ended by us: it comes again from its beginning, and the log knows that it was felt. Without
// a person nothing was felt.
void ExplorationBlock::leave(const ExplorationRecord& record, const SessionEnds& end) {
  parts_.rig.neutral();
  if (parts_.person) void_attempt(record, "interrupted", false);
  throw SessionEnds{end.for_good, end.cause, end.reason};
}

void ExplorationBlock::end_block(int block, const std::string& reason) {
  recorder_.record(
      BlockEnded{},
      {{"block", block}, {"practice", false}, {"reason", reason}, {"trials", nlohmann::ordered_json::array()}});
  for (const ExplorationSlot& slot : parts_.plan.explorations) {
    if (slot.block != block || recorder_.course().exploration_over(slot.index)) continue;
    const ExplorationRecord record =
        exploration_of(parts_.protocol, slot, recorder_.course().next_exploration_attempt(slot.index));
    recorder_.record(ExplorationVoided{slot.index, record.attempt, false, false},
                     voided_body(record, unit(), "block_ended", false, false));
  }
}

// Every tick of the pieces, to be stored with the attempt.
void ExplorationBlock::keep_ticks(const Presentation& presentation) {
  TelemetryRing* ring = parts_.rig.telemetry();
  if (ring == nullptr) return;
  ticks_.unit = unit();
  ticks_.channels = telemetry_channels(presentation);
  ticks_.dropped += ring->take_dropped();
  ring->drain(ticks_.ticks);
}

std::vector<TelemetryBlob> ExplorationBlock::take_ticks() {
  std::vector<TelemetryBlob> blobs;
  if (!ticks_.channels.empty()) blobs.push_back(encode_telemetry(0, ticks_));
  ticks_ = {};
  return blobs;
}

}  // namespace jnd
