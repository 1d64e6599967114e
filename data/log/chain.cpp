#include "data/log/chain.h"

#include "protocols/input/sha256.h"

namespace jnd {

namespace {

void add_netstring(std::string& text, std::string_view field) {
  text.append(std::to_string(field.size())).append(1, ':').append(field).append(1, ',');
}

}  // namespace

std::string event_hash(std::string_view previous, const Event& event, std::string_view stored_utc) {
  std::string text;
  text.reserve(event.body.size() + 256);
  add_netstring(text, previous);
  add_netstring(text, event.session);
  add_netstring(text, std::to_string(event.seq));
  add_netstring(text, event.kind);
  add_netstring(text, stored_utc);
  add_netstring(text, std::to_string(event.stamp.monotonic_ns));
  add_netstring(text, event.version);
  add_netstring(text, event.body);
  return sha256_hex(text);
}

}  // namespace jnd
