// What a study holds, kept in memory while people answer: its file as it was found, and what was committed to its log
// since. It tells whether something else has written into the file, and is what is rescued then.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

namespace jnd {

// What the log's index says, https://sqlite.org/walformat.html, section 2.1.
struct LogIndex {
  std::uint32_t frames = 0;  // that the log must hold
  std::size_t page_size = 0;
  std::uint32_t pages = 0;  // of the study, with the last of these frames
  std::array<char, 8> salt{};
};

// Of the log itself, https://sqlite.org/fileformat2.html, section 4.1.
constexpr std::size_t kLogHeader = 32, kFrameHeader = 24, kLogSaltAt = 16;

class StudyImage {
 public:
  // Reads the file of this descriptor, which must outlive this. Throws StorageError where it cannot be read.
  explicit StudyImage(int study);

  // What was committed since, from a log that is whole. False where it cannot be read.
  bool add(int log, const LogIndex& index);
  // Whether each page of the file is as it was, or as a commit made it: any program may put the log into the file. Reads
  // the whole file.
  bool explains(int log) const;
  // The study as of its last event. 0 or errno.
  int write_to(int descriptor) const;

 private:
  std::string frame(int log, std::uint32_t number) const;  // its page; empty where it cannot be read

  int study_;
  std::size_t page_size_ = 0;
  std::string file_;                                    // before anything of this log
  std::map<std::uint32_t, std::string> newest_;         // pages by number, from 1, as of the last frame
  std::multimap<std::uint32_t, std::uint32_t> frames_;  // pages by number: the frames that hold them
  std::uint32_t known_ = 0, pages_ = 0;
  std::array<char, 8> salt_{};
};

}  // namespace jnd
