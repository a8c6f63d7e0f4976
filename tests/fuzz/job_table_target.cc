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

Outcome Run(std::span<const std::uint8_t> bytes) {
  static const ScratchFolder folder;
  folder.Put("jobs.sqlite", AsText(bytes));
  Outcome outcome = Outcome::kRefused;
  {
    Result<coordinator::JobTable> table = coordinator::JobTable::Open(folder.path() / "jobs.sqlite");
    coordinator::JobRow row;
    row.info.set_id("9-new");
    if (table.ok() && table.value().Read().ok() && table.value().Write(row).ok()) {
      const auto rows = table.value().Read();
      if (rows.ok() && !rows.value().empty()) outcome = Outcome::kAccepted;
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
    coordinator::JobRow row;
    row.info.set_id("1-toy");
    row.info.set_state("running");
    CAIRN_DEMAND(table.Write(row).ok(), "no seed");
  }
  std::ifstream in(path, std::ios::binary);
  return {Bytes{std::istreambuf_iterator<char>(in), {}}};
}

}  // namespace

Target JobTableTarget() { return {"job_table", Run, Seeds, 300}; }

}  // namespace cairn::fuzz
