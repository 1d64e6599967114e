#include "data/copies/merge_source.h"

#include <map>
#include <optional>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "data/log/event_body.h"
#include "data/study/schema.h"
#include "data/study/study_impl.h"
#include "data/verify/verify.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::vector<SourceProtocol> protocols_in(const Study& study) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  return with_storage_errors(impl.path, [&] {
    std::vector<SourceProtocol> protocols;
    SQLite::Statement query(impl.database(), "SELECT sha256, name, bytes FROM protocol ORDER BY sha256");
    while (query.executeStep())
      protocols.push_back(
          {query.getColumn(0).getString(), query.getColumn(1).getString(), query.getColumn(2).getString()});
    return protocols;
  });
}

SourceStudy open_source(const fs::path& path) {
  SourceStudy source;
  source.path = path;
  source.study = Study::open(path, Study::Access::read_only);
  source.damage = verify(*source.study).problems;
  if (!source.damage.empty()) return source;
  source.protocols = protocols_in(*source.study);
  source.own = source.study->events(kStudyChain);
  for (const SessionInfo& info : source.study->sessions()) {
    const std::vector<Event> events = source.study->events(info.id);
    const Json opened = Json::parse(events.front().body);
    source.sessions.push_back(
        {info, opened.at("seed").get<std::string>(), opened.at("protocol_sha256").get<std::string>()});
  }
  return source;
}

[[noreturn]] void refuse(const std::vector<std::string>& reasons) {
  std::string text = "these studies cannot be merged; nothing was written:";
  for (const std::string& reason : reasons) text += "\n" + reason;
  throw InputError(text);
}

// Everything that is found, so that one look shows all that is to be done.
class Conflicts {
 public:
  explicit Conflicts(const std::vector<SourceStudy>& sources) : sources_(sources) {}

  std::vector<std::string> find() {
    for (const SourceStudy& source : sources_) check_protocol(source);
    if (!reasons_.empty()) return std::move(reasons_);  // studies of their own: what they share has no meaning
    for (const SourceStudy& source : sources_)
      for (const SourceSession& session : source.sessions) check_session(source, session);
    for (const SourceStudy& source : sources_) check_exclusions(source);
    return std::move(reasons_);
  }

 private:
  using Code = std::pair<SessionKind, std::string>;
  struct Owner {
    const SourceStudy* source = nullptr;
    std::string participant;
  };

  template <typename... Arguments>
  void reason(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    reasons_.push_back(fmt::format(text, std::forward<Arguments>(arguments)...));
  }

  // JSON compared as documents: neither spaces nor the order of keys have a meaning in a protocol.
  void check_protocol(const SourceStudy& source) {
    const StudyInfo &first = sources_.front().study->info(), &info = source.study->info();
    if (info.protocol_sha256 == first.protocol_sha256 ||
        nlohmann::json::parse(info.protocol_bytes, nullptr, false) ==
            nlohmann::json::parse(first.protocol_bytes, nullptr, false))
      return;
    reason("{}: is of another protocol ({}, SHA-256 {}...) than {} ({}, {}...)", source.path.string(),
           info.protocol_name, info.protocol_sha256.substr(0, 12), sources_.front().path.string(), first.protocol_name,
           first.protocol_sha256.substr(0, 12));
  }

  void check_session(const SourceStudy& source, const SourceSession& session) {
    const SessionInfo& info = session.info;
    const auto [twin, is_new] = sessions_.emplace(info.id, &source);
    if (!is_new) {
      reason("session {} (participant {}) is in {} and in {}: the same session twice", info.id, info.participant,
             twin->second->path.string(), source.path.string());
      return;
    }
    const Owner owner{&source, info.participant};
    const auto code = codes_.emplace(Code{info.kind, info.participant}, owner).first;
    if (code->second.source != &source)
      reason("participant {} ({}) is in {} and in {}: a code stands for one person", info.participant,
             to_string(info.kind), code->second.source->path.string(), source.path.string());
    if (!info.replaced) {
      const auto number = numbers_.emplace(std::tuple{session.seed, info.kind, info.participant_number}, owner).first;
      if (number->second.source != &source)
        reason("participant number {} ({}) is {} in {} and {} in {}, with one seed: both had the same plan",
               info.participant_number, to_string(info.kind), number->second.participant,
               number->second.source->path.string(), info.participant, source.path.string());
    }
    if (info.state != "closed" && !info.excluded && session.seed != std::to_string(sources_.front().study->info().seed))
      reason(
          "session {} of participant {} in {} is still open, and nobody could go on with it in a study with another "
          "seed: finish it first, or exclude the participant, or name {} first",
          info.id, info.participant, source.path.string(), source.path.string());
  }

  void check_exclusions(const SourceStudy& source) {
    for (const Event& event : source.own) {
      if (event.kind != event_kind::kExcluded) continue;
      const Json body = Json::parse(event.body);
      const std::optional<SessionKind> kind = session_kind_from(body.value("kind", ""));
      if (!kind) continue;
      const std::string participant = body.value("participant", "");
      const auto found = codes_.find({*kind, participant});
      if (found != codes_.end() && found->second.source != &source)
        reason("{} excludes participant {} ({}), who is somebody else in {}", source.path.string(), participant,
               to_string(*kind), found->second.source->path.string());
    }
  }

  const std::vector<SourceStudy>& sources_;
  std::vector<std::string> reasons_;
  std::map<std::string, const SourceStudy*> sessions_;
  std::map<Code, Owner> codes_;
  std::map<std::tuple<std::string, SessionKind, int>, Owner> numbers_;
};

}  // namespace

void refuse_same_files(const std::vector<fs::path>& paths) {
  std::error_code ignored;
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (fs::equivalent(paths[i], paths[j], ignored))
        refuse({fmt::format("{} and {} are the same file", paths[j].string(), paths[i].string())});
}

std::vector<SourceStudy> open_sources(const std::vector<fs::path>& paths) {
  std::vector<SourceStudy> sources;
  std::vector<std::string> reasons;
  for (const fs::path& path : paths) {
    try {
      SourceStudy& source = sources.emplace_back(open_source(path));
      if (const std::size_t count = source.damage.size(); count > 0)
        reasons.push_back(fmt::format("{}: {} problem{}; jnd verify lists {}, jnd recover may help", path.string(),
                                      count, count == 1 ? "" : "s", count == 1 ? "it" : "them"));
    } catch (const StorageError& error) {
      reasons.emplace_back(error.what());
    }
  }
  if (!reasons.empty()) refuse(reasons);
  return sources;
}

void refuse_conflicts(const std::vector<SourceStudy>& sources) {
  if (const std::vector<std::string> reasons = Conflicts(sources).find(); !reasons.empty()) refuse(reasons);
}

}  // namespace jnd
