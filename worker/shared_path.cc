#include "worker/shared_path.h"

#include <utility>

#include "schema/store/flat_file.h"

namespace cairn::worker {

SharedPath::SharedPath(std::filesystem::path folder, std::function<void()> wake)
    : folder_(std::move(folder)), wake_(std::move(wake)), thread_([this] { Loop(); }) {}

SharedPath::~SharedPath() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

void SharedPath::LookFor(const Want& want) {
  const std::lock_guard lock(mutex_);
  wanted_.push_back(want);
  changed_.notify_all();
}

std::vector<Look> SharedPath::TakeLooks() {
  const std::lock_guard lock(mutex_);
  return std::exchange(looks_, {});
}

void SharedPath::Loop() {
  while (true) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ended_ || !wanted_.empty(); });
    if (ended_) return;
    const Want want = std::move(wanted_.front());
    wanted_.pop_front();
    lock.unlock();
    Look look = LookAt(want);
    lock.lock();
    looks_.push_back(std::move(look));
    lock.unlock();
    wake_();
  }
}

Result<BlobPtr> SharedPath::Read(const Hash& blob, const Want& want) {
  const std::filesystem::path file = folder_ / (blob.Hex() + ".flat");
  return want.part ? parts_.Read(file, blob, want.part->part) : ReadFlatFile(file, blob);
}

// A file that is not what it should be is told once, and is not read again.
Look SharedPath::LookAt(const Want& want) {
  const Hash blob = want.part ? want.part->blob : want.hash;
  if (bad_.contains(blob)) return {want, nullptr, {}};
  const Result<BlobPtr> read = Read(blob, want);
  if (read.ok()) return {want, read.value(), {}};
  // A part that the blob lacks the coordinator refuses too.
  if (read.status().code() == Code::kNotFound || read.status().code() == Code::kRefused)
    return {want, nullptr, {}};
  bad_.insert(blob);
  parts_.Forget(blob);
  return {want, nullptr, read.status().message() + "; the coordinator is asked for it"};
}

}  // namespace cairn::worker
