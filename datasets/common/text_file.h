// Text files, plain or gzipped, a line at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cairn::datasets {

// What a text file may hold, unpacked: a few megabytes of gzip unpack to as many gigabytes as their maker
// likes.
struct TextLimits {
  std::uint64_t file_bytes = std::uint64_t{1} << 30;
  std::uint64_t line_bytes = std::uint64_t{1} << 24;
};

// Of all texts that this process reads from here on, whatever the importer.
void SetTextLimits(const TextLimits& limits);

// The whole text of a file, gunzipped where it is a gzip stream.
// Throws InputError that names the file: none there, no regular file, a damaged or truncated gzip stream, a
// text over a limit, which is seen while it is unpacked.
std::string ReadText(const std::string& path);

// The path of FOLDER/NAME, or of FOLDER/NAME.gz; empty where neither is a file. Throws InputError where both
// are, and hold different texts.
std::string FindFile(const std::string& folder, const std::string& name);

// The same; throws InputError that names folder and file where there is none.
std::string NeedFile(const std::string& folder, const std::string& name);

// Walks over the lines of a text: without their ends (LF or CR LF), without a byte order mark.
class Lines {
 public:
  explicit Lines(std::string_view text);
  bool Next();  // false at the end
  std::string_view text() const { return line_; }
  std::size_t number() const { return number_; }  // counts from 1

 private:
  std::string_view rest_, line_;
  std::size_t number_ = 0;
};

// What a message shows of a text of a file: all of it, or 500 bytes.
std::string Excerpt(std::string_view text);

// Lines of a file that were skipped: how many, and where the first of them stand.
struct SkippedLines {
  static constexpr std::size_t kMostShown = 5;
  std::int64_t count = 0;
  std::vector<std::size_t> first;
  std::string Text() const;  // "line 4", "lines 4, 9", "lines 4, 9, 12, 13, 20 and 3 more"
};

// What to do with a line that cannot be used: stop, or skip and count.
class BadLines {
 public:
  // `may_skip`: the message says that --skip-bad does.
  explicit BadLines(bool skip, bool may_skip = true) : skip_(skip), may_skip_(may_skip) {}
  // Throws InputError "FILE:LINE: REASON: DETAIL (--skip-bad …)", or counts the reason where lines are
  // skipped.
  void Add(const std::string& file, std::size_t line, const std::string& reason, const std::string& detail);
  bool skips() const { return skip_; }
  const std::map<std::string, std::int64_t>& counts() const { return counts_; }
  SkippedLines SkippedOf(const std::string& file) const;

 private:
  bool skip_, may_skip_;
  std::map<std::string, std::int64_t> counts_;
  std::map<std::string, SkippedLines> lines_;  // by file
};

std::string_view Trim(std::string_view text);

// A finite number, all of `text` but blanks around it; else nothing, and `reason` says why: "not a number" or
// "not finite". Independent of the locale.
std::optional<double> ParseNumber(std::string_view text, const char** reason);

}  // namespace cairn::datasets
