#include "datasets/common/text_file.h"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>

#include "schema/error.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

struct GzClose {
  void operator()(gzFile_s* file) const { gzclose(file); }
};

TextLimits& Limits() {
  static TextLimits limits;
  return limits;
}

// Of the lines of a text that comes in parts; `begun`: bytes of the line that goes on.
std::size_t LongestLine(std::string_view part, std::size_t* begun) {
  std::size_t longest = 0, begin = 0;
  for (std::size_t end = 0; (end = part.find('\n', begin)) != std::string_view::npos; begin = end + 1) {
    longest = std::max(longest, *begun + end - begin);
    *begun = 0;
  }
  *begun += part.size() - begin;
  return std::max(longest, *begun);
}

std::string Megabytes(std::uint64_t bytes) { return std::to_string(bytes >> 20) + " MB"; }

void CheckLimits(const std::string& path, std::uint64_t file_bytes, std::uint64_t line_bytes) {
  const TextLimits& limits = Limits();
  if (file_bytes > limits.file_bytes)
    throw InputError(path + ": more than " + Megabytes(limits.file_bytes) +
                     " of text, unpacked; where that is right, --max-text-mb takes more");
  if (line_bytes > limits.line_bytes)
    throw InputError(path + ": a line of more than " + Megabytes(limits.line_bytes) +
                     "; is it a file of another kind?");
}

}  // namespace

void SetTextLimits(const TextLimits& limits) { Limits() = limits; }

std::string FindFile(const std::string& folder, const std::string& name) {
  const std::string plain = (std::filesystem::path(folder) / name).string(), packed = plain + ".gz";
  const bool is_plain = std::filesystem::is_regular_file(plain),
             is_packed = std::filesystem::is_regular_file(packed);
  if (is_plain && is_packed && ReadText(plain) != ReadText(packed))
    throw InputError(plain + ": " + name + ".gz beside it holds another text: leave the one that counts");
  return is_plain ? plain : is_packed ? packed : "";
}

std::string NeedFile(const std::string& folder, const std::string& name) {
  const std::string path = FindFile(folder, name);
  if (path.empty()) throw InputError(folder + ": there is no " + name + "(.gz) in it");
  return path;
}

std::string ReadText(const std::string& path) {
  const Result<RegularFile> opened = RegularFile::Open(path);
  if (!opened.ok()) throw InputError(opened.status().message());
  const std::unique_ptr<gzFile_s, GzClose> file(gzdopen(::dup(opened.value().descriptor()), "rb"));
  if (!file) throw InputError(path + ": cannot open: out of memory or descriptors");
  gzbuffer(file.get(), 1 << 17);
  std::string text;
  std::array<char, 1 << 16> part;
  int count = 0;
  std::size_t line_bytes = 0;  // since the last end of a line
  while ((count = gzread(file.get(), part.data(), part.size())) > 0) {
    const std::string_view read(part.data(), static_cast<std::size_t>(count));
    CheckLimits(path, text.size() + read.size(), LongestLine(read, &line_bytes));
    text.append(read);
  }
  int error = Z_OK;
  gzerror(file.get(), &error);  // a stream cut short gives all it has, then Z_BUF_ERROR
  if (count < 0 || error != Z_OK) throw InputError(path + ": the gzip stream is damaged or cut short");
  return text;
}

Lines::Lines(std::string_view text) : rest_(text) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
}

bool Lines::Next() {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  ++number_;
  return true;
}

std::string Excerpt(std::string_view text) {
  constexpr std::size_t kMost = 500;
  return text.size() <= kMost ? std::string(text) : Printable(std::string(text.substr(0, 2 * kMost)), kMost);
}

void BadLines::Add(const std::string& file, std::size_t line, const std::string& reason,
                   const std::string& detail) {
  if (!skip_) {
    throw InputError(file + ":" + std::to_string(line) + ": " + reason +
                     (detail.empty() ? "" : ": " + Excerpt(detail)) +
                     (may_skip_ ? " (--skip-bad skips such lines and counts them)" : ""));
  }
  ++counts_[reason];
  SkippedLines& lines = lines_[file];
  if (++lines.count <= static_cast<std::int64_t>(SkippedLines::kMostShown)) lines.first.push_back(line);
}

SkippedLines BadLines::SkippedOf(const std::string& file) const {
  const auto lines = lines_.find(file);
  return lines == lines_.end() ? SkippedLines() : lines->second;
}

std::string SkippedLines::Text() const {
  std::string text = count == 1 ? "line " : "lines ";
  for (std::size_t i = 0; i < first.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(first[i]);
  const std::int64_t more = count - static_cast<std::int64_t>(first.size());
  return more > 0 ? text + " and " + std::to_string(more) + " more" : text;
}

std::string_view Trim(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::optional<double> ParseNumber(std::string_view text, const char** reason) {
  text = Trim(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument) {
    *reason = "not a number";
    return std::nullopt;
  }
  // Too small for a double is taken as its nearest, zero; too large is as good as infinite.
  if (error == std::errc::result_out_of_range)
    value = text.find("e-") != text.npos || text.find("E-") != text.npos ? 0 : INFINITY;
  if (!std::isfinite(value)) {
    *reason = "not finite";
    return std::nullopt;
  }
  return value;
}

}  // namespace cairn::datasets
