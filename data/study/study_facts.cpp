#include "data/study/study_facts.h"

#include <optional>

#include <fmt/format.h>

#include "data/log/body_numbers.h"
#include "data/log/event_body.h"
#include "data/study/schema.h"
#include "data/study/study_impl.h"
#include "protocols/input/json_text.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

// Calls with(event) for every event that the body of a study.merged or study.recovered keeps.
template <typename With>
void for_kept_events(const Json& body, With&& with) {
  const auto each = [&](const Json& holder, const char* key) {
    const auto found = holder.find(key);
    if (found == holder.end() || !found->is_array()) return;
    for (const Json& event : *found)
      if (event.is_object()) with(event);
  };
  if (!body.is_object()) return;
  each(body, "study_events");
  each(body, "study_events_unchained");
  if (const auto sources = body.find("sources"); sources != body.end() && sources->is_array())
    for (const Json& source : *sources) each(source, "study_events");
}

bool tells_of_origin(std::string_view kind) {
  return kind == event_kind::kMerged || kind == event_kind::kRecovered;
}

Json kept_body(const Json& event) {
  return json_if_valid(event.value("body", ""));
}

// The bodies that tell where the file came from, down to the first studies: what the second event of the chain says,
// and what the chains that it keeps say. A later one adds nothing to them: appending one excuses no problem.
void add_origins(const Json& body, std::set<std::string>& origins) {
  if (!body.is_object()) return;
  Json plain = body;
  plain.erase("source");  // a merge notes where it was imported from
  if (!origins.insert(plain.dump()).second) return;
  for_kept_events(body, [&](const Json& event) {
    if (tells_of_origin(event.value("kind", ""))) add_origins(kept_body(event), origins);
  });
}

class Gathering {
 public:
  Gathering(SQLite::Database& database, const StudyInfo& info, std::vector<Problem>& problems)
      : database_(database), info_(info), problems_(problems) {
    facts_.seeds.insert(std::to_string(info.seed));
    facts_.protocols.insert(info.protocol_sha256);
    facts_.protocol_names[info.protocol_sha256] = info.protocol_name;
  }

  StudyFacts gather() {
    SQLite::Statement query(database_, "SELECT seq, kind, body, hash FROM event WHERE session = ? ORDER BY seq");
    query.bind(1, kStudyChain);
    while (query.executeStep()) {
      const std::int64_t seq = query.getColumn(0).getInt64();
      const std::string kind = query.getColumn(1).getString();
      facts_.hashes.insert(query.getColumn(3).getString());
      try {
        take(seq, kind, json_from(query.getColumn(2).getString()));
      } catch (const Json::exception& error) {
        problem(seq, kind, fmt::format("the body cannot be read: {}", error.what()), Reveals::plan);
      }
    }
    return std::move(facts_);
  }

 private:
  void problem(std::int64_t seq, std::string_view kind, const std::string& what, Reveals reveals = Reveals::nothing) {
    const std::string where = fmt::format("Session {}, event {} ({})", kStudyChain, seq, kind);
    problems_.push_back({where, fmt::format("{}: {}.", where, what), reveals});
  }

  void take(std::int64_t seq, const std::string& kind, const Json& body) {
    if (kind == event_kind::kStudyCreated) {
      check_created(body);
    } else if (kind == event_kind::kSessionClosed) {
      const auto session = body.at("session").get<std::string>();
      if (!facts_.heads.emplace(session, body.at("head").get<std::string>()).second)
        problems_.push_back({"Session " + session,
                             fmt::format("Session {}: was closed twice in the study's own events.", session),
                             Reveals::nothing});
    } else if (tells_of_origin(kind)) {
      take_origin(seq, kind, body);
    } else if (kind == event_kind::kReworded) {
      const auto sha256 = body.at("sha256").get<std::string>();
      facts_.protocols.insert(sha256);
      if (body.contains("name")) facts_.protocol_names[sha256] = body.at("name").get<std::string>();
    } else if (kind == event_kind::kExcluded) {
      facts_.excluded[{body.at("kind").get<std::string>(), body.at("participant").get<std::string>()}] =
          body.at("replace").get<bool>();
    }
  }

  // The tables beside the chain say the same.
  void check_created(const Json& body) {
    const auto differ = [&](std::string_view what, const std::string& stored, const char* key, Reveals reveals) {
      const auto created = body.at(key).get<std::string>();
      if (stored != created)
        problems_.push_back({"The study",
                             fmt::format("The study's {} {}, but study.created says {}.", what, stored, created),
                             reveals});
    };
    differ("seed is", std::to_string(info_.seed), "seed", Reveals::plan);
    differ("protocol is", info_.protocol_sha256, "protocol_sha256", Reveals::nothing);
    differ("protocol is called", info_.protocol_name, "protocol_name", Reveals::nothing);
  }

  void take_origin(std::int64_t seq, const std::string& kind, const Json& body) {
    if (seq == 2) add_origins(body, origins_);
    Json plain = body;
    plain.erase("source");
    if (!origins_.contains(plain.dump())) {
      problem(seq, kind, "says where the study came from, but it is not how this file began; it has no effect");
      return;
    }
    for (const Json& seed : body.at("seeds")) facts_.seeds.insert(seed.get<std::string>());
    if (kind == event_kind::kRecovered) {  // a study whose own chain was lost
      for (const Json& sha256 : body.at("protocols")) facts_.protocols.insert(sha256.get<std::string>());
      add_lost(body);
    } else {
      for (const Json& source : body.at("sources"))
        facts_.protocol_names.emplace(source.at("protocol_sha256").get<std::string>(),
                                      source.at("protocol_name").get<std::string>());
    }
    add_kept_hashes(body, facts_.hashes, facts_.chain_lost);
  }

  void add_lost(const Json& body) {
    if (!body.contains("telemetry_lost")) return;
    for (const Json& one : body.at("telemetry_lost"))
      facts_.telemetry_lost.insert(telemetry_key(one.at("session").get<std::string>(),
                                                 whole_at<std::int64_t>(one, "seq"), whole_at(one, "interval")));
  }

  SQLite::Database& database_;
  const StudyInfo& info_;
  std::vector<Problem>& problems_;
  StudyFacts facts_;
  std::set<std::string> origins_;  // bodies
};

}  // namespace

StudyFacts study_facts(SQLite::Database& database, const StudyInfo& info, std::vector<Problem>& problems) {
  return Gathering(database, info, problems).gather();
}

void add_kept_hashes(const Json& body, std::set<std::string>& hashes, bool& chain_lost) {
  if (!body.is_object()) return;
  if (const auto lost = body.find("study_events_lost"); lost != body.end() && lost->is_boolean())
    chain_lost = chain_lost || lost->get<bool>();
  for_kept_events(body, [&](const Json& event) {
    hashes.insert(event.value("hash", ""));
    if (tells_of_origin(event.value("kind", ""))) add_kept_hashes(kept_body(event), hashes, chain_lost);
  });
}

std::string telemetry_key(std::string_view session, std::int64_t seq, int interval) {
  return fmt::format("{}/{}/{}", session, seq, interval);
}

std::set<std::string> lost_in_recovery(const Study& study) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  return with_storage_errors(impl.path, [&] {
    std::vector<Problem> ignored;
    return study_facts(impl.database(), impl.info, ignored).telemetry_lost;
  });
}

}  // namespace jnd
