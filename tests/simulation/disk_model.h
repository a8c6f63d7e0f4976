// Files as a file system keeps them: what a process sees, and what outlives a power cut. A name that was not
// synced with its folder may be as it was before; content that was not synced is torn.
#pragma once

#include <functional>
#include <map>
#include <set>

namespace cairn::simulation {

enum class DiskStep { kWrite, kSyncFile, kRename, kSyncFolder, kRemove };
// kDead: the process died before it came to this step.
enum class DiskOutcome { kOk, kFailed, kDead };
// Says what comes of a step.
using DiskSteps = std::function<DiskOutcome(DiskStep)>;

template <typename Key, typename Content>
class FolderModel {
 public:
  struct File {
    Content content;
    bool synced = false;
    bool torn = false;
  };

  // As WriteFileAtomically (schema/store) does it.
  DiskOutcome Write(const Key& key, const Content& content, const DiskSteps& steps) {
    File file{content};
    if (const DiskOutcome outcome = steps(DiskStep::kWrite); outcome != DiskOutcome::kOk) return outcome;
    if (const DiskOutcome outcome = steps(DiskStep::kSyncFile); outcome != DiskOutcome::kOk) return outcome;
    file.synced = true;
    if (const DiskOutcome outcome = steps(DiskStep::kRename); outcome != DiskOutcome::kOk) return outcome;
    seen_[key] = file;
    changed_.insert(key);
    if (const DiskOutcome outcome = steps(DiskStep::kSyncFolder); outcome != DiskOutcome::kOk) return outcome;
    SyncFolder();
    return DiskOutcome::kOk;
  }
  // Not synced.
  void Remove(const Key& key) {
    if (seen_.erase(key) > 0) changed_.insert(key);
  }
  void Damage(const Key& key) {
    for (auto* files : {&seen_, &durable_})
      if (const auto it = files->find(key); it != files->end()) it->second.torn = true;
  }
  // Each change that was not synced is there or not, as `keeps` decides.
  void CutPower(const std::function<bool()>& keeps) {
    KeepChanges(keeps);
    for (auto& [key, file] : durable_) file.torn |= !file.synced;
    seen_ = durable_;
  }
  const Content* Read(const Key& key) const {  // null: not there, or damaged
    const auto it = seen_.find(key);
    return it == seen_.end() || it->second.torn ? nullptr : &it->second.content;
  }
  void SyncFolder() {
    KeepChanges([] { return true; });
  }
  const std::map<Key, File>& files() const { return seen_; }

 private:
  void KeepChanges(const std::function<bool()>& keeps) {
    for (const Key& key : changed_) {
      if (!keeps()) continue;
      const auto it = seen_.find(key);
      if (it == seen_.end())
        durable_.erase(key);
      else
        durable_[key] = it->second;
    }
    changed_.clear();
  }

  std::map<Key, File> seen_, durable_;
  std::set<Key> changed_;  // since the folder was last synced
};

}  // namespace cairn::simulation
