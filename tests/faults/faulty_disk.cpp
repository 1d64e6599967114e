#include "tests/faults/faulty_disk.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

namespace jnd::test {

using Bytes = std::vector<char>;

// A change of a file since its last sync.
struct Change {
  bool cut = false;
  std::size_t offset = 0;  // of a cut: the new size
  Bytes bytes;
};

namespace {

constexpr std::size_t kSector = 512;  // bytes that a disk writes as one

void put(Bytes& into, std::size_t offset, const char* bytes, std::size_t length) {
  if (into.size() < offset + length) into.resize(offset + length, 0);
  std::copy_n(bytes, length, into.begin() + static_cast<std::ptrdiff_t>(offset));
}

bool chance(std::mt19937_64& generator, double probability) {
  return static_cast<double>(generator() >> 11) * 0x1p-53 < probability;
}

std::size_t below(std::mt19937_64& generator, std::size_t bound) {
  return static_cast<std::size_t>(generator() % bound);
}

int code_when_off(Step step) {
  switch (step) {
    case Step::open:
      return SQLITE_CANTOPEN;
    case Step::read:
      return SQLITE_IOERR_READ;
    case Step::write:
      return SQLITE_IOERR_WRITE;
    case Step::sync:
      return SQLITE_IOERR_FSYNC;
    case Step::truncate:
      return SQLITE_IOERR_TRUNCATE;
    case Step::lock:
      return SQLITE_IOERR_LOCK;
    case Step::name:
      return SQLITE_IOERR_DELETE;
  }
  return SQLITE_IOERR;
}

bool is_change(Step step) {
  return step == Step::write || step == Step::sync || step == Step::truncate || step == Step::name;
}

}  // namespace

struct FaultyDisk::File {
  Bytes durable;
  std::vector<Change> unsynced;
  std::size_t size = 0;  // as the running program sees it

  void apply(const Change& change) {
    if (change.cut)
      durable.resize(change.offset, 0);
    else
      put(durable, change.offset, change.bytes.data(), change.bytes.size());
  }

  // Sector by sector: each survives, is lost or is torn, whatever became of earlier and later ones.
  void survive(const Change& change, double share, std::mt19937_64& generator) {
    if (change.cut) {
      if (chance(generator, share)) durable.resize(change.offset, 0);
      return;
    }
    for (std::size_t at = 0; at < change.bytes.size();) {
      const std::size_t length = std::min(kSector - (change.offset + at) % kSector, change.bytes.size() - at);
      const bool torn = chance(generator, 0.05);
      const std::size_t kept = torn ? below(generator, length) : chance(generator, share) ? length : 0;
      if (kept > 0) put(durable, change.offset + at, change.bytes.data() + at, kept);
      at += length;
    }
  }

  // A file may have grown without what was written there: zeros, or what the disk held before.
  void grow(std::mt19937_64& generator) {
    if (durable.size() >= size || !chance(generator, 0.5)) return;
    const bool garbage = chance(generator, 0.5);
    while (durable.size() < size) durable.push_back(garbage ? static_cast<char>(generator()) : '\0');
  }
};

FaultyDisk& FaultyDisk::of_the_program() {
  static FaultyDisk disk;
  return disk;
}

void FaultyDisk::start_afresh() {
  if (open_files_ != 0) throw std::logic_error("a file is still open");
  *this = FaultyDisk();
}

int FaultyDisk::count(Step step) const {
  const auto found = counts_.find(step);
  return found == counts_.end() ? 0 : found->second;
}

void FaultyDisk::forget_counts() {
  counts_.clear();
  changes_ = struck_ = 0;
}

void FaultyDisk::fail(const PlannedFault& fault) {
  fault_ = fault;
  until_fault_ = fault.nth;
  fault_began_ = false;
}

void FaultyDisk::flip_on_read(const BitFlip& flip) {
  flip_ = flip;
}

void FaultyDisk::leave_room(std::int64_t bytes) {
  std::int64_t used = 0;
  for (const auto& [path, file] : names_) used += static_cast<std::int64_t>(file->size);
  capacity_ = used + bytes;
}

void FaultyDisk::lift() {
  fault_.reset();
  flip_.reset();
  capacity_.reset();
  until_cut_ = 0;
}

void FaultyDisk::cut_power_at(int nth_change) {
  until_cut_ = nth_change;
}

int FaultyDisk::take(Step step, double* share) {
  ++counts_[step];
  if (is_change(step) && !off_) {
    ++changes_;
    if (until_cut_ > 0 && --until_cut_ == 0) off_ = true;
  }
  if (off_) return code_when_off(step);
  if (!fault_ || fault_->step != step) return SQLITE_OK;
  if (fault_began_ ? !fault_->lasting : --until_fault_ != 0) return SQLITE_OK;
  fault_began_ = true;
  ++struck_;
  if (share != nullptr) *share = fault_->arrived;
  return fault_->code;
}

std::optional<int> FaultyDisk::take_flip() {
  if (!flip_ || --flip_->nth_read != 0) return std::nullopt;
  const int bit = flip_->bit;
  flip_.reset();
  ++struck_;
  return bit;
}

std::shared_ptr<FaultyDisk::File> FaultyDisk::opened(const std::string& path, bool is_new) {
  ++open_files_;
  if (const auto known = names_.find(path); known != names_.end() && !is_new) return known->second;
  auto file = std::make_shared<File>();
  std::ifstream from(path, std::ios::binary);
  file->durable = Bytes(std::istreambuf_iterator<char>(from), {});
  file->size = file->durable.size();
  names_[path] = file;
  // What lay there before the model looked is on the disk; an empty file was made just now.
  if (file->size > 0)
    durable_[path] = file;
  else
    unsynced_.push_back({path, file});
  return file;
}

void FaultyDisk::closed() {
  --open_files_;
}

std::int64_t FaultyDisk::room_for(const File& file, std::int64_t offset, std::int64_t bytes) const {
  if (!capacity_) return bytes;
  std::int64_t used = 0;
  for (const auto& [path, other] : names_) used += static_cast<std::int64_t>(other->size);
  const std::int64_t most = static_cast<std::int64_t>(file.size) + std::max<std::int64_t>(0, *capacity_ - used);
  return std::clamp<std::int64_t>(most - offset, 0, bytes);
}

void FaultyDisk::wrote(File& file, std::int64_t offset, const void* bytes, std::size_t length) {
  const auto* first = static_cast<const char*>(bytes);
  file.unsynced.push_back({false, static_cast<std::size_t>(offset), Bytes(first, first + length)});
  file.size = std::max(file.size, static_cast<std::size_t>(offset) + length);
}

void FaultyDisk::cut(File& file, std::int64_t size) {
  file.unsynced.push_back({true, static_cast<std::size_t>(size), {}});
  file.size = static_cast<std::size_t>(size);
}

void FaultyDisk::synced(File& file) {
  for (const Change& change : file.unsynced) file.apply(change);
  file.unsynced.clear();
}

void FaultyDisk::linked(const std::string& from, const std::string& to) {
  const auto known = names_.find(from);
  if (known == names_.end()) return;
  names_[to] = known->second;
  unsynced_.push_back({to, known->second});
}

void FaultyDisk::removed(const std::string& path) {
  if (names_.erase(path) > 0) unsynced_.push_back({path, nullptr});
}

void FaultyDisk::renamed(const std::string& from, const std::string& to) {
  const auto known = names_.find(from);
  if (known == names_.end()) return;
  unsynced_.push_back({to, known->second, from});
  names_[to] = known->second;
  names_.erase(from);
}

void FaultyDisk::synced_folder() {
  durable_ = names_;
  unsynced_.clear();
}

void FaultyDisk::power_on(std::mt19937_64& generator) {
  if (open_files_ != 0) throw std::logic_error("a file is still open: the machine cannot have been switched off");
  // One share for a whole power cut: sometimes nearly everything was written out, sometimes nearly nothing.
  constexpr double kShares[] = {0, 0.1, 0.5, 0.9, 1};
  const double share = kShares[below(generator, std::size(kShares))];
  std::map<std::string, std::shared_ptr<File>> surviving = durable_;
  for (const Name& change : unsynced_) {
    if (!chance(generator, share)) continue;
    if (change.file)
      surviving[change.path] = change.file;
    else
      surviving.erase(change.path);
    if (!change.before.empty()) surviving.erase(change.before);
  }
  for (const auto* names : {&names_, &durable_})
    for (const auto& [path, file] : *names) std::filesystem::remove(path);
  std::map<const File*, std::string> written;
  for (const auto& [path, file] : surviving) {
    if (const auto same = written.find(file.get()); same != written.end()) {
      std::filesystem::create_hard_link(same->second, path);
      continue;
    }
    for (const Change& change : file->unsynced) file->survive(change, share, generator);
    file->unsynced.clear();
    file->grow(generator);
    file->size = file->durable.size();
    const int descriptor = ::open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0600);
    const ssize_t wrote = ::write(descriptor, file->durable.data(), file->durable.size());
    ::close(descriptor);
    if (wrote != static_cast<ssize_t>(file->durable.size())) throw std::runtime_error(path + ": cannot be written");
    written[file.get()] = path;
  }
  names_ = durable_ = std::move(surviving);
  unsynced_.clear();
  off_ = false;
  lift();
  forget_counts();
}

void flip_bit_at_rest(const std::string& path, std::int64_t byte, int bit) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekg(byte);
  const int before = file.get();
  file.seekp(byte);
  file.put(static_cast<char>(before ^ (1 << bit)));
  if (!file) throw std::runtime_error(path + ": cannot be changed");
}

}  // namespace jnd::test
