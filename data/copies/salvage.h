// What can be read of a damaged study, and which of its events follow from each other.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "data/copies/stored_rows.h"
#include "data/copies/study_writer.h"

namespace jnd {

// The events of one chain. An event is kept where its hash follows from the event before it, from the first one on: so
// nothing that was damaged, moved or made up is ever taken for an answer.
struct SalvagedChain {
  std::vector<RowPlace> kept;       // events 1, 2, 3, ...
  std::vector<RowPlace> unchained;  // one for each further number that was found: something before it is missing
  std::string head;                 // hash of the last one kept
};

class Salvage {
 public:
  // Reads everything. The bytes must live as long as this.
  Salvage(Bytes file, Bytes log);

  std::vector<std::string> sessions() const;  // all chains, the study's own too
  SalvagedChain chain(const std::string& session) const;
  // Whether there are events of more than one study: the log belongs to another one.
  bool is_mixed() const;
  // What lies at a place, as it is stored.
  StoredEvent event(const RowPlace& place) const;
  // The blob that an event's body names; none where none with its SHA-256 was found.
  std::optional<TelemetryBlob> telemetry(const TelemetryBlob& named) const;

  struct FoundProtocol {
    std::string name, bytes;
  };
  // Whole ones only, by SHA-256.
  const std::map<std::string, FoundProtocol>& protocols() const noexcept { return protocols_; }
  struct FoundStudy {
    std::string seed, protocol_sha256;
  };
  // What rows of the table `study` say.
  const std::vector<FoundStudy>& studies() const noexcept { return studies_; }

 private:
  struct Candidate {
    std::size_t print = 0;  // of what is stored, to know the same row again
    RowPlace place;
  };
  void add(StoredRow&& row);
  void follow(const std::map<std::int64_t, std::vector<Candidate>>& events, std::int64_t seq, std::string head,
              SalvagedChain& chain) const;

  StoredRows rows_;
  std::map<std::string, std::map<std::int64_t, std::vector<Candidate>>> events_;
  std::map<std::string, RowPlace> telemetry_;  // by the SHA-256 of its bytes
  std::map<std::string, FoundProtocol> protocols_;
  std::vector<FoundStudy> studies_;
};

}  // namespace jnd
