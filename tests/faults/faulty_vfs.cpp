#include "tests/faults/faulty_vfs.h"

#include <new>
#include <stdexcept>

#include <sqlite3.h>
#include <unistd.h>

namespace jnd::test {

namespace {

sqlite3_vfs* real_vfs() {
  static sqlite3_vfs* const vfs = sqlite3_vfs_find("unix");
  return vfs;
}

FaultyDisk& disk() {
  return FaultyDisk::of_the_program();
}

// As SQLite lays it out: the base first, the real file behind.
struct OpenFile {
  sqlite3_file base;
  std::shared_ptr<FaultyDisk::File> file;  // none: a file of SQLite's own, which goes when it is closed
  bool syncs_folder;                       // at the first sync, as SQLite's own VFS does for new journals
};

constexpr std::size_t kBehind = (sizeof(OpenFile) + 15) / 16 * 16;

OpenFile& ours(sqlite3_file* file) {
  return *reinterpret_cast<OpenFile*>(file);
}
sqlite3_file* real(sqlite3_file* file) {
  return reinterpret_cast<sqlite3_file*>(reinterpret_cast<char*>(file) + kBehind);
}

int close_file(sqlite3_file* file) {
  const int result = real(file)->pMethods->xClose(real(file));
  if (ours(file).file) disk().closed();
  ours(file).~OpenFile();
  return result;
}

int read_file(sqlite3_file* file, void* into, int length, sqlite3_int64 offset) {
  if (!ours(file).file) return real(file)->pMethods->xRead(real(file), into, length, offset);
  if (const int code = disk().take(Step::read)) return code;
  const int result = real(file)->pMethods->xRead(real(file), into, length, offset);
  if (length > 0)
    if (const auto bit = disk().take_flip()) {
      auto* bytes = static_cast<unsigned char*>(into);
      bytes[*bit / 8 % length] = static_cast<unsigned char>(bytes[*bit / 8 % length] ^ (1 << (*bit % 8)));
    }
  return result;
}

int write_file(sqlite3_file* file, const void* from, int length, sqlite3_int64 offset) {
  OpenFile& open = ours(file);
  if (!open.file) return real(file)->pMethods->xWrite(real(file), from, length, offset);
  double arrived = 0;
  int code = disk().take(Step::write, &arrived);
  int written = code == SQLITE_OK ? length : static_cast<int>(length * arrived);
  if (code == SQLITE_OK) {
    written = static_cast<int>(disk().room_for(*open.file, offset, length));
    if (written < length) {
      code = SQLITE_FULL;
      disk().struck_by_room();
    }
  }
  if (written > 0) {
    const int result = real(file)->pMethods->xWrite(real(file), from, written, offset);
    if (result != SQLITE_OK) return result;
    disk().wrote(*open.file, offset, from, static_cast<std::size_t>(written));
  }
  return code;
}

int truncate_file(sqlite3_file* file, sqlite3_int64 size) {
  if (!ours(file).file) return real(file)->pMethods->xTruncate(real(file), size);
  if (const int code = disk().take(Step::truncate)) return code;
  const int result = real(file)->pMethods->xTruncate(real(file), size);
  if (result == SQLITE_OK) disk().cut(*ours(file).file, size);
  return result;
}

int sync_file(sqlite3_file* file, int /*flags*/) {
  OpenFile& open = ours(file);
  if (!open.file) return SQLITE_OK;
  if (const int code = disk().take(Step::sync)) return code;
  disk().synced(*open.file);
  if (open.syncs_folder) disk().synced_folder();
  open.syncs_folder = false;
  return SQLITE_OK;
}

int file_size(sqlite3_file* file, sqlite3_int64* size) {
  return real(file)->pMethods->xFileSize(real(file), size);
}
int lock_file(sqlite3_file* file, int level) {
  if (ours(file).file)
    if (const int code = disk().take(Step::lock)) return code;
  return real(file)->pMethods->xLock(real(file), level);
}
// Never fails: a switched-off machine holds no lock.
int unlock_file(sqlite3_file* file, int level) {
  return real(file)->pMethods->xUnlock(real(file), level);
}
int check_lock(sqlite3_file* file, int* result) {
  return real(file)->pMethods->xCheckReservedLock(real(file), result);
}
int file_control(sqlite3_file* file, int operation, void* argument) {
  // A file that grows by itself would grow behind the model's back.
  if (operation == SQLITE_FCNTL_SIZE_HINT || operation == SQLITE_FCNTL_CHUNK_SIZE) return SQLITE_OK;
  return real(file)->pMethods->xFileControl(real(file), operation, argument);
}
int sector_size(sqlite3_file* file) {
  return real(file)->pMethods->xSectorSize(real(file));
}
int characteristics(sqlite3_file* file) {
  return real(file)->pMethods->xDeviceCharacteristics(real(file));
}
int map_index(sqlite3_file* file, int page, int size, int extend, void volatile** into) {
  if (disk().off()) return SQLITE_IOERR_SHMMAP;
  return real(file)->pMethods->xShmMap(real(file), page, size, extend, into);
}
int lock_index(sqlite3_file* file, int offset, int count, int flags) {
  return real(file)->pMethods->xShmLock(real(file), offset, count, flags);
}
void index_barrier(sqlite3_file* file) {
  real(file)->pMethods->xShmBarrier(real(file));
}
int unmap_index(sqlite3_file* file, int remove) {
  return real(file)->pMethods->xShmUnmap(real(file), remove);
}

// Version 2: without memory mapping, which would write behind the model's back.
constexpr sqlite3_io_methods kMethods = {
    2,          close_file,    read_file,   write_file,   truncate_file, sync_file,       file_size,
    lock_file,  unlock_file,   check_lock,  file_control, sector_size,   characteristics, map_index,
    lock_index, index_barrier, unmap_index, nullptr,      nullptr};

int open_file(sqlite3_vfs*, const char* path, sqlite3_file* file, int flags, int* out_flags) {
  constexpr int kKept = SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_SUPER_JOURNAL | SQLITE_OPEN_WAL;
  constexpr int kJournals = SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_SUPER_JOURNAL | SQLITE_OPEN_WAL;
  file->pMethods = nullptr;
  const bool kept = path != nullptr && (flags & kKept) != 0;
  if (kept)
    if (const int code = disk().take(Step::open)) return code;
  const bool is_new = kept && ::access(path, F_OK) != 0;
  const int result = real_vfs()->xOpen(real_vfs(), path, real(file), flags, out_flags);
  if (result != SQLITE_OK) return result;
  auto* open = new (file) OpenFile{};
  open->base.pMethods = &kMethods;
  if (kept) open->file = disk().opened(path, is_new);
  open->syncs_folder = (flags & SQLITE_OPEN_CREATE) != 0 && (flags & kJournals) != 0;
  return SQLITE_OK;
}

int delete_file(sqlite3_vfs*, const char* path, int sync_folder) {
  if (const int code = disk().take(Step::name)) return code;
  const int result = real_vfs()->xDelete(real_vfs(), path, 0);
  if (result != SQLITE_OK) return result;
  disk().removed(path);
  if (sync_folder != 0) disk().synced_folder();
  return SQLITE_OK;
}

}  // namespace

FaultyDisk& use_faulty_disk() {
  static sqlite3_vfs vfs = [] {
    sqlite3_vfs made = *real_vfs();
    made.szOsFile = static_cast<int>(kBehind) + real_vfs()->szOsFile;
    made.zName = "faulty";
    made.xOpen = open_file;
    made.xDelete = delete_file;
    return made;
  }();
  if (sqlite3_vfs_register(&vfs, 1) != SQLITE_OK) throw std::runtime_error("the faulty VFS cannot be registered");
  return disk();
}

}  // namespace jnd::test
