#include "data/copies/salvage.h"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "data/log/chain.h"
#include "data/log/utc_time.h"
#include "data/study/schema.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

std::size_t print_of(const StoredRow& row) {
  std::size_t print = 0;
  const auto mix = [&print](std::size_t value) {
    print ^= value + 0x9E3779B97F4A7C15ULL + (print << 6U) + (print >> 2U);
  };
  for (const StoredValue& value : row.values) {
    mix(std::hash<std::string>{}(value.bytes));
    mix(std::hash<std::int64_t>{}(value.integer));
  }
  return print;
}

StoredEvent event_of(StoredRow&& row) {
  StoredEvent stored;
  Event& event = stored.event;
  event.session = std::move(row.values[0].bytes);
  event.seq = row.values[1].integer;
  event.kind = std::move(row.values[2].bytes);
  stored.utc = std::move(row.values[3].bytes);
  event.stamp.monotonic_ns = row.values[4].integer;
  event.version = std::move(row.values[5].bytes);
  event.body = std::move(row.values[6].bytes);
  event.hash = std::move(row.values[7].bytes);
  try {
    event.stamp.utc_ns = utc_ns_from(stored.utc);
  } catch (const StorageError&) {
    event.stamp.utc_ns = 0;  // the text counts, and its hash is what decides about it
  }
  return stored;
}

}  // namespace

Salvage::Salvage(Bytes file, Bytes log) : rows_(file, log) {
  rows_.each([&](StoredRow&& row) { add(std::move(row)); });
}

void Salvage::add(StoredRow&& row) {
  std::vector<StoredValue>& values = row.values;
  switch (row.table) {
    case StoredTable::event: {
      std::vector<Candidate>& candidates = events_[values[0].bytes][values[1].integer];
      const std::size_t print = print_of(row);
      if (std::none_of(candidates.begin(), candidates.end(), [&](const Candidate& one) { return one.print == print; }))
        candidates.push_back({print, row.place});
      return;
    }
    case StoredTable::telemetry:
      if (!telemetry_.contains(values[3].bytes) && sha256_hex(values[6].bytes) == values[3].bytes)
        telemetry_.emplace(values[3].bytes, row.place);
      return;
    case StoredTable::protocol:
      if (sha256_hex(values[2].bytes) == values[0].bytes)
        protocols_.emplace(values[0].bytes, FoundProtocol{values[1].bytes, values[2].bytes});
      return;
    case StoredTable::study:
      studies_.push_back({values[1].bytes, values[2].bytes});
      return;
  }
}

std::vector<std::string> Salvage::sessions() const {
  std::vector<std::string> sessions;
  for (const auto& [session, events] : events_) sessions.push_back(session);
  return sessions;
}

SalvagedChain Salvage::chain(const std::string& session) const {
  SalvagedChain chain;
  const auto found = events_.find(session);
  if (found == events_.end()) return chain;
  follow(found->second, 1, {}, chain);
  const auto end = static_cast<std::int64_t>(chain.kept.size());
  for (auto next = found->second.upper_bound(end); next != found->second.end(); ++next)
    chain.unchained.push_back(next->second.back().place);
  return chain;
}

bool Salvage::is_mixed() const {
  std::set<std::string> hashes;  // of first events
  const auto own = events_.find(kStudyChain);
  if (own == events_.end() || !own->second.contains(1)) return false;
  for (const Candidate& candidate : own->second.at(1)) {
    const StoredEvent stored = event(candidate.place);
    if (event_hash({}, stored.event, stored.utc) == stored.event.hash) hashes.insert(stored.event.hash);
  }
  return hashes.size() > 1;
}

// A write that was taken back may have left another event in the place of one: what has more behind it is the one that
// was kept; of equals, the one written last.
void Salvage::follow(const std::map<std::int64_t, std::vector<Candidate>>& events, std::int64_t seq, std::string head,
                     SalvagedChain& chain) const {
  for (;; ++seq) {
    chain.head = head;
    const auto found = events.find(seq);
    if (found == events.end()) return;
    std::vector<std::pair<std::string, RowPlace>> next;  // by hash, in the order found
    for (const Candidate& candidate : found->second) {
      const StoredEvent stored = event(candidate.place);
      if (event_hash(head, stored.event, stored.utc) != stored.event.hash) continue;
      std::erase_if(next, [&](const auto& one) { return one.first == stored.event.hash; });
      next.emplace_back(stored.event.hash, candidate.place);
    }
    if (next.empty()) return;
    if (next.size() > 1) {
      std::optional<SalvagedChain> longest;
      for (const auto& [hash, place] : next) {
        SalvagedChain rest;
        rest.kept.push_back(place);
        follow(events, seq + 1, hash, rest);
        if (!longest || rest.kept.size() >= longest->kept.size()) longest = std::move(rest);
      }
      chain.kept.insert(chain.kept.end(), longest->kept.begin(), longest->kept.end());
      chain.head = longest->head;
      return;
    }
    chain.kept.push_back(next.front().second);
    head = next.front().first;
  }
}

StoredEvent Salvage::event(const RowPlace& place) const {
  std::optional<StoredRow> row = rows_.at(place);
  if (!row) throw StorageError("a row that was read cannot be read again");
  return event_of(std::move(*row));
}

std::optional<TelemetryBlob> Salvage::telemetry(const TelemetryBlob& named) const {
  const auto found = telemetry_.find(named.sha256);
  if (found == telemetry_.end()) return std::nullopt;
  std::optional<StoredRow> row = rows_.at(found->second);
  if (!row) return std::nullopt;
  TelemetryBlob blob = named;  // the event is what its hash protects
  blob.bytes = std::move(row->values[6].bytes);
  return blob;
}

}  // namespace jnd
