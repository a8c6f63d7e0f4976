// Blobs in a folder that this machine sees too: a coordinator's STORE/blobs on a cluster's file system, or a
// copy of it. What is there is read there, whole or in parts, and held against its hash; what is not has to
// be fetched. Reading has a thread of its own: a file system may take its time, and heartbeats go on.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "schema/store/flat_parts.h"
#include "worker/task_queue.h"

namespace cairn::worker {

// What came of a look into the folder. No blob: it has to be fetched; `why`, where that is worth a line for
// people.
struct Look {
  Want want;
  BlobPtr blob;
  std::string why;
};

class SharedPath {
 public:
  // `wake` is called, on the thread that reads, when there is a look to be taken.
  SharedPath(std::filesystem::path folder, std::function<void()> wake);
  ~SharedPath();  // waits for the file that is being read
  SharedPath(const SharedPath&) = delete;
  SharedPath& operator=(const SharedPath&) = delete;

  void LookFor(const Want& want);
  std::vector<Look> TakeLooks();  // in the order in which they were asked for

 private:
  void Loop();
  Look LookAt(const Want& want);
  Result<BlobPtr> Read(const Hash& blob, const Want& want);

  const std::filesystem::path folder_;
  const std::function<void()> wake_;
  std::set<Hash> bad_;    // of the thread that reads: not looked at again
  FlatPartsCache parts_;  // the same
  std::mutex mutex_;      // of what follows
  std::condition_variable changed_;
  bool ended_ = false;
  std::deque<Want> wanted_;
  std::vector<Look> looks_;
  std::thread thread_;  // last: all else is there before it begins
};

}  // namespace cairn::worker
