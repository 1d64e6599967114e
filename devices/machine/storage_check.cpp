// Where studies go: the file system, its free space, and how long it takes to promise that a trial is saved.
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <sys/statvfs.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "devices/machine/machine_checks.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "study folder";

MachineCheck bad(std::string found, std::string what_to_do) {
  return {.name = kName, .verdict = Verdict::bad, .found = std::move(found), .what_to_do = std::move(what_to_do)};
}

// The type of the mount that holds `folder`: that with the longest mount point, the later of equals (it covers the
// other). proc_pid_mountinfo(5): ... mount point is field 5, the type the first after " - ".
std::string mount_type(const fs::path& mountinfo, const fs::path& folder) {
  std::ifstream file(mountinfo);
  std::string type, best;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string point;
    for (int field = 0; field < 5; ++field) words >> point;
    for (std::size_t at = 0; (at = point.find("\\040", at)) != std::string::npos;) point.replace(at, 4, 1, ' ');
    const auto separator = line.find(" - ");
    if (separator == std::string::npos || point.size() < best.size()) continue;
    const std::string path = folder.string();
    const bool holds =
        path.starts_with(point) && (point.ends_with('/') || path.size() == point.size() || path[point.size()] == '/');
    if (!holds) continue;
    best = point;
    type = line.substr(separator + 3, line.find(' ', separator + 3) - separator - 3);
  }
  return type;
}

// Seconds that each of so many writes of 4 kB took to be on the disk; empty, with errno, where the folder cannot be
// written.
std::vector<double> time_syncs(const fs::path& folder, int syncs) {
  std::string name = (folder / ".jnd-doctor-XXXXXX").string();
  const int file = mkstemp(name.data());
  if (file < 0) return {};
  unlink(name.c_str());
  const std::string block(4096, 'x');
  std::vector<double> seconds;
  int error = 0;
  for (int i = 0; i < syncs && error == 0; ++i) {
    const auto began = std::chrono::steady_clock::now();
    errno = 0;
    if (write(file, block.data(), block.size()) != static_cast<ssize_t>(block.size()) || fsync(file) != 0)
      error = errno == 0 ? EIO : errno;
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
  }
  close(file);
  if (error != 0) {
    errno = error;
    return {};
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds;
}

std::string bytes_text(double bytes) {
  return bytes >= 1e9 ? fmt::format("{:.0f} GB", bytes / 1e9) : fmt::format("{:.0f} MB", bytes / 1e6);
}

}  // namespace

MachineCheck judge_storage(const StorageFigures& figures) {
  MachineCheck check{.name = kName, .verdict = Verdict::ok, .found = "", .what_to_do = ""};
  check.found = fmt::format("{} ({}), {} free, saving a trial takes {:.1f} ms (longest {:.1f} ms)", figures.folder,
                            figures.type.empty() ? "type of file system not readable" : figures.type,
                            bytes_text(figures.free_bytes), 1e3 * figures.sync_median_s, 1e3 * figures.sync_max_s);
  const auto complain = [&](Verdict verdict, const char* why, const std::string& what_to_do) {
    check.found += why;
    check.verdict = std::max(check.verdict, verdict);
    if (!check.what_to_do.empty()) check.what_to_do += "; ";
    check.what_to_do += what_to_do;
  };
  const Verdict unsafe = figures.real ? Verdict::bad : Verdict::warn;
  if (figures.network)
    complain(unsafe, "; a network file system cannot promise that an answer is saved, real sessions are refused",
             "keep studies on a local disk (--study FOLDER checks another place)");
  if (figures.type == "fuse" || figures.type.starts_with("fuse."))
    complain(unsafe, "; a file system of another program (sshfs, a cloud drive) may promise what it does not keep",
             "keep studies on a local disk");
  if (figures.type == "tmpfs" || figures.type == "ramfs" || figures.type == "devtmpfs")
    complain(unsafe, "; this is memory: everything in it is lost when the machine stops", "keep studies on a disk");
  if (figures.needed_bytes > 0) check.found += fmt::format(", a session needs {}", bytes_text(figures.needed_bytes));
  const std::string free_more = fmt::format("free at least {}", bytes_text(kFewBytes + figures.needed_bytes));
  if (figures.free_bytes < kTooFewBytes + figures.needed_bytes)
    complain(Verdict::bad, "; too little space for a session", free_more);
  else if (figures.free_bytes < kFewBytes + figures.needed_bytes)
    complain(Verdict::warn, "; little space", free_more);
  if (figures.sync_median_s >= kTooSlowSync_s)
    complain(Verdict::bad, "; participants would wait for the disk after every answer", "use another disk");
  else if (figures.sync_median_s >= kSlowSync_s || figures.sync_max_s >= kTooSlowSync_s)
    complain(Verdict::warn, "; a slow disk", "end programs that write to it, or use another disk");
  return check;
}

MachineCheck check_storage(const fs::path& folder_or_file, const StorageProbe& probe) {
  std::error_code error;
  fs::path folder = folder_or_file.empty() ? fs::path(".") : folder_or_file;
  if (!fs::is_directory(folder, error)) folder = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
  const fs::path resolved = fs::canonical(folder, error);
  if (error || !fs::is_directory(resolved, error))
    return bad(fmt::format("{}: there is no such folder", folder.string()), "make it, or name another with --study");
  folder = resolved;

  struct statfs status {};
  struct statvfs space {};
  if (::statfs(folder.c_str(), &status) != 0 || ::statvfs(folder.c_str(), &space) != 0)
    return bad(fmt::format("{}: {}", folder.string(), std::system_category().message(errno)), "use another folder");
  StorageFigures figures{.folder = folder.string(),
                         .type = mount_type(probe.root / "proc/self/mountinfo", folder),
                         .network = probe.is_network && probe.is_network(static_cast<long>(status.f_type)),
                         .free_bytes = static_cast<double>(space.f_bavail) * static_cast<double>(space.f_frsize),
                         .sync_median_s = 0,
                         .sync_max_s = 0,
                         .real = probe.real,
                         .needed_bytes = probe.needed_bytes};
  const std::vector<double> syncs = time_syncs(folder, std::max(probe.syncs, 1));
  if (syncs.empty())
    return bad(fmt::format("{}: cannot be written: {}", folder.string(), std::system_category().message(errno)),
               "check its permissions and space, or name another with --study");
  figures.sync_median_s = syncs[syncs.size() / 2];
  figures.sync_max_s = syncs.back();
  return judge_storage(figures);
}

}  // namespace jnd
