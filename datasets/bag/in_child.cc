#include "datasets/bag/in_child.h"

#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <utility>
#include <vector>

#include "datasets/bag/container.h"
#include "datasets/import/scan_rows.h"
#include "schema/store/guarded.h"

namespace cairn::datasets {
namespace {

using store::FileContents;

// What the child's limits are made of: a chunk may unpack to several times its size, a bag with clouds is
// read twice, and a log has the ranges in eight bytes that a bag has in four.
store::ChildReader ReaderOfBags(const std::vector<std::string>& paths, std::uint64_t memory_mb = 0) {
  constexpr std::uint64_t kTimes = 8;
  store::ChildReader reader{"its reader", 1};
  for (const std::string& path : paths)
    for (const std::string& file : bag::BagFilesOf(path)) {
      struct stat has{};  // what it has on the disk: a sparse file may be of any size
      const bool known = ::stat(file.c_str(), &has) == 0;
      constexpr std::uint64_t kBlock = 512, kLeast = 1 << 20;
      const auto size = known ? static_cast<std::uint64_t>(has.st_size) : 0,
                 blocks = known ? static_cast<std::uint64_t>(has.st_blocks) * kBlock : 0;
      reader.bytes += kTimes * std::min(size, std::max(blocks, kLeast));
    }
  constexpr std::uint64_t kLeastMemory = std::uint64_t{2} << 30;
  reader.memory_bytes = memory_mb > 0 ? memory_mb << 20 : kLeastMemory + reader.bytes;
  return reader;
}

Result<FileContents> Run(const std::string& path, const store::ChildReader& reader,
                         const std::function<Result<FileContents>()>& make) {
  return store::InChild(
      path,
      [&]() -> Result<FileContents> {
        try {
          return make();
        } catch (const InputError& error) {
          return Status(Code::kRefused, error.what());
        } catch (const NotStored& why) {
          return why.status;
        }
      },
      reader);
}

// A report's counts and texts, each with what it is: `visit(kind, count, text)`.
template <class Report, class Visit>
void VisitReport(Report& report, const Visit& visit) {
  const auto counts = {std::pair{"robots", &report.robots},
                       std::pair{"controls", &report.controls},
                       std::pair{"observations", &report.observations},
                       std::pair{"contacts", &report.contacts},
                       std::pair{"robot_observations", &report.robot_observations},
                       std::pair{"landmarks", &report.landmarks},
                       std::pair{"scans", &report.scans}};
  for (const auto& [kind, count] : counts) visit.Count(kind, count);
  visit.Counts("read", &report.read);
  visit.Counts("skipped", &report.skipped);
  visit.Counts("dropped", &report.dropped);
  visit.Texts("warnings", &report.warnings);
  visit.Texts("unit_doubts", &report.unit_doubts);
}

// "KIND COUNT TEXT".
struct Writer {
  std::vector<std::string>& lines;
  void Line(const std::string& kind, std::int64_t count, const std::string& text) const {
    lines.push_back(kind + " " + std::to_string(count) + " " + text);
  }
  void Count(const char* kind, const std::int64_t* count) const { Line(kind, *count, ""); }
  void Counts(const char* kind, const std::map<std::string, std::int64_t>* counts) const {
    for (const auto& [text, count] : *counts) Line(kind, count, text);
  }
  void Texts(const char* kind, const std::vector<std::string>* texts) const {
    for (const std::string& text : *texts) Line(kind, 0, text);
  }
};

struct Taker {
  const std::string& kind;
  std::int64_t count;
  const std::string& text;
  void Count(const char* name, std::int64_t* to) const {
    if (kind == name) *to = count;
  }
  void Counts(const char* name, std::map<std::string, std::int64_t>* to) const {
    if (kind == name) (*to)[text] = count;
  }
  void Texts(const char* name, std::vector<std::string>* to) const {
    if (kind == name) to->push_back(text);
  }
};

ImportReport ReportOf(const std::vector<std::string>& lines) {
  ImportReport report;
  for (const std::string& line : lines) {
    const std::size_t first = line.find(' '), second = line.find(' ', first + 1);
    const std::string kind = line.substr(0, first), text = line.substr(second + 1);
    std::int64_t count = 0;
    std::from_chars(line.data() + first + 1, line.data() + second, count);
    VisitReport(report, Taker{kind, count, text});
  }
  return report;
}

}  // namespace

Result<StoredImport> ImportBagInChild(
    const BagImportOptions& options,
    const std::function<Result<std::string>(const Blob& log, const ImportReport& report)>& store) {
  store::ChildReader reader = ReaderOfBags(options.files, options.memory_mb);
  reader.more_memory = " (--max-memory-mb gives it more)";
  const Result<FileContents> made = Run(options.files.front(), reader, [&]() -> Result<FileContents> {
    Blob log;
    const ImportReport report = ImportBag(options, &log);
    Result<std::string> told = store(log, report);
    if (!told.ok()) return told.status();
    FileContents contents;
    VisitReport(report, Writer{contents.remarks});
    contents.remarks.push_back(std::move(told).value());
    return contents;
  });
  if (!made.ok()) return made.status();
  std::vector<std::string> lines = made.value().remarks;
  std::string told = std::move(lines.back());
  lines.pop_back();
  return StoredImport{ReportOf(lines), std::move(told)};
}

Result<std::string> InspectBagInChild(const std::string& path,
                                      const std::function<std::string(const BagInspection&)>& tell) {
  const Result<FileContents> made = Run(path, ReaderOfBags({path}), [&] {
    constexpr std::size_t kPiece = 1 << 19;  // of a text that a child may hand over
    FileContents contents;
    const std::string text = tell(InspectBag(path));
    for (std::size_t at = 0; at < text.size(); at += kPiece)
      contents.remarks.push_back(text.substr(at, kPiece));
    return contents;
  });
  if (!made.ok()) return made.status();
  std::string text;
  for (const std::string& piece : made.value().remarks) text += piece;
  return text;
}

}  // namespace cairn::datasets
