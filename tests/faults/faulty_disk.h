// What a disk would still hold after a power cut, and the faults that a test asks of it.
//
// Files lie in a real folder, where they hold what the running program sees. Beside that this model keeps what is
// durable: the bytes as they were at each file's last sync, the changes since then, the names that a synced folder
// holds, and the names made or removed since. A power cut lets each change since survive, be lost or be torn.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace jnd::test {

// What a fault can strike. name: a file's name is made, linked or removed.
enum class Step { open, read, write, sync, truncate, lock, name };

struct PlannedFault {
  Step step = Step::write;
  int nth = 1;           // from 1, counted from when the fault is asked for
  int code = 0;          // of SQLite: SQLITE_IOERR_WRITE, SQLITE_FULL, ...
  bool lasting = false;  // every such step from then on, until lift()
  double arrived = 0;    // of a write: the share of its bytes, 0..1, that reach the file all the same
};

struct BitFlip {
  int nth_read = 1;  // from 1, counted from when it is asked for
  int bit = 0;       // within what is read, modulo its length
};

// Thread rule: one thread at a time.
class FaultyDisk {
 public:
  struct File;  // an inode

  // Knows no file and plans no fault. Files made without SQLite are taken as durable when SQLite first opens them.
  // Throws std::logic_error where a file is open.
  void start_afresh();

  // How often a step was taken since forget_counts(); those that failed count too.
  int count(Step step) const;
  // Writes, syncs, truncations and names: the steps at which power can be lost.
  int changes() const noexcept { return changes_; }
  void forget_counts();

  void fail(const PlannedFault& fault);
  void flip_on_read(const BitFlip& flip);
  // No file may grow beyond what all of them have now and so many bytes more: SQLITE_FULL.
  void leave_room(std::int64_t bytes);
  // There is room, and nothing fails any more.
  void lift();
  // How often a planned fault, flip or lack of room has struck since forget_counts().
  int struck() const noexcept { return struck_; }

  // The power goes at the n-th change from now, which is not made. From then on everything fails.
  void cut_power_at(int nth_change);
  bool off() const noexcept { return off_; }
  // Power again: puts into the folder what survived. generator decides over each change that was not synced. Nothing
  // may be open. Throws std::logic_error where something is.
  void power_on(std::mt19937_64& generator);
  int open_files() const noexcept { return open_files_; }

  // As on FAT, where a file has one name only: link(2) fails with EPERM until start_afresh().
  void go_without_links() noexcept { has_links_ = false; }
  bool has_links() const noexcept { return has_links_; }

  // Below: for the VFS and for the study's own calls.

  // A step is about to be taken: the code that it must fail with, or 0. share: how much of a write arrives.
  int take(Step step, double* share = nullptr);
  std::optional<int> take_flip();
  // The file that is opened, known or not; one that is new or empty is not durably named yet.
  std::shared_ptr<File> opened(const std::string& path, bool is_new);
  void closed();
  // How many of `bytes` there is room for.
  std::int64_t room_for(const File& file, std::int64_t offset, std::int64_t bytes) const;
  void struck_by_room() { ++struck_; }
  void wrote(File& file, std::int64_t offset, const void* bytes, std::size_t length);
  void cut(File& file, std::int64_t size);
  void synced(File& file);
  void linked(const std::string& from, const std::string& to);
  void removed(const std::string& path);
  void renamed(const std::string& from, const std::string& to);  // survives a power cut as a whole or not at all
  void synced_folder();                                          // all names

  static FaultyDisk& of_the_program();

 private:
  struct Name {
    std::string path;
    std::shared_ptr<File> file;  // none: removed
    std::string before = {};     // of a rename: the name that goes with it
  };

  std::map<std::string, std::shared_ptr<File>> names_;    // as the running program sees them
  std::map<std::string, std::shared_ptr<File>> durable_;  // in a synced folder
  std::vector<Name> unsynced_;                            // changes of names since
  std::map<Step, int> counts_;
  int changes_ = 0;
  std::optional<PlannedFault> fault_;
  int until_fault_ = 0;
  bool fault_began_ = false;
  std::optional<BitFlip> flip_;
  std::optional<std::int64_t> capacity_;
  int struck_ = 0;
  int until_cut_ = 0;  // 0: none is planned
  bool off_ = false;
  int open_files_ = 0;
  bool has_links_ = true;
};

// Flips one bit of a file where it lies.
void flip_bit_at_rest(const std::string& path, std::int64_t byte, int bit);

}  // namespace jnd::test
