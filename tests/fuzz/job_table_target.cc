#include <fstream>
#include <iterator>

#include "coordinator/store/job_table.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

// SQLite keeps two files beside it.
void RemoveAll(const std::filesystem::path& path) {
  for (const char* ending : {"", "-wal", "-shm", "-journal"}) ::unlink((path.string() + ending).c_str());
}

std::map<std::string, coordinator::JobLines> ALine(const std::string& job) {
  coordinator::JobLines lines;
  lines.lines.emplace_back().set_text("the job begins");
  return {{job, lines}};
}

Outcome Run(std::span<const std::uint8_t> bytes) {
  static const ScratchFolder folder;
  folder.Put("jobs.sqlite", AsText(bytes));
  Outcome outcome = Outcome::kRefused;
  {
    Result<coordinator::JobTable> table = coordinator::JobTable::Open(folder.path() / "jobs.sqlite");
    if (table.ok() && table.value().ReadLog("1-toy", 0).ok() &&
        table.value().AppendLog(ALine("9-new")).ok()) {
      const auto lines = table.value().ReadLog("9-new", 0);
      if (lines.ok() && !lines.value().empty()) outcome = Outcome::kAccepted;
    }
  }
  RemoveAll(folder.path() / "jobs.sqlite");
  return outcome;
}

std::vector<Bytes> Seeds() {
  const ScratchFolder folder;
  const std::filesystem::path path = folder.path() / "seed.sqlite";
  {
    coordinator::JobTable table = coordinator::JobTable::Open(path).value();
    CAIRN_DEMAND(table.NoteNumber("1-toy").ok() && table.AppendLog(ALine("1-toy")).ok(), "no seed");
  }
  std::ifstream in(path, std::ios::binary);
  return {Bytes{std::istreambuf_iterator<char>(in), {}}};
}

}  // namespace

Target JobTableTarget() { return {"job_table", Run, Seeds, 300}; }

}  // namespace cairn::fuzz
