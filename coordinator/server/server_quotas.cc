// What one key may have: jobs, inputs, memory. How often it may ask, access_control.h says.
#include <algorithm>
#include <set>

#include "coordinator/server/server.h"
#include "schema/text.h"

namespace cairn::coordinator {
namespace {

std::string OfLimit(const char* name, std::uint64_t value) {
  return ", the most that may be (" + std::string(name) + "=" + std::to_string(value) + ")";
}

}  // namespace

std::uint64_t Server::BytesOnDisk(const Hash& input) const {
  for (const std::filesystem::path& path : {folder_.FlatFile(input), folder_.BlobFile(input)}) {
    std::error_code missing;
    const std::uintmax_t bytes = std::filesystem::file_size(path, missing);
    if (!missing) return bytes;
  }
  return 0;
}

std::string Server::WhyNoMoreJobs(const std::string& user) const {
  const std::uint64_t most = access_control_.LimitsOf(user).jobs;
  if (most == 0) return "";
  const std::size_t count = index_.Of(access_control_.OwnerOf(user)).not_ended;
  if (count < most) return "";
  return access_control_.NameOf(user) + " has " + std::to_string(count) + " jobs that have not ended" +
         OfLimit("jobs", most);
}

// Of jobs that are done or were cancelled the store needs no inputs any more. Of what is no job's yet each
// key has its own.
std::string Server::WhyNoMoreInputs(const std::string& user, const std::set<Hash>& more,
                                    std::uint64_t more_bytes) const {
  constexpr std::uint64_t kMb = 1'000'000;
  const std::uint64_t most_mb = access_control_.LimitsOf(user).inputs_mb;
  if (most_mb == 0) return "";
  const OwnedJobs& owned = index_.Of(access_control_.OwnerOf(user));
  std::uint64_t bytes = owned.input_bytes + more_bytes + (more.empty() ? uploads_.BytesOf(user) : 0);
  for (const Hash& input : more)
    if (!owned.inputs.contains(input)) bytes += BytesOnDisk(input);
  if (bytes <= most_mb * kMb) return "";
  return "the inputs of " + access_control_.NameOf(user) + " would take " + BytesText(bytes) +
         " with this one, of " + BytesText(most_mb * kMb) + OfLimit("inputs-mb", most_mb) +
         ": delete jobs that have failed, or wait until others are done";
}

// A job that says nothing gets the limit. What is wrong with one that says more; empty: nothing.
std::string Server::LimitMemory(const std::string& user, proto::Job& job) const {
  const std::uint64_t most_mb = access_control_.LimitsOf(user).memory_mb;
  if (most_mb == 0) return "";
  if (job.task_memory_mb() > most_mb)
    return "task_memory_mb is " + std::to_string(job.task_memory_mb()) + OfLimit("memory-mb", most_mb);
  const std::uint64_t of_all_mb = options_.core.task_memory_mb;
  if (job.task_memory_mb() == 0)
    job.set_task_memory_mb(of_all_mb == 0 ? most_mb : std::min(most_mb, of_all_mb));
  return "";
}

}  // namespace cairn::coordinator
