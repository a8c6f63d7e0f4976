// What a submission has to know of the jobs that are there, kept so that it costs the same with ten jobs and
// with ten thousand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/core/blob_ledger.h"
#include "coordinator/core/job.h"

namespace cairn::coordinator {

struct OwnedJobs {
  std::size_t not_ended = 0;
  struct Input {
    std::size_t jobs = 0;
    std::uint64_t bytes = 0;
  };
  HashMap<Input> inputs;  // that jobs read which are neither done nor cancelled
  std::uint64_t input_bytes = 0;
};

class JobIndex {
 public:
  // `bytes_of`: of an input, as the store has it.
  explicit JobIndex(std::function<std::uint64_t(const Hash& input)> bytes_of)
      : bytes_of_(std::move(bytes_of)) {}

  // With each JobChanged. `job`: as it stands now; null: it is gone.
  void File(const std::string& id, const Job* job);
  // The first that serves whoever submits the same, of those that he may command if there is one: of one that
  // has failed, was cancelled or is being deleted another is wanted, and of one that is paused where he may
  // not resume it. Null: none.
  const std::string* Serving(const Hash& hash,
                             const std::function<bool(const std::string& owner)>& may_command) const;
  const OwnedJobs& Of(const std::string& owner) const;
  std::size_t running() const { return running_; }

 private:
  struct Filed {
    std::uint64_t order = 0;
    Hash hash;
    std::string owner;
    std::vector<Hash> inputs;  // that the store needs for it
    bool serves = false, running = false, ended = false, paused = false;
    bool operator==(const Filed&) const = default;
  };
  static Filed AsItStands(const Job& job);
  void Add(const std::string& id, const Filed& filed);
  void Remove(const Filed& filed);

  const std::function<std::uint64_t(const Hash&)> bytes_of_;
  std::map<std::string, Filed> filed_;                            // by id
  HashMap<std::map<std::uint64_t, const std::string*>> serving_;  // ids, by order
  std::map<std::string, OwnedJobs> owned_;                        // by owner
  std::size_t running_ = 0;
};

}  // namespace cairn::coordinator
