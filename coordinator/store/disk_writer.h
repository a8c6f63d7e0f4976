// One thread that does all writing, in the order in which it was asked, and reads what is large, so that the
// event loop never waits for a disk.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "coordinator/core/uploads.h"
#include "coordinator/store/blob_files.h"
#include "coordinator/store/cleaner.h"
#include "coordinator/store/folder.h"
#include "coordinator/store/job_table.h"
#include "coordinator/store/shared_results.h"
#include "schema/blob.h"
#include "schema/checkpoint.pb.h"
#include "schema/wire/codec.h"

namespace cairn::coordinator {

struct ResultToWrite {
  std::filesystem::path path;
  std::uint32_t stage = 0;
  Hash hash;
  BlobPtr blob;  // null: it is to be read first
};
// Blobs first, then results, then the checkpoint, which so never names what is not there; then older ones go.
struct WriteCheckpointWork {
  proto::Checkpoint checkpoint;
  std::vector<wire::NamedBlob> blobs;  // those not yet on disk
  std::vector<ResultToWrite> results;
};
struct WriteBlobsWork {
  std::vector<wire::NamedBlob> blobs;
};
struct RemoveBlobsWork {
  std::vector<Hash> hashes;
};
// All that there is of a job: see StoreFolder::Forget.
struct ForgetWork {
  std::string job;
  std::filesystem::path results;  // the folder of its results, or empty
};
struct WriteServedWork {
  double served_s = 0;
};
struct WriteLogWork {
  std::map<std::string, JobLines> by_job;
};
// What a client asked, after all that was asked for before.
struct ReadLogWork {
  std::string asker;  // the client's peer
  wire::JobInfo job;  // as it stood when it was asked
  std::uint64_t after = 0;
};
// Published results and blobs that have files of their own, to be sent.
struct LoadWork {
  std::vector<std::filesystem::path> files;
  std::vector<Hash> blobs;
};
struct CleanWork {
  std::string asker;  // the client's peer
  CleanOptions options;
};
using DiskWork =
    std::variant<WriteCheckpointWork, WriteBlobsWork, RemoveBlobsWork, ForgetWork, WriteServedWork,
                 WriteLogWork, ReadLogWork, LoadWork, CleanWork, OpenUpload, WritePiece, CloseUpload>;

// What came of a checkpoint, of blobs, of a piece or the end of an upload, of a question, of what
// was to be loaded, or of the time served; of rows, log lines and the beginning of an upload only a failure
// is told. (A removal that fails is made up for by the next start.)
struct DiskDone {
  std::uint64_t ticket = 0;
  std::string job;           // empty: neither a checkpoint nor a job that went
  std::uint64_t number = 0;  // of the checkpoint; 0: the job is forgotten
  Status status;
  std::vector<Hash> written;  // blobs that lie on disk now
  std::string asker;          // of the question that `answer` answers; empty: it was none
  wire::Reply answer;
  std::vector<SharedResults::Loaded> loaded;
  std::map<Hash, Result<BlobPtr>> read;
  std::uint64_t upload = 0;        // its number; 0: it is of none
  std::uint64_t upload_bytes = 0;  // of the piece
  bool closed = false;             // the upload is over, with this blob:
  Hash blob = {};
};

class DiskWriter {
 public:
  // `wake` is called on the writer's thread when something is done.
  DiskWriter(const StoreFolder& folder, BlobFiles& files, StoreUse& use, JobTable table,
             std::function<void()> wake);
  ~DiskWriter();  // after all work is done

  std::uint64_t Add(DiskWork work);  // returns its ticket; tickets grow
  std::uint64_t next_ticket() const { return next_ticket_; }
  std::vector<DiskDone> TakeDone();
  bool Finished(std::uint64_t ticket);  // the work with this ticket and all before it

 private:
  struct Item {
    std::uint64_t ticket;
    DiskWork work;
  };
  void Loop();
  std::optional<DiskDone> Do(Item& item);
  std::optional<Item> Next();  // waits, and counts what the store takes by and by; none: closed
  DiskDone Do(WriteCheckpointWork& work);
  DiskDone Do(const WriteBlobsWork& work) const;
  DiskDone Do(const WriteServedWork& work) const;
  DiskDone Do(const CleanWork& work) const;
  DiskDone Do(const ForgetWork& work);
  DiskDone Do(const RemoveBlobsWork& work);
  DiskDone Do(const WriteLogWork& work);
  DiskDone Do(const ReadLogWork& work) const;
  DiskDone Do(const LoadWork& work) const;
  DiskDone Do(const OpenUpload& work);
  DiskDone Do(const WritePiece& work);
  DiskDone Do(const CloseUpload& work);
  void RemoveOldCheckpoints(const proto::Checkpoint& checkpoint) const;

  const StoreFolder& folder_;
  bool may_have_lost_jobs_ = true;  // until it was seen that there are none
  BlobFiles& files_;
  StoreUse& use_;
  JobTable table_;
  UploadFiles uploads_;
  const std::function<void()> wake_;
  std::uint64_t next_ticket_ = 1;  // of the thread that adds
  // When the writing thread counts what the store takes: soon after it has changed.
  std::chrono::steady_clock::time_point count_at_ = std::chrono::steady_clock::time_point::max();
  std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  std::deque<Item> queue_;
  std::vector<DiskDone> done_;
  std::uint64_t finished_ = 0;  // the last ticket
  std::thread thread_;          // last: it uses all of the above
};

}  // namespace cairn::coordinator
