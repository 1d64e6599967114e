#include "runner/cluster/campaign.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <random>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "data/fields/number_text.h"
#include "data/files/draft.h"
#include "protocols/input/json_document.h"
#include "protocols/input/number_from.h"
#include "protocols/input/read_file.h"
#include "protocols/input/resources.h"
#include "protocols/input/sha256.h"
#include "protocols/version.h"
#include "runner/cluster/job_script.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

constexpr const char* kMark = "campaign.json";
constexpr const char* kProtocol = "protocol";  // a folder, so that the file keeps its name
constexpr const char* kShards = "shards";
constexpr const char* kLogs = "logs";
constexpr int kFormat = 2;
constexpr std::streamoff kTailBytes = 1 << 16;  // of a log, which may be of any length

// Options of the command that are said elsewhere.
constexpr std::array<std::string_view, 3> kOfShards = {"--shard", "--to", "--threads"};
constexpr std::array<std::string_view, 5> kOfCombine = {"--json", "--csv", "--replace", "--figure", "--ademp"};
// What is cut in shards: a command, and the option that makes many studies of it.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kCommands = {
    {{"plan", "--power"}, {"simulate", "--studies"}}};

fs::path normal(const fs::path& folder) {
  fs::path path = fs::absolute(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

// A file of the user's that is to be in the folder under the same name, so that it is found from there.
void add_file(std::vector<CampaignFile>& files, const std::string& name) {
  std::error_code missing;
  if (name.empty() || !names_a_file(name) || !fs::is_regular_file(name, missing)) return;
  const fs::path path = fs::path(name).lexically_normal();
  if (path.is_absolute()) return;  // found from everywhere
  const std::string first = path.begin()->string();
  if (first == "..")
    throw UsageError(fmt::format(
        "{} is not below this folder, so it cannot be copied to where it would be found: start jnd cluster in a folder "
        "above it, or name it with its whole path",
        name));
  constexpr std::array<std::string_view, 6> kTaken = {kMark,     kShards,           kLogs,
                                                      kProtocol, Campaign::kScript, Campaign::kLoop};
  if (std::find(kTaken.begin(), kTaken.end(), first) != kTaken.end())
    throw UsageError(fmt::format("{}: the campaign's folder has a file of that name of its own; rename yours", name));
  if (std::any_of(files.begin(), files.end(), [&](const CampaignFile& one) { return one.name == path.string(); }))
    return;
  files.push_back({path.string(), read_input_file(path)});
}

// What a protocol's texts name: the description of its rig, its objects.
void add_files_named_in(const JsonNode& node, std::vector<CampaignFile>& files) {
  if (node.kind == JsonNode::Kind::string) add_file(files, node.text);
  for (const JsonNode& item : node.items) add_files_named_in(item, files);
}

std::string option_name(const std::string& argument) {
  return argument.substr(0, argument.find('='));
}

std::string fresh_name() {
  std::random_device random;
  return fmt::format("jnd-{:08x}", random());
}

bool is_name(std::string_view name) {
  return name.starts_with("jnd-") && name.size() == 12 &&
         name.find_first_not_of("0123456789abcdef", 4) == std::string_view::npos;
}

// The protocol comes first, in a folder of its own; none leads out of the campaign's.
bool are_within(const std::vector<CampaignFile>& files) {
  return !files.empty() && files.front().name.starts_with(fmt::format("{}/", kProtocol)) &&
         std::none_of(files.begin(), files.end(), [](const CampaignFile& one) {
           const fs::path path = one.name;
           return path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end();
         });
}

void write_file(const fs::path& path, std::string_view bytes, bool program) {
  Draft draft(path, Draft::What::file, Draft::Access::everyone);
  draft.write(bytes);
  if (program) {  // whoever may read it may run it
    const auto may = static_cast<unsigned>(fs::status(draft.path()).permissions());
    fs::permissions(draft.path(), static_cast<fs::perms>((may & 0444U) >> 2U), fs::perm_options::add);
  }
  draft.replace([](const fs::path&) {});
}

[[noreturn]] void damaged(const fs::path& file) {
  throw InputError(fmt::format("{}: damaged: it is not as jnd cluster writes it; remove the folder and make it anew",
                               file.string()));
}

const JsonNode& member(const JsonNode& node, std::string_view key, JsonNode::Kind kind, const fs::path& file) {
  const JsonNode* const found = node.find(key);
  if (found == nullptr || found->kind != kind) damaged(file);
  return *found;
}

const std::string& text_in(const JsonNode& node, const fs::path& file) {
  if (node.kind != JsonNode::Kind::string) damaged(file);
  return node.text;
}

std::string text_of(const JsonNode& node, std::string_view key, const fs::path& file) {
  return member(node, key, JsonNode::Kind::string, file).text;
}

int whole_of(const JsonNode& node, std::string_view key, const fs::path& file) {
  const auto number = number_from<int>(member(node, key, JsonNode::Kind::number, file).text);
  if (!number) damaged(file);
  return *number;
}

std::vector<std::string> texts_of(const JsonNode& node, std::string_view key, const fs::path& file) {
  std::vector<std::string> texts;
  for (const JsonNode& item : member(node, key, JsonNode::Kind::array, file).items)
    texts.push_back(text_in(item, file));
  return texts;
}

std::string words_text(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + shell_quoted(word);
  return text.empty() ? "none" : text;
}

// Of the files of one shard: "7.json" -> 7.
std::optional<int> shard_of(const fs::path& file) {
  return file.extension() == ".json" ? number_from<int>(file.stem().string()) : std::nullopt;
}

}  // namespace

CampaignJob Campaign::job_of(const std::vector<std::string>& words, int shards) {
  const auto has = [&words](std::string_view option) {
    return std::any_of(words.begin(), words.end(),
                       [option](const std::string& word) { return option_name(word) == option; });
  };
  if (words.size() < 2 || words[1].starts_with("-") ||
      std::none_of(kCommands.begin(), kCommands.end(),
                   [&](const auto& one) { return words[0] == one.first && has(one.second); }))
    throw UsageError(
        "behind -- stands what is to be run: plan PROTOCOL --power ..., or simulate PROTOCOL --studies N ..., the protocol "
        "first");
  if (shards < 1) throw UsageError("--shards says into how many parts the studies are cut");
  CampaignJob job{shards, words[0], {words.begin() + 2, words.end()}, {}};
  const fs::path place = find_resource(Resource::protocol, words[1]);
  const std::string protocol = read_input_file(place);
  job.files.push_back({(fs::path(kProtocol) / place.filename()).string(), protocol});
  add_files_named_in(parse_json(protocol, words[1]), job.files);
  for (const std::string& argument : job.arguments) {
    const std::string name = option_name(argument);
    const auto is_among = [&name](const auto& names) {
      return std::find(names.begin(), names.end(), name) != names.end();
    };
    if (is_among(kOfShards)) throw UsageError(fmt::format("{} is set for every shard: leave it out", name));
    if (is_among(kOfCombine))
      throw UsageError(
          fmt::format("{} is for when the shards are combined: FOLDER/{} combine {} ...", name, kScript, name));
    add_file(job.files, argument);
    if (name.size() < argument.size()) add_file(job.files, argument.substr(name.size() + 1));
  }
  return job;
}

Campaign Campaign::make(const fs::path& folder, const CampaignJob& job, const CampaignSettings& settings) {
  Campaign campaign;
  campaign.folder_ = normal(folder);
  campaign.name_ = fresh_name();
  campaign.shards_ = job.shards;
  campaign.command_ = job.command;
  campaign.arguments_ = job.arguments;
  for (const CampaignFile& file : job.files) campaign.hashes_.push_back({file.name, sha256_hex(file.bytes)});
  campaign.settings_ = settings;
  std::error_code error;
  if (fs::is_directory(campaign.folder_, error)) fs::remove(campaign.folder_, error);  // where it is empty
  fs::create_directories(campaign.folder_.parent_path(), error);
  Draft draft(campaign.folder_, Draft::What::folder, Draft::Access::everyone);
  for (const CampaignFile& file : job.files) draft.write_within(file.name, file.bytes);
  draft.write_within(kMark, campaign.text());
  if (!draft.publish())
    throw UsageError(fmt::format("{}: something stands there already; choose another name", campaign.folder_.string()));
  campaign.write_scripts();
  campaign.make_rooms();
  return campaign;
}

std::optional<Campaign> Campaign::open(const fs::path& folder) {
  Campaign campaign;
  campaign.folder_ = normal(folder);
  std::error_code error;
  const fs::file_status status = fs::status(campaign.folder_, error);
  if (status.type() == fs::file_type::not_found) return std::nullopt;
  if (!fs::is_directory(status)) throw UsageError(fmt::format("{} is not a folder", campaign.folder_.string()));
  const fs::path file = campaign.folder_ / kMark;
  if (!fs::exists(file, error)) {
    if (fs::is_empty(campaign.folder_, error)) return std::nullopt;
    throw UsageError(fmt::format("{}: this folder has files of something else in it; choose another name",
                                 campaign.folder_.string()));
  }
  const JsonNode root = parse_json(read_input_file(file), file.string());
  if (whole_of(root, "jnd_cluster", file) != kFormat) damaged(file);
  campaign.name_ = text_of(root, "name", file);
  campaign.shards_ = whole_of(root, "shards", file);
  campaign.command_ = text_of(root, "command", file);
  if (!is_name(campaign.name_) || campaign.shards_ < 1 || campaign.shards_ > kMostShards ||
      std::none_of(kCommands.begin(), kCommands.end(), [&](const auto& one) { return campaign.command_ == one.first; }))
    damaged(file);
  campaign.arguments_ = texts_of(root, "arguments", file);
  const JsonNode& files = member(root, "files", JsonNode::Kind::object, file);
  for (std::size_t i = 0; i < files.keys.size(); ++i)
    campaign.hashes_.push_back({files.keys[i], text_in(files.items[i], file)});
  if (!are_within(campaign.hashes_)) damaged(file);
  const JsonNode& how = member(root, "settings", JsonNode::Kind::object, file);
  campaign.settings_ = {text_of(how, "program", file), text_of(how, "partition", file), text_of(how, "time", file),
                        text_of(how, "account", file), text_of(how, "memory", file),    whole_of(how, "at_once", file),
                        texts_of(how, "sbatch", file), texts_of(how, "setup", file)};
  require_sbatch_words(campaign.settings_);
  for (const CampaignFile& one : campaign.hashes_)
    if (sha256_hex(read_input_file(campaign.folder_ / one.name)) != one.bytes)
      throw InputError(
          fmt::format("{}: changed since the campaign was made: its shards would not belong together. Put "
                      "it back, or make a new campaign of it in another folder",
                      (campaign.folder_ / one.name).string()));
  campaign.make_rooms();
  return campaign;
}

void Campaign::require_same(const CampaignJob& job) const {
  const auto refuse = [this](const std::string& what) {
    throw UsageError(
        fmt::format("{} holds another campaign: {}. Choose another folder for this one", folder_.string(), what));
  };
  if (job.shards != shards_) refuse(fmt::format("{}, not {}", counted(shards_, "shard"), job.shards));
  if (job.command != command_) refuse(fmt::format("its command is {}, not {}", command_, job.command));
  if (job.arguments != arguments_)
    refuse(fmt::format("the options of its {} are {}, not {}", command_, words_text(arguments_),
                       words_text(job.arguments)));
  if (job.files.size() != hashes_.size()) refuse("its protocol is another one");
  for (std::size_t i = 0; i < hashes_.size(); ++i)
    if (job.files[i].name != hashes_[i].name || sha256_hex(job.files[i].bytes) != hashes_[i].bytes)
      refuse(i == 0 ? "its protocol is another one" : fmt::format("its {} is another one", hashes_[i].name));
}

void Campaign::change(const CampaignSettings& settings) {
  const fs::path script_file = folder_ / kScript;
  std::error_code error;
  const bool there = fs::exists(script_file, error);
  if (settings == settings_ && there) return;
  if (there && read_input_file(script_file) != script())
    throw UsageError(fmt::format(
        "{} was changed by hand, so it is left as it is: change these settings there too, or remove it and try again",
        script_file.string()));
  settings_ = settings;
  write_file(folder_ / kMark, text(), false);
  write_scripts();
}

fs::path Campaign::shard_file(int shard) const {
  return folder_ / kShards / fmt::format("{}.json", shard);
}

std::set<int> Campaign::finished() const {
  std::set<int> found;
  std::error_code error;
  // The listing, because a network file system shows a new file there before it does so by name.
  for (fs::directory_iterator file(folder_ / kShards, error), end; !error && file != end; file.increment(error))
    if (const std::optional<int> shard = shard_of(file->path()); shard && *shard >= 1 && *shard <= shards_)
      found.insert(*shard);
  return found;
}

std::uintmax_t Campaign::progress(int shard) const {
  struct stat part {};
  if (stat((shard_file(shard).string() + ".part").c_str(), &part) != 0) return 0;
  constexpr std::uintmax_t kSecond = 1'000'000'000;
  return static_cast<std::uintmax_t>(part.st_mtim.tv_sec) * kSecond + static_cast<std::uintmax_t>(part.st_mtim.tv_nsec);
}

std::string Campaign::log_tail(int shard, int lines) const {
  const std::string ending = fmt::format("_{}.log", shard);
  fs::path newest;
  fs::file_time_type time{};
  std::error_code error;
  for (fs::directory_iterator file(folder_ / kLogs, error), end; !error && file != end; file.increment(error)) {
    std::error_code gone;
    const fs::file_time_type changed = file->last_write_time(gone);
    if (gone || !file->is_regular_file(gone) || !file->path().string().ends_with(ending) ||
        (!newest.empty() && changed < time))
      continue;
    newest = file->path();
    time = changed;
  }
  if (newest.empty()) return "";
  std::ifstream in(newest, std::ios::ate);
  in.seekg(std::max<std::streamoff>(0, static_cast<std::streamoff>(in.tellg()) - kTailBytes));
  std::vector<std::string> last;
  for (std::string line; std::getline(in, line);) {
    last.push_back(line);
    if (last.size() > static_cast<std::size_t>(lines)) last.erase(last.begin());
  }
  std::string text = fmt::format("{} ends with:\n", newest.string());
  if (last.empty()) text = fmt::format("{} is empty\n", newest.string());
  for (const std::string& line : last) text += "  " + line + "\n";
  return text;
}

std::string Campaign::text() const {
  OrderedJson files = OrderedJson::object();
  for (const CampaignFile& file : hashes_) files[file.name] = file.bytes;
  const OrderedJson root = {{"jnd_cluster", kFormat},
                            {"version", kVersion},
                            {"name", name_},
                            {"shards", shards_},
                            {"command", command_},
                            {"arguments", arguments_},
                            {"files", files},
                            {"settings",
                             {{"program", settings_.program},
                              {"partition", settings_.partition},
                              {"time", settings_.time},
                              {"account", settings_.account},
                              {"memory", settings_.memory},
                              {"at_once", settings_.at_once},
                              {"sbatch", settings_.sbatch},
                              {"setup", settings_.setup}}}};
  try {
    return root.dump(2) + "\n";
  } catch (const OrderedJson::type_error&) {
    throw UsageError("an argument is not UTF-8 text: rename the file that it names");
  }
}

std::string Campaign::script() const {
  JobScript script{name_, shards_, {command_, hashes_.front().name}, hashes_, settings_};
  script.command.insert(script.command.end(), arguments_.begin(), arguments_.end());
  return job_script(script);
}

void Campaign::write_scripts() const {
  write_file(folder_ / kScript, script(), true);
  write_file(folder_ / kLoop, loop_script(shards_), true);
}

void Campaign::make_rooms() const {
  for (const char* const room : {kShards, kLogs}) {
    std::error_code error;
    fs::create_directory(folder_ / room, error);
    if (error) throw cannot_write(folder_ / room, error.value());
  }
}

}  // namespace jnd
