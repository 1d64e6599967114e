// Free interaction: one attempt at one object in one condition. What comes when says the course.
#pragma once

#include <string>
#include <vector>

#include "data/log/exploration_body.h"
#include "data/log/telemetry.h"
#include "protocols/course/course.h"
#include "runner/session/course_recorder.h"
#include "runner/session/session_parts.h"

namespace jnd {

class ExplorationBlock {
 public:
  // Both must outlive it.
  ExplorationBlock(const SessionParts& parts, const CourseRecorder& recorder);
  ~ExplorationBlock() { parts_.rig.watch({}); }
  ExplorationBlock(const ExplorationBlock&) = delete;
  ExplorationBlock& operator=(const ExplorationBlock&) = delete;

  // The program was killed during the attempt: it is over, and the object comes again.
  void settle_attempt(const step::SettleExploration& due);
  // Asks the operator, and conducts the attempt where the word is to go on. An attempt that ends in a fault or an
  // emergency stop comes again, until the protocol's most attempts are used up; a pause takes nothing from its time;
  // what the operator ends early counts, with the time it really had. Throws SessionEnds, StorageError.
  void explore(const step::Explore& due);

 private:
  enum class PieceEnd { go_on, enough, voided };

  bool ready(const ExplorationSlot& slot, int attempt);
  void attempt(const ExplorationSlot& slot, int attempt);
  PieceEnd render_piece(ExplorationRecord& record, double length_s);
  PieceEnd bare_hands(ExplorationRecord& record);
  PieceEnd handle_requests(ExplorationRecord& record);
  PieceEnd stopped(ExplorationRecord& record, const std::string& reason, const std::string& stopped_by,
                   bool counts = true);
  void void_attempt(const ExplorationRecord& record, const std::string& reason, bool counts);
  [[noreturn]] void leave(const ExplorationRecord& record, const SessionEnds& end);
  void end_block(int block, const std::string& reason);
  void keep_ticks(const Presentation& presentation);
  std::vector<TelemetryBlob> take_ticks();
  bool still_exploring(double left_s);
  Unit unit() const { return parts_.protocol.stimulus.unit; }
  int slots_done() const { return recorder_.course().explorations_done(); }

  const SessionParts& parts_;
  const CourseRecorder& recorder_;
  std::vector<std::string> codes_;
  bool asked_ = false;  // the view wants the operator's request to be heard
  Telemetry ticks_;     // of the present attempt
};

}  // namespace jnd
