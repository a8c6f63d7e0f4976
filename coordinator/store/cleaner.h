// Removes from a store what nobody needs: blobs and packs that no checkpoint names, checkpoints older than
// the last two, what interrupted writes have left, and, where asked for, what was quarantined as damaged.
// Results are never touched.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/store/folder.h"
#include "schema/wire.pb.h"

namespace cairn::coordinator {

struct CleanOptions {
  bool damaged = false;
  bool dry_run = false;   // nothing is removed
  std::set<Hash> needed;  // whatever checkpoints say
};
struct Cleaned {
  std::vector<wire::Cleaned> removed;  // by kind, those of which there were any
  std::string note;                    // why not all was looked at; empty: all was
};
// What a pack holds; none where it cannot be read.
using PackLook = std::function<std::optional<std::vector<Hash>>(const std::filesystem::path& pack)>;

// By whoever writes the store: nobody else may meanwhile. Where a checkpoint cannot be read, nobody knows
// what it names: no blob goes then. The same where a job has lost its checkpoints (LostJobs in recovery.h);
// with `damaged` it is given up, and its log removed.
Cleaned CleanStore(const StoreFolder& folder, const CleanOptions& options, const PackLook& look);

// Reads the pack.
std::optional<std::vector<Hash>> HashesInPack(const std::filesystem::path& pack);

}  // namespace cairn::coordinator
