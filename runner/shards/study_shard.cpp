#include "runner/shards/study_shard.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/words.h"
#include "data/files/draft.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_text.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/version.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;

constexpr std::string_view kFormat = "jnd shard 2";
constexpr std::size_t kMostBytes = std::size_t{1} << 30U;  // of a file: the tables of thousands of studies

constexpr auto kShardKindWords =
    words<ShardKind>({{"jnd plan --power", ShardKind::power}, {"jnd simulate --studies", ShardKind::simulate}});

std::string name_of(const std::filesystem::path& file) {
  return printable(file.string());
}

std::filesystem::path part_of(const std::filesystem::path& file) {
  return file.string() + ".part";
}

void write_whole(const std::filesystem::path& file, const std::string& text) {
  Draft draft(file, Draft::What::file, Draft::Access::everyone);
  draft.write(text);
  draft.replace([](const std::filesystem::path&) {});
}

// What the second differs in from the first; empty where they are of the same studies.
std::string difference(const StudyShard& first, const StudyShard& second) {
  if (first.kind != second.kind)
    return fmt::format("of {}, and the first of {}", word_of(kShardKindWords, second.kind),
                       word_of(kShardKindWords, first.kind));
  if (first.program != second.program)
    return fmt::format("of version {} of the program, and the first of {}", second.program, first.program);
  if (first.protocol.sha256 != second.protocol.sha256) return "of another protocol than the first";
  for (const auto& [key, value] : first.question.items()) {
    const ordered_json other = second.question.value(key, ordered_json());
    if (other != value)
      return fmt::format("of another question than the first: {} is {} and not {}", key, other.dump(), value.dump());
  }
  if (first.of != second.of) return fmt::format("one of {} shards, and the first one of {}", second.of, first.of);
  return "";
}

// What was done of the same shard before; none where there is nothing that can be used.
std::optional<StudyShard> begun(const std::filesystem::path& part, const StudyShard& empty) {
  if (!std::filesystem::exists(part)) return std::nullopt;
  try {
    StudyShard shard = read_shard(part);
    const bool same =
        difference(empty, shard).empty() && shard.number == empty.number && shard.range.first == empty.range.first;
    return same ? std::optional(std::move(shard)) : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;  // half written: it begins anew
  }
}

// The files by the number of their shard, each of which is read once and fits the others.
std::vector<std::filesystem::path> in_order(std::span<const std::filesystem::path> files) {
  std::optional<StudyShard> first;
  std::vector<std::filesystem::path> ordered;
  for (const std::filesystem::path& file : files) {
    StudyShard shard = read_shard(file);
    if (first)
      if (const std::string other = difference(*first, shard); !other.empty())
        throw InputError(fmt::format("{}: is {} (combine the shards of the same studies)", name_of(file), other));
    if (shard.range.first != shard.whole_range().first || shard.range.last != shard.whole_range().last)
      throw InputError(fmt::format("{}: is not a finished shard (run the command that makes it again)", name_of(file)));
    ordered.resize(static_cast<std::size_t>(shard.of));
    std::filesystem::path& place = ordered[static_cast<std::size_t>(shard.number - 1)];
    if (!place.empty())
      throw InputError(
          fmt::format("{}: is shard {}, and so is {} (give one of them)", name_of(file), shard.number, name_of(place)));
    place = file;
    shard.result = {};
    if (!first) first = std::move(shard);
  }
  std::string missing;
  int count = 0;
  for (std::size_t i = 0; i < ordered.size(); ++i)
    if (ordered[i].empty() && ++count <= 10) missing += fmt::format("{}{}", missing.empty() ? "" : ", ", i + 1);
  if (count > 10) missing += fmt::format(" and {} more", count - 10);
  if (count > 0)
    throw InputError(fmt::format("shard{} {} of {} {} missing (make {}, or give {})", count == 1 ? "" : "s", missing,
                                 ordered.size(), count == 1 ? "is" : "are", count == 1 ? "it" : "them",
                                 count == 1 ? "its file" : "their files"));
  return ordered;
}

}  // namespace

StudyRange shard_range(std::int64_t studies, int number, int of) noexcept {
  return {studies * (number - 1) / of, studies * number / of};
}

std::int64_t StudyShard::studies() const {
  return question.at("studies").get<std::int64_t>();
}

StudyRange StudyShard::whole_range() const {
  return shard_range(studies(), number, of);
}

StudyShard empty_shard(ShardKind kind, const Protocol& protocol, ordered_json question, int number, int of) {
  StudyShard shard{kind, std::string(kVersion), protocol, std::move(question), number, of, {}, {}};
  shard.range.first = shard.range.last = shard.whole_range().first;
  return shard;
}

std::string shard_text(const StudyShard& shard) {
  ordered_json json = {{"format", kFormat},
                       {"program", shard.program},
                       {"protocol", shard.protocol.name},
                       {"protocol_sha256", shard.protocol.sha256},
                       {"protocol_bytes", shard.protocol.bytes},
                       {"made_by", word_of(kShardKindWords, shard.kind)},
                       {"question", shard.question},
                       {"shard", shard.number},
                       {"shards", shard.of},
                       {"first", shard.range.first},
                       {"last", shard.range.last},
                       {"result", shard.result}};
  json["sha256"] = sha256_hex(json.dump());
  return json.dump(1) + "\n";
}

std::int64_t whole_number(const ordered_json& value, std::int64_t least, std::int64_t most) {
  const std::int64_t number = value.is_number_integer() ? value.get<std::int64_t>() : -1;  // negative if it is larger
  if (number < least || number > most) throw ordered_json::out_of_range::create(406, "not such a number", nullptr);
  return number;
}

StudyShard read_shard(const std::filesystem::path& file) {
  const auto no_shard = [&] {
    return InputError(
        fmt::format("{}: is not a shard of simulated studies (give the files that --to has written)", name_of(file)));
  };
  try {
    ordered_json json = json_from(read_input_file(file, kMostBytes));
    if (json.at("format") != kFormat) throw no_shard();
    const auto hash = json.at("sha256").get<std::string>();
    json.erase("sha256");
    if (sha256_hex(json.dump()) != hash)
      throw InputError(fmt::format("{}: is not as it was written (make it again)", name_of(file)));
    StudyShard shard;
    const auto kind = value_of(kShardKindWords, json.at("made_by").get<std::string>());
    if (!kind) throw no_shard();
    shard.kind = *kind;
    json.at("program").get_to(shard.program);
    shard.of = static_cast<int>(whole_number(json.at("shards"), 1, kMostStudyShards));
    shard.number = static_cast<int>(whole_number(json.at("shard"), 1, shard.of));
    shard.protocol =
        parse_protocol(json.at("protocol_bytes").get<std::string>(), json.at("protocol").get<std::string>() + ".json");
    shard.question = std::move(json.at("question"));
    const std::int64_t studies = whole_number(shard.question.at("studies"), 1, std::numeric_limits<int>::max());
    shard.range = {whole_number(json.at("first"), 0, studies), whole_number(json.at("last"), 0, studies)};
    shard.result = std::move(json.at("result"));
    return shard;
  } catch (const nlohmann::json::exception&) {
    throw no_shard();
  }
}

ShardEnd make_shard(const StudyShard& empty, const std::filesystem::path& file, const ShardWork& work,
                    const std::function<void(std::int64_t)>& progress) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point time) { return std::chrono::duration<double>(Clock::now() - time).count(); };
  const Clock::time_point start = Clock::now();
  const StudyRange all = empty.whole_range();
  if (std::filesystem::exists(file)) {
    const StudyShard there = read_shard(file);
    const std::string other = difference(empty, there);
    if (!other.empty() || there.number != empty.number)
      throw InputError(fmt::format("{}: is there already, and {} (give another name)", name_of(file),
                                   other.empty() ? fmt::format("is shard {}", there.number) : "is " + other));
    return ShardEnd::was_there;
  }
  const std::filesystem::path part = part_of(file);
  StudyShard shard = begun(part, empty).value_or(empty);
  std::int64_t next = 1;  // studies until the next file
  while (shard.range.last < all.last || shard.result.is_null()) {
    const Clock::time_point begin = Clock::now();
    const StudyRange range{shard.range.last, std::min(all.last, shard.range.last + next)};
    ordered_json result = work.result(range, [&](std::int64_t done) {
      if (progress) progress(range.first - all.first + done);
    });
    if (shard.result.is_null())
      shard.result = std::move(result);
    else
      work.add(shard.result, result);
    shard.range.last = range.last;
    const double took = since(begin);
    // A file that grows is written more and more rarely, so that all these writes together grow as the file does.
    const double between_s = std::max(10.0, since(start) / 10);
    if (range.last < all.last && (took > between_s / 2 || next > 1)) write_whole(part, shard_text(shard));
    next = std::max<std::int64_t>(
        1, took > between_s / 4 ? static_cast<std::int64_t>(static_cast<double>(next) * between_s / took) : next * 4);
  }
  write_whole(file, shard_text(shard));
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  return ShardEnd::made;
}

void for_each_shard(std::span<const std::filesystem::path> files, const std::function<void(StudyShard)>& take) {
  for (const std::filesystem::path& file : in_order(files)) take(read_shard(file));
}

}  // namespace jnd
