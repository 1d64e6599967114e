// Whether a study that is open for writing, and its write-ahead log, are still the files at its place. A file that was
// removed, renamed or replaced can be written to without an error, and what was written is lost with it.
#pragma once

#include <cstdint>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>
#include <sys/stat.h>

#include "data/files/study_image.h"

namespace jnd {

class StudyFiles {
 public:
  // unseen: the disk or the folder does not let it be looked at, so that nothing is known.
  enum class State { in_place, removed, moved, replaced, file_cut, log_removed, log_replaced, log_cut, unseen };

  // Once the study is open for writing, with its log. place: absolute, without links. study: a descriptor of it, which
  // must outlive this.
  StudyFiles(std::filesystem::path place, int study);
  ~StudyFiles();
  StudyFiles(const StudyFiles&) = delete;
  StudyFiles& operator=(const StudyFiles&) = delete;

  // From here on no page of the study changes unseen, and all of it is kept in memory. Throws StorageError.
  void keep_image() { image_ = std::make_unique<StudyImage>(study_); }
  // What is true at this moment; some microseconds. After a checkpoint, or any other change of the file, with an image:
  // as long as reading all of it takes.
  State look(SQLite::Database& connection);
  // Frames in the log, in the file or not.
  static std::uint32_t log_length(SQLite::Database& connection);
  // Of a study that was cut off or written over: what it held, without gaps. nullptr: nobody asked for it.
  const StudyImage* image() const noexcept { return image_.get(); }
  // "study.sqlite was renamed to /home/lab/b.sqlite".
  std::string in_words(State state) const;
  // Where the file is now, as the kernel knows it; empty where it has no name any more.
  std::filesystem::path whereabouts() const;

  // Closes the connection to a study that is not in place: puts the log's content into the file, whatever it is called
  // now, as far as there is any, and takes no file's name away but the log's own. Whether the file holds everything
  // then.
  bool leave(std::unique_ptr<SQLite::Database>& connection, State state) const;

 private:
  void find_log();
  bool log_is_whole(const std::optional<LogIndex>& index) const;
  bool file_is_whole(bool index_known);

  std::filesystem::path place_, log_place_;
  int study_, log_ = -1;
  std::unique_ptr<StudyImage> image_;
  struct stat seen_ {};   // the file, when it was whole
  bool settled_ = false;  // a later change of it has another time
  int error_ = 0;         // why it is unseen
};

}  // namespace jnd
