// What the operator asks for between and within trials. Each is logged with its reason.
#pragma once

#include <string>

namespace jnd {

enum class Request {
  go_on,
  pause,         // devices neutral, clock of the session stopped until the operator goes on
  repeat_trial,  // this attempt is voided and comes again at the end of its block
  void_last,     // the last answer is taken back: its trial comes again at the end of its block
  note,          // a text for the log
  end_block,     // the rest of the block is given up
  take_break,    // a break that the protocol does not ask for
  end_for_now,   // resumable
  end_for_good,  // the session is closed as it is
  stopped        // nothing; the rig's stop came first, and is to be seen to
};

struct OperatorRequest {
  Request kind = Request::go_on;
  std::string text;  // the reason, or the note
};

}  // namespace jnd
