// The hash chain of the event log. data/README.md gives the recipe and a few lines of Python that recompute it.
#pragma once

#include <string>
#include <string_view>

#include "data/log/session_log.h"

namespace jnd {

// SHA-256, 64 hexadecimal digits, over eight fields as netstrings ("LENGTH:BYTES,", so that no two different rows have
// the same bytes): previous hash (empty for the first event), session, seq, kind, utc, monotonic_ns, version, body, all
// as stored, integers in decimal. The hash inside `event` is not read.
std::string event_hash(std::string_view previous, const Event& event, std::string_view stored_utc);

}  // namespace jnd
